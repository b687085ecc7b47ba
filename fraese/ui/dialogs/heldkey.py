"""The page that measures how a key repeats that is held; nothing moves there."""

from typing import Final

from textual.app import ComposeResult
from textual.containers import Vertical

from fraese.errors import UsageError
from fraese.phrases import spoken
from fraese.ui.dialogs.page import Page
from fraese.ui.heldkeys import HeldKeys, Manners
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.measuring import REPEATS, Measurement, figures
from fraese.ui.widgets.fact import Fact, Flowing

_WIDTH: Final = 30


class HeldKeyPage(Page[Manners]):
    """Counts the repeats of one key; what it finds counts at once.

    Args:
        keys: the table.
        strokes: have seen every key, and when it came; they take over what is measured.
    """

    AREA = Area.HELD_KEY

    def __init__(self, keys: KeyTable, strokes: HeldKeys) -> None:
        super().__init__(keys)
        self._strokes = strokes
        self._measurement = Measurement()
        self._bar = Fact("", id="held-key-bar")
        self._found = Flowing("", id="held-key-found")

    def compose(self) -> ComposeResult:
        """What to do, how far it is, what was found."""
        with Vertical(classes="dialog"):
            yield Fact(spoken("How this terminal repeats a key"), classes="dialog-title")
            yield Flowing(
                spoken(
                    "Hold {said} down until the bar is full, about two seconds; nothing moves"
                    " here. A jog key that is held then sets the axis in motion at its second"
                    " repeat, and silence brakes as soon as this terminal allows.",
                    said=self.keys.said("measure_stroke"),
                )
            )
            yield self._bar
            yield self._found
            yield Fact(self.keys.hint(self.AREA), classes="hint")

    def on_mount(self) -> None:
        """What is known up to now."""
        self._draw()
        self._show_known()

    def _show_known(self) -> None:
        manners = self._strokes.manners
        known = (
            spoken("measured: {figures}", figures=figures(manners))
            if manners.is_measured
            else spoken("Nobody has measured this terminal yet.")
        )
        self._found.show(known, "-good" if manners.is_measured else "")

    def action_measure_stroke(self) -> None:
        """The key was pressed, or repeats."""
        was_enough = self._measurement.is_enough
        self._measurement.stroke(self._strokes.at_s)
        self._draw()
        if self._measurement.is_enough and not was_enough:
            self._judge()

    def _judge(self) -> None:
        try:
            self._strokes.manners = self._measurement.manners()
        except UsageError as error:
            self._found.show(str(error), "-warn")
        else:
            self._show_known()
            self.app.bell()

    def _draw(self) -> None:
        full = _WIDTH * min(self._measurement.gaps, REPEATS) // REPEATS
        self._bar.show("█" * full + "░" * (_WIDTH - full))
