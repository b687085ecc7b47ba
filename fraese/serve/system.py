"""Commands of grbl's own, those with a dollar; a jog has a file of its own.

    word      when             what
    $ $G      always           help, parser state
    $X        alarm            unlock; else nothing
    $$ $# $I $N                at rest or in an alarm: shown
    $n=v $Nn= $I= $RST=        likewise: kept
    $H $Hx    likewise         reference run
    $C        at rest          lines are looked at only; again: a reset

Rule 1: what belongs to a standstill is refused with 8 while something moves.
"""

import re
from collections.abc import Callable, Mapping
from typing import Final

from fraese.control.controller import Controller
from fraese.errors import FraeseError
from fraese.phrases import phrase
from fraese.serve import settings
from fraese.serve.codes import Code, code_of
from fraese.serve.inbox import Sent
from fraese.serve.kinds import bare
from fraese.serve.modes import Modes
from fraese.serve.report import Axes, as_message, offsets
from fraese.serve.store import START_LINES, Store

HELP: Final = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $C $X $H ~ ! ? ctrl-x]"
VERSION: Final = "1.1h.20190830"
#: Options as grbl has letters for them: variable spindle, single axes referenced, mist.
OPTIONS: Final = "[OPT:VHM,15,128]"
UNLOCKED: Final = "[MSG:Caution: Unlocked]"
_NUMBER: Final = re.compile(r"\$([0-9]+)=(.*)")
_START_LINE: Final = re.compile(r"\$N([0-9]+)=(.*)")
_VALUE: Final = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)")
_MOST_NUMBER: Final = 255
_MOST_INFO: Final = 80

#: Writes keys of the configuration; what is to be said of it. Raises ``ConfigError``.
Write = Callable[[settings.Changes], str]
#: Number, and what else is to be said.
Answer = tuple[Code, str]
_OK: Final[Answer] = (Code.OK, "")
_INVALID: Final[Answer] = (Code.STATEMENT, "")


