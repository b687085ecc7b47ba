"""Every error that a user can meet.

    FraeseError                 root; str(error) is one sentence for the user
    ├── UsageError              wrong call, file or configuration      exit 2
    │   ├── ConfigError         a key in the configuration
    │   ├── ProgramError        a line in a program (file and line in the message)
    │   ├── LimitError          a target outside the travel
    │   ├── StateError          not now: the machine is in another state
    │   └── TraceError          a waveform that cannot be read or written
    ├── Alarm                   the job failed or was stopped          exit 1
    │   ├── SwitchAlarm         contact where none was expected
    │   ├── HomingError         an end that is not found or does not open
    │   ├── ProbeError          a probe that touches never, or already
    │   ├── SilenceAlarm        the program did not look after its driver in time
    │   ├── StopAlarm           the driver stopped, and nobody had asked for it
    │   ├── KeepAlarm           the place could not be put down while the motors ran
    │   ├── BusyError           another program drives the machine; nothing has moved
    │   └── PortError           the metal is not reachable
    ├── OutputError             what a command prints cannot be written   exit 1
    └── Cancelled               the user stopped it                    exit 130

Foreign errors are wrapped at the seam where they arise, with ``raise ... from``.

Every alarm is of a kind, with a number: ``alarms.py``.
"""

import re
from collections.abc import Sequence
from typing import ClassVar, Final

from fraese import alarms
from fraese.alarms import AlarmKind
from fraese.phrases import Phrase, joined, phrase

#: A name or number longer than this is shown by its beginning and its end.
_LONG_WORD: Final = re.compile(r"(\S{60})\S{80,}(\S{40})")


class FraeseError(Exception):
    """Root of the family; never raised itself.

    Args:
        sentence: for the user; a word in it that no screen holds is shortened.
    """

    exit_code = 1
    #: First word of the code.
    kind_name: ClassVar[str] = "error"

    def __init__(self, sentence: str = "") -> None:
        if _LONG_WORD.search(sentence):
            sentence = sentence.alter(_short) if isinstance(sentence, Phrase) else _short(sentence)
        super().__init__(sentence)

    @property
    def sentence(self) -> str:
        """What it says of itself; the code is made of it."""
        return str(self)

    @property
    def error_code(self) -> str:
        """For programs: the same for the same fault, in every language."""
        said = self.sentence
        return f"{self.kind_name}-{said.code}" if isinstance(said, Phrase) else self.kind_name

    def details(self) -> dict[str, object]:
        """For programs: the code, and what the sentence is made of."""
        said = str(self)
        return {"code": self.error_code, **(said.as_dict() if isinstance(said, Phrase) else {})}


def _short(text: str) -> str:
    return _LONG_WORD.sub(r"\1...\2", text)


class UsageError(FraeseError):
    """A wrong call, file or configuration: nothing has moved."""

    exit_code = 2
    kind_name = "usage"


class ConfigError(UsageError):
    """A key of the configuration is unknown, missing or out of bounds."""

    kind_name = "config"


class ProgramError(UsageError):
    """A line of a program is refused.

    Args:
        message: what is wrong and what would be right, without place.
        line: line number, 1-based; 0 where no line applies.
        file: name of the file as the user gave it; empty where there is none.
        calls: where the subroutine was called in which it stands, file and line, the innermost
            first.
    """

    kind_name = "program"

    def __init__(
        self, message: str, line: int = 0, file: str = "", calls: Sequence[tuple[str, int]] = ()
    ) -> None:
        self.message = message
        self.line = line
        self.file = file
        self.calls = tuple(calls)
        super().__init__(placed(message, line, file, _called(file, self.calls)))

    @property
    def sentence(self) -> str:
        """Without the place."""
        return self.message

    def in_program(self, file: str) -> tuple[int, str]:
        """Line and message as seen from the program itself: the line of its own that leads there.

        Args:
            file: name of the program's file.
        """
        if not self.calls:
            elsewhere = [self.file] if self.file not in ("", file) else []
            return self.line, joined(": ", [*elsewhere, self.message])
        *between, (_, line) = self.calls
        if self.file == file:
            return self.line, joined("", (self.message, _called(file, self.calls)))
        return line, placed(self.message, self.line, self.file, _called(self.file, between))


