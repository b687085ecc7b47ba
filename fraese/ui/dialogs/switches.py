"""The page on which each end switch is pressed by hand and seen."""

from collections.abc import Callable

from textual.app import ComposeResult
from textual.containers import Vertical

from fraese.control.state import MachineState
from fraese.control.switchtest import SwitchTest
from fraese.phrases import spoken
from fraese.ui.dialogs.page import LivePage
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.shape import Shape
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.status import switch_words

Hand = Callable[[str, bool], None]


class SwitchRow(Fact):
    """One switch; a click asks for it."""

    def __init__(self, page: "SwitchPage", name: str) -> None:
        super().__init__(id=f"switch-{name}", classes="switch-row")
        self._page = page
        self._end_name = name

    def on_click(self) -> None:
        """Ask for this one."""
        self._page.ask(self._end_name)


class SwitchPage(LivePage[None]):
    """Asks for one switch after the other; motors stand.

    Args:
        keys: the table.
        shape: which axes there are.
        state: how the machine stands.
        hand: presses (True) and lets go of a switch where the machine is simulated.
        tick_off: told each switch that was seen.
    """

    AREA = Area.SWITCHES
    COVERS = True

    def __init__(
        self,
        keys: KeyTable,
        shape: Shape,
        state: MachineState,
        hand: Hand | None = None,
        tick_off: Callable[[str], object] = lambda name: None,
    ) -> None:
        super().__init__(keys)
        self._state = state
        self._test = SwitchTest(shape.names_with_switches)
        self._rows = {name: SwitchRow(self, name) for name in self._test.names}
        self._hand = hand
        self._tick_off = tick_off
        self._held = ""
        self._input = Fact("", id="switch-input")
        self._pins = Fact("", id="switch-pins")
        self._sentence = Fact("", id="switch-sentence")

    @property
    def test(self) -> SwitchTest:
        """How far it is ticked off."""
        return self._test

    def compose(self) -> ComposeResult:
        """Heading, switches, input, what to do."""
        keys = self.keys.hint(self.AREA, but="press" if self._hand is None else None)
        with Vertical(classes="dialog"):
            yield Fact(spoken("Switch test"), classes="dialog-title")
            yield self._sentence
            yield from self._rows.values()
            yield self._input
            yield self._pins
            yield Fact(keys, classes="hint")

    def on_mount(self) -> None:
        """Draw the list."""
        self.show(self._state)

    def on_unmount(self) -> None:
        """Take the hand off the switch."""
        if self._hand is not None and self._held:
            self._hand(self._held, False)

    def ask(self, name: str) -> None:
        """Ask for this one."""
        self._test.ask(name)
        self._draw()

    def action_step(self, by: int) -> None:
        """Ask for another one."""
        self._test.step(by)
        self._draw()

    def action_press(self) -> None:
        """The hand at the simulated mill."""
        if self._hand is None:
            return
        if self._held:
            self._hand(self._held, False)
            self._held = ""
        else:
            self._held = self._test.asked
            self._hand(self._held, True)

    def show(self, state: MachineState) -> None:
        """Take the state's reading of the input."""
        seen = self._test.look(state.switch_closed)
        if seen:
            self._tick_off(seen)
            self.app.bell()
        self._input.show(switch_words(state), "-alarm" if state.switch_closed else "-weak")
        levels = "  ".join(
            f"{pin} {spoken('high') if high else spoken('low')}"
            for pin, high in sorted(state.inputs.items())
        )
        self._pins.show(spoken("input pins  {levels}", levels=levels))
        self._draw()

    def _draw(self) -> None:
        for name, row in self._rows.items():
            presses = self._test.presses[name]
            asked = "▶" if name == self._test.asked and not self._test.done else " "
            times = (
                spoken("seen {presses} times", presses=presses)
                if presses > 1
                else spoken("seen")
                if presses
                else spoken("not yet")
            )
            row.show(
                f" {asked} {'✓' if presses else '·'} {name}   {times}",
                "-good" if presses else "",
            )
        self._sentence.show(self._test.sentence(), "-alarm" if self._test.stuck else "")
