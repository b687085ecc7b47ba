"""From the machine's thread to the screen: the latest state wins, alarms queue.

    run loop --offer--> [ latest ] --post, once--> app: take() and redraw

Rule 1: while a state waits to be drawn, a newer one takes its place and nothing is posted: however
        fast the machine reports, the app draws as often as it can and likes.
Rule 2: a state equal to the one before is not worth a message: at standstill nothing is drawn.
"""

import threading
from collections.abc import Callable

from fraese.control.state import MachineState


class StateFeed:
    """Holds the latest state until the app takes it.

    Args:
        post: tells the app, from the machine's thread, that there is something to take.
    """

    def __init__(self, post: Callable[[], object]) -> None:
        self._post = post
        self._lock = threading.Lock()
        self._latest: MachineState | None = None
        self._posted = False

    def offer(self, state: MachineState) -> None:
        """From the machine's thread: this is how it stands."""
        with self._lock:
            if state == self._latest:
                return
            self._latest = state
            if self._posted:
                return
            self._posted = True
        self._post()

    def take(self) -> MachineState | None:
        """From the app's thread: the latest state; the next change posts again."""
        with self._lock:
            self._posted = False
            return self._latest