#: More calls within each other are not told one by one.
_ALL_CALLS: Final = 2


def _in_words(file: str, line: int) -> Phrase:
    numbered = phrase("line {line}", line=line) if line else ""
    return joined(", ", [part for part in (file, numbered) if part])


def placed(message: str, line: int, file: str = "", called: str = "") -> str:
    """A message with its place.

    Args:
        message: what is said of the place.
        line: line number, 1-based; 0 where no line applies.
        file: name of the file; empty where it is known.
        called: where the subroutine was called in which it stands.
    """
    place = joined("", (_in_words(file, line), called))
    return joined(": ", (place, message)) if place else message


def _called(file: str, calls: Sequence[tuple[str, int]]) -> str:
    """Where the innermost and the outermost call stand; a file is named where it is another."""
    said = []
    for caller, line in (calls[0], calls[-1])[: len(calls)] if calls else ():
        said.append(_in_words("" if caller == file else caller, line))
        file = caller
    between = phrase(" ... called in ") if len(calls) > _ALL_CALLS else phrase(", called in ")
    return phrase(" (called in {places})", places=joined(between, said)) if said else ""


class LimitError(UsageError):
    """A target lies outside the travel of the machine."""

    kind_name = "limit"


class StateError(UsageError):
    """The command is not possible in the present state of the machine."""

    kind_name = "state"


class TraceError(UsageError):
    """A waveform file cannot be read or written; nothing has moved."""

    kind_name = "trace"


class Alarm(FraeseError):
    """The machine stopped by itself; the position is said in the message.

    Args:
        sentence: what happened here, for people.
        kind: which alarm it is; None: what this class usually means.
        facts: what the sentence is about, for programs, by name: plain values.
    """

    usual: ClassVar[AlarmKind]

    def __init__(self, sentence: str, kind: AlarmKind | None = None, **facts: object) -> None:
        super().__init__(sentence)
        self.kind = kind or self.usual
        self.facts = facts

    @property
    def error_code(self) -> str:
        """For programs: its number."""
        return f"alarm-{self.kind.number}"

    def as_dict(self) -> dict[str, object]:
        """For programs."""
        kind = self.kind
        return {
            "number": kind.number,
            "name": kind.name,
            "trust": kind.trust.name.lower(),
            "remedy": kind.remedy,
            "parameters": self.facts,
        }


class SwitchAlarm(Alarm):
    """An end switch closed where none was expected."""

    usual = alarms.END_SWITCH


class HomingError(Alarm):
    """An end was not found, or its switch does not open again."""

    usual = alarms.END_NOT_FOUND


class ProbeError(Alarm):
    """A probe never touched, or touched already."""

    usual = alarms.PROBE_NEVER


class SilenceAlarm(Alarm):
    """The driver heard nothing from the program while the motors ran, and braked."""

    usual = alarms.SILENCE


class StopAlarm(Alarm):
    """The driver stopped without ramp and dropped its queue; the program had not asked for it."""

    usual = alarms.STRAY_STOP


class KeepAlarm(Alarm):
    """Where the machine is could not be put down, so the motors were braked."""

    usual = alarms.NOT_KEPT


class BusyError(Alarm):
    """Another program drives the machine; nothing has moved."""

    usual = alarms.MACHINE_BUSY


class PortError(Alarm):
    """The port cannot be opened, is busy, or went away."""

    usual = alarms.PORT


class Cancelled(FraeseError):
    """The user stopped it."""

    exit_code = 130
    kind_name = "cancelled"


class OutputError(FraeseError):
    """What a command is asked to print cannot be written."""

    kind_name = "output"
