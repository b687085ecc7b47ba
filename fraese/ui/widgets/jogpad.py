"""A pad to jog with the mouse: a click is one width, a button that is held runs until it is let go.

Who leaves the button with the mouse has let it go. Keys and another window end it in the app.

    Y+      Z+
X−      X+
    Y−      Z−
"""

from collections.abc import Sequence
from typing import Final

from textual import events
from textual.app import ComposeResult
from textual.containers import Grid
from textual.message import Message
from textual.timer import Timer
from textual.widgets import Static

from fraese.ui.shape import AxisShape

#: Down for so long, a button is held.
HELD_S: Final = 0.3
#: So often it is said that it still is.
_AGAIN_S: Final = 0.1


class JogButton(Static):
    """One direction of one axis; tells its screen what is done with it.

    Args:
        axis: which,
        sign: and which way.
    """

    class Pressed(Message):
        """A click: one width."""

        def __init__(self, axis: str, sign: int) -> None:
            super().__init__()
            self.axis, self.sign = axis, sign

    class Held(Pressed):
        """Held down from now on."""

    class StillHeld(Message):
        """Held, and the app is awake."""

    class LetGo(Message):
        """Not held any more."""

    def __init__(self, axis: AxisShape, sign: int) -> None:
        label = f"{axis.letter}{'+' if sign > 0 else '−'}"
        super().__init__(
            label, classes="jog-button", id=f"jog-{axis.name}-{'more' if sign > 0 else 'less'}"
        )
        self._axis = axis.name
        self._sign = sign
        self._timer: Timer | None = None
        self._is_held = False

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """A click, or the beginning of more."""
        event.stop()
        self.capture_mouse()
        self.add_class("-down")
        self._timer = self.set_timer(HELD_S, self._begin)

    def on_mouse_up(self, event: events.MouseUp) -> None:
        """The end of it."""
        event.stop()
        was_down, was_held = self._timer is not None, self._is_held
        self._end()
        if was_down and not was_held:
            self.post_message(self.Pressed(self._axis, self._sign))

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Off the button it may come up where nobody hears it, outside the window."""
        if self._timer is not None and not self.region.contains_point(event.screen_offset):
            self._end()

    def on_mouse_release(self) -> None:
        """Somebody else has the mouse: that is a release, too."""
        self._end()

    def on_hide(self) -> None:
        """Nobody sees it any more."""
        self._end()

    def _begin(self) -> None:
        self._is_held = True
        self.post_message(self.Held(self._axis, self._sign))
        self._timer = self.set_interval(_AGAIN_S, self._again)

    def _again(self) -> None:
        self.post_message(self.StillHeld())

    def _end(self) -> None:
        if self._timer is None:
            return
        self._timer.stop()
        self._timer = None
        self.remove_class("-down")
        self.release_mouse()
        if self._is_held:
            self._is_held = False
            self.post_message(self.LetGo())


class JogPad(Grid):
    """Buttons where their directions are: X from left to right, Y and all others up and down.

    Args:
        axes: of the machine.
    """

    def __init__(self, axes: Sequence[AxisShape]) -> None:
        super().__init__(id="jog-pad")
        by_name = {axis.name: axis for axis in axes}
        x, y = by_name.get("x"), by_name.get("y")
        others = [axis for axis in axes if axis not in (x, y)]
        self._cells = [
            [None, (y, 1), None, *((axis, 1) for axis in others)],
            [(x, -1), None, (x, 1), *(None for _ in others)],
            [None, (y, -1), None, *((axis, -1) for axis in others)],
        ]
        columns = 3 + len(others)
        self.styles.grid_size_columns = columns
        self.styles.width = 6 * columns + 1

    def compose(self) -> ComposeResult:
        """Row by row."""
        for row in self._cells:
            for cell in row:
                if cell is None or cell[0] is None:
                    yield Static("", classes="no-button")
                else:
                    yield JogButton(cell[0], cell[1])
