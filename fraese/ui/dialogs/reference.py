"""Which axes to reference."""

from dataclasses import dataclass

from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.widgets import Button, Checkbox

from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog, Tick
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.shape import Shape


@dataclass(frozen=True, slots=True)
class Reference:
    """Which axes; ``measure``: run to the other end too."""

    axes: tuple[str, ...]
    measure: bool


class ReferenceDialog(Dialog[Reference]):
    """Which axes to reference.

    Args:
        keys: the table.
        shape: which axes there are.
    """

    AREA = Area.REFERENCE
    HEADING = spoken("Reference: run to the end switches")
    YES = spoken("Reference")

    def __init__(self, keys: KeyTable, shape: Shape) -> None:
        super().__init__(keys)
        self._shape = shape

    def inner(self) -> ComposeResult:
        """A box for each axis, ticked where there are switches; others are referenced "here"."""
        with Horizontal(classes="boxes"):
            for axis in self._shape.axes:
                label = (
                    axis.letter
                    if axis.has_switches
                    else spoken("{letter} here", letter=axis.letter)
                )
                yield Tick(label, axis.has_switches, id=f"axis-{axis.name}")
        yield Tick(spoken("measure the travel to the other end too"), id="measure")

    def action_tick(self, name: str) -> None:
        """Tick or untick."""
        self.query_one(f"#{name}", Checkbox).toggle()

    def action_accept(self) -> None:
        """Which boxes are ticked."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        ticked = {str(box.id) for box in self.query(Checkbox) if box.value}
        axes = tuple(name for name in self._shape.names if f"axis-{name}" in ticked)
        if not axes:
            self.complain(spoken("Choose at least one axis."))
            return
        self.dismiss(Reference(axes, "measure" in ticked))
