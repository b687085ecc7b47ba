"""The main screen in its three pictures.

commands    data with commands
position    data without commands, position with the way between the limits
path        path data with position
"""

from collections.abc import Sequence
from typing import Final

from textual.app import ComposeResult
from textual.containers import Container
from textual.screen import Screen
from textual.widgets import Footer

from fraese.control.state import MachineState
from fraese.ui.commands import CommandList
from fraese.ui.path import PathView
from fraese.ui.position import PositionPanel
from fraese.ui.status import JobLine, MessageLine, StatusPanel, WidthBar

PICTURES: Final = ("commands", "position", "path")


class MachineScreen(Screen[None]):
    """Composes the panels and hands every state to those that are seen.

    Args:
        axes: names.
        machine_name: see ``StatusPanel``.
    """

    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (140, "-wide")]  # noqa: RUF012
    VERTICAL_BREAKPOINTS = [(0, "-low"), (28, "-high"), (45, "-tall")]  # noqa: RUF012

    def __init__(self, axes: tuple[str, ...], machine_name: str) -> None:
        super().__init__(classes=PICTURES[0])
        self._status = StatusPanel(machine_name)
        self._position = PositionPanel(axes)
        self._widths = WidthBar()
        self._path = PathView()
        self._job = JobLine()
        self._message = MessageLine(id="message")
        self._state: MachineState | None = None
        self._stopping = False

    def compose(self) -> ComposeResult:
        """Top to bottom."""
        yield self._status
        with Container(id="body"):
            yield self._position
            yield self._path
        yield self._widths
        yield CommandList()
        yield self._job
        yield self._message
        yield Footer(compact=True)

    @property
    def picture(self) -> str:
        """One of ``PICTURES``."""
        return next(name for name in PICTURES if self.has_class(name))

    def show_picture(self, name: str) -> None:
        """Change to this one."""
        self.remove_class(*PICTURES)
        self.add_class(name)
        # What was hidden has not been kept up to date.
        self.call_after_refresh(self._show_again)

    def on_resize(self) -> None:
        """Gauges and bars are as long as there is room."""
        self.call_after_refresh(self._show_again)

    def _show_again(self) -> None:
        if self._state is not None:
            self.show(self._state, self._stopping)

    def show(self, state: MachineState, stopping: bool) -> None:
        """Draw what changed; see ``StatusPanel.show``."""
        self._state, self._stopping = state, stopping
        self._status.show(state, stopping)
        self._position.show(state)
        self._job.show_job(state)
        if self._path.display:
            in_program = state.job is not None and state.job.lines > 0
            self._path.mark(state.job.line if state.job and in_program else 0)

    def show_width(self, chosen: int, factor: int) -> None:
        """Mark the jog width."""
        self._widths.show(chosen, factor)

    def show_program(self, name: str, lines: Sequence[str]) -> None:
        """This program is loaded."""
        self._status.show_program(name)
        self._path.load(lines)

    def scroll_path(self, pages: float) -> None:
        """Look elsewhere in the program."""
        self._path.scroll_pages(pages)

    def say(self, text: str, tone: str = "") -> None:
        """Put this into the message line."""
        self._message.show(text, tone)
