"""Pages above a view that show the machine."""

from abc import abstractmethod
from typing import TypeVar

from textual.await_complete import AwaitComplete
from textual.screen import ModalScreen

from fraese.control.state import MachineState
from fraese.ui.bindings import bind
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.room import HEIGHTS, WIDTHS

R = TypeVar("R")


class Page(ModalScreen[R | None]):
    """A page with keys of its own; the result None: nothing is wanted.

    Args:
        keys: the table; ``AREA`` says which rows are the page's.
    """

    AREA: Area
    #: In a small terminal it lies over the numbers of Move.
    COVERS = False
    HORIZONTAL_BREAKPOINTS = WIDTHS
    VERTICAL_BREAKPOINTS = HEIGHTS

    def __init__(self, keys: KeyTable) -> None:
        super().__init__()
        self.keys = keys
        self._is_to_close_with: tuple[R | None] | None = None
        bind(self, keys.of(self.AREA))

    @property
    def is_there(self) -> bool:
        """It has not been closed.

        A stop key closes it before a button that was pressed earlier is heard.
        """
        return self in self.app.screen_stack

    def dismiss(self, result: R | None = None) -> AwaitComplete:
        """Close it with this result, once; what lies above it goes first."""
        if not self.is_there:
            return AwaitComplete()
        if self.app.screen is not self:
            # Textual would close what lies above.
            self._is_to_close_with = (result,)
            return AwaitComplete()
        return super().dismiss(result)

    def on_screen_resume(self) -> None:
        """What lay above it has gone."""
        if self._is_to_close_with is not None:
            self.dismiss(*self._is_to_close_with)

    def action_back(self) -> None:
        """Nothing is wanted."""
        self.dismiss(None)


class LivePage(Page[R]):
    """A page that is told every state that is drawn."""

    @abstractmethod
    def show(self, state: MachineState) -> None:
        """Draw what changed."""
