"""What is reported in grbl's words: status, parser state, offsets.

    <Run|MPos:1.000,0.000,0.000|Bf:12,100|FS:600,0|WCO:0.000,0.000,0.000>

Rule 1: a position has at least X, Y and Z: a sender expects three; an axis that the machine lacks
        is at 0. Others follow in machine order.
Rule 2: work offset and overrides are reported when they change, and from time to time, the work
        offset first; of turned work coordinates with every report, since it is no constant there.
"""

from collections.abc import Mapping, Sequence
from typing import Final

from fraese.control.state import MachineState
from fraese.gcode.modal import Modal, name
from fraese.machine import Machine
from fraese.workframe import (
    G28_HOME,
    G30_HOME,
    G92_OFFSET,
    SYSTEMS,
    TOOL_OFFSET,
    first_of_system,
    stored,
)

#: Every so many reports what has not changed is reported again.
_WCO_EVERY: Final = 10
_OV_EVERY: Final = 20
_MM_PER_INCH: Final = 25.4
_EXPECTED: Final = "xyz"
#: Of ``$10``.
_MASK_MPOS, _MASK_BUFFER = 1, 2


class Axes:
    """Numbers of a machine's axes as a sender expects them.

    Args:
        machine: whose.
    """

    def __init__(self, machine: Machine) -> None:
        names = machine.names
        self._places = [
            *(names.index(letter) if letter in names else None for letter in _EXPECTED),
            *(place for place, letter in enumerate(names) if letter not in _EXPECTED),
        ]
        self._turns = [axis.kind == "rotary" for axis in machine.axes]

    def written(self, values: Sequence[float], *, inches: bool = False) -> str:
        """With commas between them."""
        return ",".join(self._number(values, place, inches) for place in self._places)

    def _number(self, values: Sequence[float], place: int | None, inches: bool) -> str:
        if place is None:
            return "0.0000" if inches else "0.000"
        value = values[place]
        if inches and not self._turns[place]:
            return f"{value / _MM_PER_INCH + 0.0:.4f}"
        # No -0.000.
        return f"{round(value, 3) + 0.0:.3f}"


class StatusReport:
    """Status reports of one connection, which remembers what it was told.

    Args:
        axes: of the machine.
    """

    def __init__(self, axes: Axes) -> None:
        self._axes = axes
        self._told_offset = self._told_overrides = ""
        self._offset_in = self._overrides_in = 0

    def anew(self) -> None:
        """Somebody listens who knows nothing."""
        self._told_offset = self._told_overrides = ""

    def line(
        self,
        state: MachineState,
        word: str,
        *,
        mask: int,
        inches: bool,
        free: tuple[int, int],
    ) -> str:
        """One report.

        Args:
            state: of the machine.
            word: which state that is.
            mask: ``$10``: machine or work position, and whether buffers are reported.
            inches: ``$13``.
            free: places for moves and for bytes.
        """
        written = self._axes.written
        which, place = ("MPos", state.position_mm) if mask & _MASK_MPOS else ("WPos", state.work_mm)
        parts = [word, f"{which}:{written(place, inches=inches)}"]
        if mask & _MASK_BUFFER:
            parts.append("Bf:{},{}".format(*free))
        unit = _MM_PER_INCH if inches else 1.0
        spindle = state.cutting.rev_min if state.cutting.direction else 0.0
        parts.append(f"FS:{state.speed_mm_min / unit:.0f},{spindle:.0f}")
        if pins := _pins(state):
            parts.append(f"Pn:{pins}")
        parts += self._changes(state, inches)
        return "<" + "|".join(parts) + ">"

    def _changes(self, state: MachineState, inches: bool) -> list[str]:
        """One of the two at a time."""
        places = zip(state.position_mm, state.work_mm, strict=True)
        offset = self._axes.written([at - work for at, work in places], inches=inches)
        overrides = f"{state.override * 100:.0f},{state.rapid_override * 100:.0f},100"
        self._offset_in -= 1
        self._overrides_in -= 1
        if offset != self._told_offset or self._offset_in <= 0:
            self._told_offset, self._offset_in = offset, _WCO_EVERY
            return [f"WCO:{offset}"]
        if overrides != self._told_overrides or self._overrides_in <= 0:
            self._told_overrides, self._overrides_in = overrides, _OV_EVERY
            accessories = _accessories(state)
            return [f"Ov:{overrides}", *([f"A:{accessories}"] if accessories else [])]
        return []


def _pins(state: MachineState) -> str:
    ends = {end[0].upper() for end in state.ends} if state.switch_closed else set()
    return "".join(letter for letter in "XYZABCUVW" if letter in ends)


def _accessories(state: MachineState) -> str:
    direction = state.cutting.direction
    return "S" if direction > 0 else "C" if direction < 0 else ""


def as_message(text: str) -> str:
    """``[MSG:...]``: what a person should know."""
    return "[MSG:" + " ".join(text.split()).replace("[", "(").replace("]", ")") + "]"


def parser_state(modal: Modal, system: int) -> str:
    """``[GC:...]``: what is in force behind the last line that was read.

    Args:
        modal: of the interpreter.
        system: number of the work offset, 1 is G54.
    """
    words = [
        name(modal.motion) if modal.motion is not None else "G80",
        SYSTEMS[system - 1],
        f"G{modal.plane}",
        "G20" if modal.scale_mm != 1 else "G21",
        "G90" if modal.absolute else "G91",
        "G93" if modal.inverse_time else "G94",
        {0: "M5", 1: "M3", -1: "M4"}[modal.spindle],
        *(["M7"] if modal.mist else []),
        *(["M8"] if modal.flood else []),
        *([] if modal.mist or modal.flood else ["M9"]),
        f"T{modal.tool}",
        f"F{modal.feed_word:g}",
        f"S{modal.rev_min:g}",
    ]
    return f"[GC:{' '.join(words)}]"


def offsets(
    kept: Mapping[int, float], axes: Axes, letters: str, probed: str, *, inches: bool
) -> list[str]:
    """``$#``: work offsets, homes, G92, the tool's length, the last probe.

    Args:
        kept: persistent parameters.
        axes: as they are written.
        letters: of the axes, in machine order.
        probed: the last ``[PRB:...]``.
        inches: ``$13``.
    """
    tables = [
        *((SYSTEMS[n - 1], first_of_system(n)) for n in range(1, 7)),
        ("G28", G28_HOME),
        ("G30", G30_HOME),
        ("G92", G92_OFFSET),
    ]
    lines = [
        f"[{said}:{axes.written(stored(kept, first, letters), inches=inches)}]"
        for said, first in tables
    ]
    tool = stored(kept, TOOL_OFFSET, letters)
    length_mm = tool[letters.index("z")] if "z" in letters else 0.0
    length = f"{length_mm / _MM_PER_INCH:.4f}" if inches else f"{length_mm:.3f}"
    return [*lines, f"[TLO:{length}]", probed]
