"""The test program: every function of X4Step from a prompt, one command a line.

    line  = [ Q | H | ? | G | I | C | T | E | M(+|-) | S axis | D int | F int | R int
            | A int,int,int ]

Upper and lower case are alike, blanks do not matter. It does what TEST of the X4Step disk did, and
credits it.

Rule 1: each axis keeps its path, rate and ramp; G drives all that have a path, with rate and ramp
        of the longest.
Rule 2: ESC ends what moves, and with it the whole of A, T, M and C.
Rule 3: a script has no ESC key: what only ESC ends, ends there after a second. An ESC in the
        script, after a command, comes a second after the command began.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

from fraese.phrases import phrase
from fraese.x4step.codes import (
    AXES,
    ESC_CODE,
    FREQ_HZ,
    INPUT_PINS,
    MOST_STEPS,
    RAMP_MS,
    X4ErrFreqTooLow,
    X4Error,
    X4NoErr,
)
from fraese.x4step.functions import (
    X4BrakeCodes,
    X4ClearTimer,
    X4GetIn,
    X4GetState,
    X4GetSteps,
    X4GetTimer,
    X4LastBrakeCode,
    X4Load,
    X4MoveNeg,
    X4MovePos,
    X4Start,
)
from fraese.x4step.keyboard import BREAK, MAKE_CODES

HELP: Final = f"""\
Test program for X4Step, after TEST of the library X4Step 1.0 by B. Lewetz, 1995

Commands:
  x->      the prompt: x is the selected axis
  Q        quit
  Sx       select axis 1 to 4
  Dx       path of the selected axis, {-MOST_STEPS} to {MOST_STEPS} steps
  Fx       its rate, {FREQ_HZ[0]} to {FREQ_HZ[1]} Hz
  Rx       its ramp time, {RAMP_MS[0]} to {RAMP_MS[1]} ms, for both ramps
  G        go: all axes with a path, in a straight line
  I        show path, rate and ramp of all axes
  M+       move the selected axis until ESC
  M-       the same, the other way
  C        move it with the cursor keys LEFT and RIGHT while they are held; ends with ESC
  Ax,y,z   drive its path at every rate from x to y Hz, z Hz apart
  T        drive its path there and back until ESC
  E        show the five inputs until ESC
  H, ?     this list
