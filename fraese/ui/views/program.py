"""The view Program: the path drawn, the lines in step with it, what runs and how far it is."""

from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.ui.keyrows import Area
from fraese.ui.programs import Program
from fraese.ui.views.running import RunsPrograms
from fraese.ui.views.view import Desk
from fraese.ui.widgets.programpane import ProgramPane


class ProgramView(RunsPrograms):
    """Toolpath, listing, progress, and the switches of a run."""

    AREA = Area.PROGRAM
    ALSO = (Area.RUNNING,)
    NAME = "program"
    IS_BESIDE_POSITION = False

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._pane = ProgramPane(desk.programs, self.state, desk.keys.said("open"))

    def inner(self) -> ComposeResult:
        """All in one pane."""
        yield self._pane

    def show_inner(self, state: MachineState) -> None:
        """Draw what changed."""
        self._pane.show(state)

    def show_program(self, program: Program) -> None:
        """The pane sees by itself what is loaded."""
        self._pane.show(self.state)

    def show_line(self, line: int) -> None:
        """Look at this line."""
        self._pane.listing.show_line(line)

    # --- looking ---------------------------------------------------------------------------------

    def action_next_side(self) -> None:
        """From another side."""
        self._pane.toolpath.next_side()

    def action_fit(self) -> None:
        """All is seen."""
        self._pane.toolpath.fit()

    def action_zoom(self, steps: int) -> None:
        """Nearer, or further away."""
        self._pane.toolpath.zoom(steps)

    def action_pan(self, right: int, down: int) -> None:
        """Look elsewhere."""
        self._pane.toolpath.pan(right, down)

    def action_scroll_path(self, pages: int) -> None:
        """Look elsewhere in the lines."""
        self._pane.listing.scroll_pages(pages)

    def action_switch(self, name: str) -> None:
        """Turn a switch of a run."""
        self.note(self.desk.link.switch_run(name))
