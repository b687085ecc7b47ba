"""The app as its terminal sees it: how much waits to be done, and which keys are held."""

from collections.abc import Callable

from fraese.ui.fingers import Fingers
from fraese.ui.heldkeys import HeldKeys
from fraese.ui.machinelink import MachineLink
from fraese.ui.messages import KeyUp
from fraese.ui.viewed import ViewedApp


class HeardApp(ViewedApp):
    """An app that is told things from the thread that reads the terminal."""

    link: MachineLink
    _fingers: Fingers

    def __init__(self) -> None:
        self._in_app: Callable[[Callable[[], object]], object] = lambda action: None
        # Each is counted up by one thread only: what two count gets lost.
        self._typed = self._queued = 0
        self._strokes = HeldKeys()
        super().__init__()

    def backlog(self) -> int:
        """So many things that were typed wait to be done; from any thread."""
        on_its_way = self._typed - self._queued
        return on_its_way + sum(each.message_queue_size for each in self.screen_stack[-1:])

    def hears(self) -> None:
        """One more was typed; from the terminal's thread."""
        self._typed += 1
        self._in_app(self._has_heard)

    def _has_heard(self) -> None:
        # What was typed lies in the queue now, behind this.
        self._queued += 1

    def tells_releases(self, tells: bool) -> None:
        """Whether the terminal says when a key comes up; from the terminal's thread."""
        self._strokes.tells = tells

    def lets_go(self, key: str = "") -> None:
        """A key was let go, or (none) all of them; at once, from the terminal's thread."""
        if not key or key == self._strokes.holds:
            self.link.let_go_held()

    def let_go_of_pad(self) -> None:
        """A hand that does something else has left the button of the jog pad."""
        if not self._strokes.holds:
            self.link.let_go_held()

    def on_key_up(self, message: KeyUp) -> None:
        """What the key was held for is over."""
        self._fingers.up(message.key)
