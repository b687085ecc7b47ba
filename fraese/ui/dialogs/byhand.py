"""Lines of Move: G-code and places, the present position, probing."""

import re
from pathlib import Path
from typing import Final

from textual.app import ComposeResult

from fraese.axiswords import axis_words, target, with_points
from fraese.control.controller import Controller
from fraese.errors import UsageError
from fraese.phrases import comma_is_decimal, shown, spoken
from fraese.ui.dialogs.line import Command, LineDialog
from fraese.ui.handtools import HandTools
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.linehistory import LineHistory
from fraese.ui.machinelink import MachineLink
from fraese.ui.widgets.fact import Fact

_HALF: Final = re.compile(r"([a-z])\s*/\s*2", re.IGNORECASE)
#: Under these names it is remembered.
_POSITION: Final = "set position"
_CYCLE: Final = "probe"
_MAP: Final = spoken("height map")
#: Under this name it is remembered which height map was probed or chosen last.
LAST_MAP: Final = "height map"
_VALUE: Final = re.compile(r"([a-z]+)\s*=?\s*(\d+(?:[.,]\d+)?)\s*", re.IGNORECASE)


class TypedDialog(LineDialog):
    """G-code, or a place to go to; it stays open, and goes back to what was typed before."""

    AREA = Area.TYPED
    HEADING = spoken("Type a line: G-code, or a place in work coordinates")
    YES = spoken("Do it")

    def __init__(
        self, keys: KeyTable, link: MachineLink, tools: HandTools, history: LineHistory
    ) -> None:
        super().__init__(keys, link, example=spoken("X10 Y5   or   G1 X10 F300   or   G55"))
        self._tools = tools
        self._history = history

    def command(self, line: str) -> Command:
        """A place, or a line of the language."""
        if not line:
            raise UsageError(spoken("Type a place such as X10 Y5, or a line of G-code."))
        try:
            there = target(line, self.link.shape.names)
        except UsageError:
            typed = with_points(line) if comma_is_decimal() else line
            return lambda controller: self._tools.typed(controller, typed)
        return lambda controller: controller.move_to(
            there.targets_mm, feed_mm_min=there.feed_mm_min
        )

    def taken(self, line: str) -> None:
        """The next one."""
        self._history.add(line)
        self.put("")

    def action_history(self, by: int) -> None:
        """What was typed before."""
        self.put(self._history.back(by))


class SetDialog(LineDialog):
    """What the present position is to be: zero, half, or the thickness of a plate."""

    AREA = Area.SET
    HEADING = spoken("The present position is to be")
    YES = spoken("Set it")

    def __init__(self, keys: KeyTable, link: MachineLink, inputs: dict[str, str]) -> None:
        example = spoken("X0 Y0   or   Z12.5 (on a plate)   or   X/2 (half)")
        super().__init__(keys, link, inputs.get(_POSITION, ""), example)
        self._inputs = inputs

    def taken(self, line: str) -> None:
        """It is offered again the next time."""
        self._inputs[_POSITION] = line
        super().taken(line)

    def command(self, line: str) -> Command:
        """Coordinates for some axes."""
        halves = {name.lower() for name in _HALF.findall(line)}
        rest = _HALF.sub("", line).strip()
        names = self.link.shape.names
        values = axis_words(rest, names) if rest or not halves else {}
        strange = sorted(halves - set(names))
        if strange:
            raise UsageError(spoken("There is no axis {strange}.", strange=strange[0].upper()))

        def change(controller: Controller) -> None:
            state = controller.state()
            wanted = dict(values)
            wanted |= {name: state.work_mm[names.index(name)] / 2 for name in halves}
            for name, value in wanted.items():
                controller.set_zero((name,), value)

        return change


class ProbeDialog(LineDialog):
    """Which cycle, and what it has to be told.

    Args:
        keys: the table.
        link: to the machine.
        tools: what knows the cycles.
        inputs: what was typed before.
        new_map: file of a height map, if that is probed.
    """

    AREA = Area.PROBE
    HEADING = spoken("Probe, and set the work zero")
    YES = spoken("Probe")
    #: What each needs to be told, and what is proposed.
    _TOLD: Final = (
        ("down on", "thickness 0 reach 20"),
        ("edge", "diameter 3 reach 20"),
        ("corner", "diameter 3 reach 20 width 20"),
        ("centre of a hole", "diameter 3 reach 20"),
        ("centre of a boss", "diameter 3 width 20 depth 3 reach 20"),
        (_MAP, "x 80 y 60 every 10 clearance 2 depth 2"),
    )

    def __init__(
        self,
        keys: KeyTable,
        link: MachineLink,
        tools: HandTools,
        inputs: dict[str, str],
        new_map: Path,
    ) -> None:
        super().__init__(keys, link)
        self._tools = tools
        self._inputs = inputs
        self._new_map = new_map
        names = link.shape.names
        maps = (_MAP,) if {"x", "y", "z"} <= set(names) else ()
        self._cycles = (*tools.cycles(names), *maps)
        last = inputs.get(_CYCLE, "")
        self._at = self._cycles.index(last) if last in self._cycles else 0
        self._cycle = Fact("", classes="one-line line-text")

    def inner(self) -> ComposeResult:
        """Cycle and line."""
        yield self._cycle
        yield from super().inner()

    def on_mount(self) -> None:
        """The first cycle."""
        super().on_mount()
        self._show()

    def action_cycle(self, by: int) -> None:
        """The next one, or the one before."""
        self._at = (self._at + by) % len(self._cycles)
        self._show()

    def _show(self) -> None:
        name = self._cycles[self._at]
        into = spoken(" from the work zero, into {file}", file=self._new_map.name)
        self._cycle.show(
            spoken(
                "{name}   ({at} of {count})",
                name=f"{shown(name)}{into}" if name == _MAP else name,
                at=self._at + 1,
                count=len(self._cycles),
            )
        )
        proposed = next(told for word, told in self._TOLD if name.startswith(word))
        self.put(self._inputs.get(f"{_CYCLE} {name}", proposed))

    def taken(self, line: str) -> None:
        """It is offered again the next time."""
        name = self._cycles[self._at]
        self._inputs |= {_CYCLE: name, f"{_CYCLE} {name}": line}
        if name == _MAP:
            self._inputs[LAST_MAP] = str(self._new_map)
        super().taken(line)

    def command(self, line: str) -> Command:
        """The cycle with these values."""
        values: dict[str, float] = {}
        at = 0
        while at < len(line):
            found = _VALUE.match(line, at)
            if found is None:
                raise UsageError(
                    spoken('"{line}" is not a word with a number, as in reach 20.', line=line[at:])
                )
            values[found[1].lower()] = float(found[2].replace(",", "."))
            at = found.end()
        name = self._cycles[self._at]
        if name == _MAP:
            return lambda controller: self._tools.probe_map(controller, self._new_map, values)
        return lambda controller: self._tools.probe(controller, name, values)
