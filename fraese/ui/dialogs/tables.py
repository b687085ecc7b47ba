"""Tables that are changed by typed lines: work offsets, tools.

the table, scrolled
a line: which row, and what it is to be
"""

import re
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, Final

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from fraese.axiswords import axis_words
from fraese.control.controller import Controller
from fraese.control.tooltable import (
    Tool,
    Write,
    clear_tool,
    set_by_programs,
    store_tool,
    tool_table,
)
from fraese.control.workcommands import select_system, store_system, systems
from fraese.errors import UsageError
from fraese.phrases import phrase, spoken
from fraese.ui.dialogs.line import Command, LineDialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.machinelink import MachineLink
from fraese.ui.widgets.fact import Lines

_CLEAR: Final = "CLEAR"
_TOOL: Final = re.compile(r"t?\s*(\d{1,9})\b\s*(.*)", re.IGNORECASE | re.DOTALL)
_VALUES: Final = re.compile(r"((?:[ld]\s*=?\s*[-+]?[\d.,]+\s*)*)(.*)", re.IGNORECASE | re.DOTALL)
#: Typed for a remark, it takes the one there is away.
_NO_REMARK: Final = "-"


class TableDialog(LineDialog):
    """Rows, and a line that changes one of them; it stays open."""

    YES = spoken("Do it")
    COVERS = True
    LINES_ID: str

    def __init__(self, keys: KeyTable, link: MachineLink, example: str) -> None:
        super().__init__(keys, link, example=example)
        self._list = Lines("", id=self.LINES_ID)

    def inner(self) -> ComposeResult:
        """All rows, and the line."""
        with VerticalScroll(id="table", can_focus=False):
            yield self._list
        yield from super().inner()

    def on_mount(self) -> None:
        """How they are now."""
        super().on_mount()
        if not self.link.order_of(self.look):
            self.complain(spoken("The machine runs: the table cannot be changed now."))

    def look(self, controller: Controller) -> None:
        """Show how they are now; in the machine's thread."""
        self.call_later(self._show, self.rows(controller))

    def _show(self, rows: Sequence[str]) -> None:
        self._list.styles.height = max(1, len(rows))
        self._list.show("\n".join(rows))

    @abstractmethod
    def rows(self, controller: Controller) -> list[str]:
        """The table in words; in the machine's thread."""

    def action_scroll(self, pages: int) -> None:
        """Look further up or down."""
        self.query_one("#table").scroll_relative(y=5 * pages, animate=False)

    def taken(self, line: str) -> None:
        """The next one."""
        self.put("")


class OffsetsDialog(TableDialog):
    """The nine work offsets: chosen, changed, cleared."""

    AREA = Area.OFFSETS
    HEADING = spoken("Work offsets: their zeros in machine coordinates")
    LINES_ID = "systems"

    def __init__(self, keys: KeyTable, link: MachineLink, axes: Sequence[str]) -> None:
        example = spoken("G55 (choose)   or   G55 X10 Y5 (change)   or   G55 clear")
        super().__init__(keys, link, example)
        self._axes = axes

    def rows(self, controller: Controller) -> list[str]:
        """Two side by side."""
        chosen = controller.state().work.system
        cells = [
            f"{'▶' if name == chosen else ' '}{name:6}"
            + " ".join(
                f"{axis.upper()}{value:8.3f}"
                for axis, value in zip(self._axes, values, strict=True)
            )
            for name, values in systems(controller)
        ]
        half = -(-len(cells) // 2)
        width = max(map(len, cells)) + 2
        rows = ("".join(cell.ljust(width) for cell in cells[row::half]) for row in range(half))
        return [row.rstrip() for row in rows]

    def command(self, line: str) -> Command:
        """Choose, change or clear one."""
        name, _, rest = line.upper().partition(" ")
        rest = rest.strip()
        values = {} if rest == _CLEAR or not rest else axis_words(rest, self._axes)

        def change(controller: Controller) -> None:
            if rest:
                store_system(controller, name, values)
            else:
                select_system(controller, name)
            self.look(controller)

        return change


class ToolsDialog(TableDialog):
    """The tool table: changed, cleared; the next program finds it so.

    Args:
        keys: the table of keys.
        link: to the machine.
        write: keeps it; None: it lasts until the program ends.
        path: where it is kept; empty: nowhere.
    """

    AREA = Area.TOOLS
    HEADING = spoken("Tools: from the next program on, which may name no others")
    LINES_ID = "tools"

    def __init__(self, keys: KeyTable, link: MachineLink, write: Write | None, path: str) -> None:
        example = spoken("T3 L12.5 D6 end mill   or   T3 (what it is)   or   T3 clear")
        super().__init__(keys, link, example)
        self._write: Write = write or (lambda values: None)
        self._path = path
        self._tools: dict[int, Tool] = {}

    def rows(self, controller: Controller) -> list[str]:
        """One a line; which one is in the spindle."""
        self._tools = {tool.number: tool for tool in tool_table(controller)}
        now, by_program = controller.state().work.tool, set_by_programs(controller)
        by = spoken(" (set by a program)")
        place = (
            spoken("kept in {path}", path=self._path)
            if self._path
            else spoken("kept until fraese ends")
        )
        if not self._tools:
            return [spoken("The table is empty: every tool may be used, and has length 0."), place]
        return [
            f"    {spoken('tool'):>4} {spoken('length'):>9} {spoken('diameter'):>9}  {place}",
            *(
                f"{'▶' if tool.number == now else ' '}  {f'T{tool.number}':>5}"
                f" {tool.length_mm:9.3f} {tool.diameter_mm:9.3f}  {tool.remark}"
                f"{by if tool.number in by_program else ''}"
                for tool in self._tools.values()
            ),
        ]

    def command(self, line: str) -> Command:
        """Change or clear one, or put into the line what it is."""
        found = _TOOL.fullmatch(line)
        if found is None:
            raise UsageError(phrase("Type a tool with its values, as in T3 L12.5 D6 end mill."))
        number, rest = int(found[1]), found[2].strip()
        if rest.upper() == _CLEAR:
            return self._and_look(lambda controller: clear_tool(controller, number, self._write))
        known = self._tools.get(number, Tool(number))
        if not rest:
            return lambda controller: None
        tool = _changed(known, rest)
        return self._and_look(lambda controller: store_tool(controller, tool, self._write))

    def _and_look(self, command: Command) -> Command:
        def change(controller: Controller) -> Any:
            command(controller)
            self.look(controller)

        return change

    def taken(self, line: str) -> None:
        """The next one; of a tool alone, its values to be changed."""
        found = _TOOL.fullmatch(line)
        number = int(found[1]) if found and not found[2].strip() else 0
        tool = self._tools.get(number)
        if tool is not None:
            self.put(f"T{number} L{tool.length_mm:g} D{tool.diameter_mm:g} {tool.remark}".rstrip())
        elif number:
            self.put(f"T{number} L0 D0")
        else:
            super().taken(line)


def _changed(tool: Tool, text: str) -> Tool:
    """A line of the table as it is typed: L and D with their numbers, then a remark.

    Raises:
        UsageError: if a number is none.
    """
    found = _VALUES.fullmatch(text)
    assert found is not None
    values = axis_words(found[1], ("l", "d")) if found[1].strip() else {}
    remark = " ".join(found[2].split())
    return tool._replace(
        length_mm=values.get("l", tool.length_mm),
        diameter_mm=values.get("d", tool.diameter_mm),
        remark="" if remark == _NO_REMARK else remark or tool.remark,
    )