"""

_NS: Final = "-?[0-9]+"
_LEFT: Final = MAKE_CODES["LEFT"]
_RIGHT: Final = MAKE_CODES["RIGHT"]


class Console(Protocol):
    """Where the program is spoken with."""

    def say(self, text: str) -> None:
        """A line to the person."""

    def line(self, prompt: str) -> str | None:
        """The next command; None: there is no more."""

    def code(self) -> int | None:
        """Make code of the next key at standstill, if one waits; None: not yet."""

    def escaped(self) -> bool:
        """ESC was pressed between two motions; other keys are left where they are."""

    def press_if_due(self, elapsed_ms: int, only_esc_ends: bool) -> bool:
        """A script presses ESC when its time has come; True: now, or before."""


@dataclass
class Axis:
    """What was loaded for an axis."""

    steps: int = 0
    freq_hz: int = 0
    ramp_ms: int = 0


class Refused(Exception):
    """A command that cannot be carried out; its text says why."""


class Bench:
    """The commands.

    Args:
        console: where to read and write.

    Attributes:
        axis: the selected one, 1 to 4.
        axes: what was loaded, by axis.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._say = console.say
        self.axis = AXES[0]
        self.axes = {axis: Axis() for axis in AXES}
        self._is_over = False

    @property
    def _selected(self) -> Axis:
        return self.axes[self.axis]

    def run(self) -> None:
        """Until Q, or the end of the input."""
        self._say(HELP)
        while not self._is_over:
            line = self._console.line(f"{self.axis}->")
            if line is None:
                break
            self.obey(line)

    def obey(self, line: str) -> None:
        """Carry out a line; what is wrong with it is said."""
        text = re.sub(r"\s", "", line).upper()
        if not text:
            return
        letter, rest = text[0], text[1:]
        command = COMMANDS.get(letter)
        if command is None or not re.fullmatch(command.rest, rest):
            wanted = phrase("; it is {shape}", shape=command.shape) if command else ""
            self._say(
                phrase(
                    "{line}: no such command{wanted}. H shows all.",
                    line=line.strip(),
                    wanted=wanted,
                )
            )
            return
        try:
            command.act(self, rest)
        except Refused as refused:
            self._say(str(refused))

    # --- loading ---------------------------------------------------------------------------------

    def select(self, rest: str) -> None:
        """Sx."""
        self.axis = _within("axis", int(rest), AXES[0], AXES[-1])

    def load_steps(self, rest: str) -> None:
        """Dx."""
        self._selected.steps = _within("path", int(rest), -MOST_STEPS, MOST_STEPS)

    def load_freq(self, rest: str) -> None:
        """Fx."""
        self._selected.freq_hz = _within("rate", int(rest), *FREQ_HZ)

    def load_ramp(self, rest: str) -> None:
        """Rx."""
        self._selected.ramp_ms = _within("ramp", int(rest), *RAMP_MS)

    def show(self, _rest: str) -> None:
        """I."""
        for number, axis in self.axes.items():
            self._say(
                f"axis {number}: {axis.steps:9d} steps {axis.freq_hz:6d} Hz {axis.ramp_ms:5d} ms"
            )

    def help(self, _rest: str) -> None:
        """H, ?."""
        self._say(HELP)

    def quit(self, _rest: str) -> None:
        """Q."""
        self._is_over = True

    # --- moving ----------------------------------------------------------------------------------

    def go(self, _rest: str) -> None:
        """G."""
        way = tuple(self.axes[axis].steps for axis in AXES)
        leader = max(self.axes.values(), key=lambda axis: (abs(axis.steps), axis.freq_hz > 0))
        X4ClearTimer()
        self._drive(way, leader.freq_hz, leader.ramp_ms)
        self._tell_steps()

    def move(self, rest: str) -> None:
        """M+, M-."""
        axis = self._selected
        start = X4MovePos if rest == "+" else X4MoveNeg
        _require(start(self.axis, axis.freq_hz, axis.ramp_ms))
        self._say(phrase("Moving; ESC ends it."))
        X4ClearTimer()
        self._wait(only_esc_ends=True)
        self._tell_steps()

    def sweep(self, rest: str) -> None:
        """Ax,y,z; y is driven too if it is hit."""
        low, high, apart = map(int, rest.split(","))
        low, high = (_within("rate", rate, *FREQ_HZ) for rate in (low, high))
        _within(phrase("distance between two rates"), apart, 1, FREQ_HZ[1])
        if low > high:
            raise Refused(
                phrase(
                    "The first rate ({low} Hz) must not be above the last ({high} Hz).",
                    low=low,
                    high=high,
                )
            )
        for freq_hz in range(low, high + 1, apart):
            self._say(phrase("{freq_hz} Hz", freq_hz=freq_hz))
            X4ClearTimer()
            ended = self._drive(self._way(1), freq_hz, self._selected.ramp_ms)
            if ended or self._console.escaped():
                self._say(phrase("Ended by ESC."))
                return

    def to_and_fro(self, _rest: str) -> None:
        """T."""
        axis, sign = self._selected, 1
        self._say(phrase("To and fro; ESC ends it."))
        X4ClearTimer()
        while not (
            self._drive(self._way(sign), axis.freq_hz, axis.ramp_ms, only_esc_ends=True)
            or self._console.escaped()
        ):
            sign = -sign
        self._tell_steps()

    def cursor(self, _rest: str) -> None:
        """C; RIGHT is positive."""
        axis = self._selected
        if not axis.freq_hz:
            _require(X4ErrFreqTooLow)
        self._say(phrase("LEFT and RIGHT move; ESC ends it."))
        starts = {_LEFT: X4MoveNeg, _RIGHT: X4MovePos}
        try:
            while (code := self._key()) != ESC_CODE:
                if code in starts:
                    X4BrakeCodes((code + BREAK,))
                    _require(starts[code](self.axis, axis.freq_hz, axis.ramp_ms))
                    X4ClearTimer()
                    if self._wait(only_esc_ends=True):
                        break
                    self._tell_steps()
        finally:
            X4BrakeCodes(())

    def inputs(self, _rest: str) -> None:
        """E."""
        self._say(phrase("Inputs, 1 is high; ESC ends it."))
        shown = -1
        X4ClearTimer()
        while True:
            now = X4GetIn()
            if now != shown:
                shown = now
                levels = (
                    phrase("pin {pin}: {now}", pin=pin, now=now >> 4 - n & 1)
                    for n, pin in enumerate(INPUT_PINS)
                )
                self._say("  ".join(levels))
            if self._console.code() == ESC_CODE:
                return
            if self._console.press_if_due(X4GetTimer(), only_esc_ends=True):
                return

    def _way(self, sign: int) -> tuple[int, ...]:
        steps = sign * self._selected.steps
        return tuple(steps if axis == self.axis else 0 for axis in AXES)

    def _drive(
        self, way: tuple[int, ...], freq_hz: int, ramp_ms: int, *, only_esc_ends: bool = False
    ) -> bool:
        """Load, start, wait; True: ESC was pressed."""
        one, two, three, four = way
        _require(X4Load(one, two, three, four, freq_hz, ramp_ms))
        _require(X4Start())
        return self._wait(only_esc_ends=only_esc_ends)

    def _wait(self, *, only_esc_ends: bool) -> bool:
        """Until all stand; True: ESC was pressed. The timer tells a script how long it takes."""
        while X4GetState():
            self._console.press_if_due(X4GetTimer(), only_esc_ends)
        return X4LastBrakeCode() == ESC_CODE

    def _key(self) -> int:
        """The next key at standstill."""
        X4ClearTimer()
        while (code := self._console.code()) is None:
            if self._console.press_if_due(X4GetTimer(), only_esc_ends=True):
                return ESC_CODE
        return code

    def _tell_steps(self) -> None:
        steps = ", ".join(str(X4GetSteps(axis)) for axis in AXES)
        ended = phrase(" Ended by ESC.") if X4LastBrakeCode() == ESC_CODE else ""
        self._say(phrase("Steps of axes 1 to 4: {steps}.{ended}", steps=steps, ended=ended))


