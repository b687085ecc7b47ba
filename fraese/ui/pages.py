"""Pages above the main screen that show the machine."""

from abc import abstractmethod
from typing import TypeVar

from textual.screen import ModalScreen

from fraese.control.state import MachineState

R = TypeVar("R")


class LivePage(ModalScreen[R]):
    """A page that is told every state that is drawn."""

    @abstractmethod
    def show(self, state: MachineState) -> None:
        """Draw what changed."""