class System:
    """What they do.

    Args:
        controller: the machine.
        modes: changed by them.
        store: what is kept.
        write: see ``Write``.
        say: tells the sender a line.
        parser: modes of the language, and the number of the work offset.
        home: starts a reference run of these axes.
        check: turns the check mode.
    """

    def __init__(
        self,
        controller: Controller,
        modes: Modes,
        store: Store,
        write: Write,
        say: Callable[[str], object],
        parser: Callable[[], str],
        home: Callable[[list[str]], object],
        check: Callable[[], object],
    ) -> None:
        self._controller = controller
        self._modes = modes
        self._store = store
        self._write = write
        self._say = say
        self._parser = parser
        self._home = home
        self._check = check
        self._axes = Axes(controller.machine)
        self.probed = f"[PRB:{self._axes.written((0.0,) * len(controller.machine.axes))}:0]"
        self._always: Mapping[str, Callable[[], Answer]] = {
            "$": self._help,
            "$G": self._parser_state,
        }
        self._at_rest: Mapping[str, Callable[[], Answer]] = {
            "$$": self._settings,
            "$#": self._offsets,
            "$I": self._info,
            "$N": self._start_lines,
            "$X": self._unlock,
            "$H": lambda: self._reference([]),
            "$C": self._turn_check,
        }

    # --- to be asked -----------------------------------------------------------------------------

    def value(self, number: int) -> float:
        """Of a stored setting."""
        return self._store.settings.get(number, settings.STORED[number])

    def is_inline(self, line: Sent) -> bool:
        """It may be done at any time."""
        word = bare(line.text).upper()
        return word in self._always or (word == "$X" and not (self._modes.alarm or self._modes.out))

    def inline(self, line: Sent) -> Answer:
        """Do what may be done at any time."""
        command = self._always.get(bare(line.text).upper())
        return _OK if command is None else command()

    def do(self, line: Sent) -> Answer:
        """Do it; nothing moves."""
        text = line.text.strip()
        word = bare(text).upper()
        try:
            command = self._always.get(word) or self._at_rest.get(word)
            return self._other(word, text) if command is None else command()
        except FraeseError as error:
            return code_of(error), str(error)

    def _other(self, word: str, text: str) -> Answer:
        if word.startswith("$H") and word[2:].isalpha():
            return self._reference([letter.lower() for letter in word[2:]])
        if found := _NUMBER.fullmatch(word):
            return self._set(int(found[1]), found[2])
        if found := _START_LINE.fullmatch(word):
            return self._keep_start_line(int(found[1]), found[2])
        if word.startswith("$I="):
            self._store.info = text.partition("=")[2][:_MOST_INFO]
            self._store.keep()
            return _OK
        return self._restore(word[5:]) if word.startswith("$RST=") else _INVALID

    # --- shown -----------------------------------------------------------------------------------

    def _help(self) -> Answer:
        self._say(HELP)
        return _OK

    def _parser_state(self) -> Answer:
        self._say(self._parser())
        return _OK

    def _settings(self) -> Answer:
        controller = self._controller
        values = settings.shown(controller.config, controller.machine, self._store.settings)
        for number, value in values.items():
            self._say(f"${number}={settings.written(value)}")
        return _OK

    def _offsets(self) -> Answer:
        position, names = self._controller.position, self._controller.machine.names
        inches = bool(self.value(settings.INCHES))
        kept = position.offsets.parameters
        for line in offsets(kept, self._axes, "".join(names), self.probed, inches=inches):
            self._say(line)
        return _OK

    def _info(self) -> Answer:
        self._say(f"[VER:{VERSION}:{self._store.info}]")
        self._say(OPTIONS)
        return _OK

    def _start_lines(self) -> Answer:
        for number, line in enumerate(self._store.start_lines):
            self._say(f"$N{number}={line}")
        return _OK

    # --- done ------------------------------------------------------------------------------------

    def _unlock(self) -> Answer:
        if self._modes.alarm:
            self._modes.alarm = 0
            self._controller.acknowledge()
            self._say(UNLOCKED)
        return _OK

    def _reference(self, axes: list[str]) -> Answer:
        machine = self._controller.machine
        if not axes and not any(axis.has_switches for axis in machine.axes):
            return Code.DISABLED, phrase("No axis of this machine has end switches.")
        if unknown := [letter for letter in axes if letter not in machine.names]:
            return Code.STATEMENT, phrase("There is no axis {name}.", name=unknown[0].upper())
        self._controller.acknowledge()
        self._home(axes)
        self._modes.alarm = 0
        return _OK

    def _turn_check(self) -> Answer:
        if self._modes.alarm:
            return Code.NOT_IDLE, ""
        self._check()
        return _OK

    # --- kept ------------------------------------------------------------------------------------

    def _set(self, number: int, text: str) -> Answer:
        if not _VALUE.fullmatch(text):
            return Code.NUMBER, ""
        value = float(text)
        if value < 0:
            return Code.NEGATIVE, ""
        if number > _MOST_NUMBER:
            return _INVALID
        if number in settings.STORED:
            self._store.settings[number] = value
            self._store.keep()
            return _OK
        return self._configure(number, value)

    def _configure(self, number: int, value: float) -> Answer:
        config, machine = self._controller.config, self._controller.machine
        now = settings.shown(config, machine, {}).get(number)
        if now is None:
            return _INVALID
        if settings.written(now) == settings.written(value):
            return _OK
        wanted = settings.changes(config, machine, number, value)
        if not wanted:
            return Code.DISABLED, phrase("This setting is fixed on this machine.")
        said = self._write(wanted)
        if said:
            self._say(as_message(said))
        return _OK

    def _keep_start_line(self, number: int, line: str) -> Answer:
        if number >= START_LINES:
            return _INVALID
        if self._modes.alarm:
            return Code.NOT_IDLE, ""
        self._store.start_lines[number] = line
        self._store.keep()
        return _OK

    def _restore(self, what: str) -> Answer:
        """What is kept for senders; the machine's own configuration is not a sender's to forget."""
        if what not in ("$", "*"):
            return Code.DISABLED, phrase(
                "Work offsets and configuration are not reset by a sender; $RST=$ forgets what was"
                " kept for senders."
            )
        self._store.settings.clear()
        self._store.start_lines[:] = [""] * START_LINES
        self._store.keep()
        self._say("[MSG:Restoring defaults]")
        return _OK