@dataclass(frozen=True)
class Command:
    """A letter.

    Attributes:
        rest: what may come after it, a regular expression.
        shape: the whole, for a person.
        act: what it does.
    """

    rest: str
    shape: str
    act: Callable[[Bench, str], None]


COMMANDS: Final[Mapping[str, Command]] = {
    "Q": Command("", "Q", Bench.quit),
    "S": Command(_NS, phrase("S and an axis, as in S2"), Bench.select),
    "D": Command("[+]?" + _NS, phrase("D and a number of steps, as in D-1000"), Bench.load_steps),
    "F": Command(_NS, phrase("F and a rate in Hz, as in F2000"), Bench.load_freq),
    "R": Command(_NS, phrase("R and a time in ms, as in R50"), Bench.load_ramp),
    "G": Command("", "G", Bench.go),
    "I": Command("", "I", Bench.show),
    "M": Command("[+-]", phrase("M+ or M-"), Bench.move),
    "C": Command("", "C", Bench.cursor),
    "A": Command(
        f"{_NS},{_NS},{_NS}", phrase("A and three numbers, as in A200,500,20"), Bench.sweep
    ),
    "T": Command("", "T", Bench.to_and_fro),
    "E": Command("", "E", Bench.inputs),
    "H": Command("", "H", Bench.help),
    "?": Command("", "?", Bench.help),
}


def _within(what: str, value: int, low: int, high: int) -> int:
    if not low <= value <= high:
        raise Refused(
            phrase(
                "The {what} is {low} to {high}, not {value}.",
                what=what,
                low=low,
                high=high,
                value=value,
            )
        )
    return value


def _require(code: X4Error) -> None:
    if code is not X4NoErr:
        raise Refused(f"{code.name} ({code:d}): {code.sentence}")
