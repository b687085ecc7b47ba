"""A thread that writes records, so that nobody waits for a disk while motors run.

Rule 1: the latest record wins; one that waits behind one that is being written is dropped for it.
Rule 2: as soon as one is durable its lease is granted, from here: nobody waits for the run loop.
"""

import threading
from collections.abc import Callable
from typing import Final, NamedTuple

from fraese.control.inforce import Asked
from fraese.control.savedstate import SavedState
from fraese.errors import FraeseError

_CLOSE_S: Final = 10.0


class Done(NamedTuple):
    """A record that became durable.

    Attributes:
        asked: which.
        at_ns: when.
    """

    asked: Asked
    at_ns: int


class Writer:
    """A thread that writes the latest record that it was given.

    Args:
        write: puts a state down.
        grant: lets motors play until then; from the thread. None: nobody can be told.
        now_ns: time.
    """

    def __init__(
        self,
        write: Callable[[SavedState, bool], None],
        grant: Callable[[int], None] | None,
        now_ns: Callable[[], int],
    ) -> None:
        self._write = write
        self._grant = grant
        self._now_ns = now_ns
        self._news = threading.Condition()
        self._next: tuple[SavedState, Asked] | None = None
        self._done: Done | None = None
        self._failure: FraeseError | None = None
        self._busy = self._quit = False
        self._thread: threading.Thread | None = None

    def ask(self, state: SavedState, asked: Asked) -> None:
        """Write this next; what still waits is dropped."""
        with self._news:
            self._next = state, asked
            self._news.notify_all()
        if self._thread is None:
            self._thread = threading.Thread(target=self._loop, name="journal", daemon=True)
            self._thread.start()

    @property
    def is_busy(self) -> bool:
        """Something is being written, or waits."""
        with self._news:
            return self._busy or self._next is not None

    def done(self) -> Done | None:
        """The last record that became durable since this was asked."""
        with self._news:
            done, self._done = self._done, None
            return done

    def failure(self) -> FraeseError | None:
        """Why the last one did not, once."""
        with self._news:
            failure, self._failure = self._failure, None
            return failure

    def wait(self, seconds: float) -> None:
        """Until nothing is left to be written, or so long."""
        with self._news:
            self._news.wait_for(lambda: not self._busy and self._next is None, seconds)

    def close(self) -> None:
        """Let it finish what it is at."""
        with self._news:
            self._next, self._quit = None, True
            self._news.notify_all()
        if self._thread is not None:
            self._thread.join(_CLOSE_S)

    def _loop(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._quit or self._next is not None)
                if self._next is None:
                    return
                (state, asked), self._next = self._next, None
                self._busy = True
            failure = None
            try:
                self._write(state, True)
                if asked.box is not None and self._grant is not None:
                    self._grant(asked.over_ns)
            except FraeseError as error:
                failure = error
            with self._news:
                self._busy = False
                if failure is None:
                    self._done = Done(asked, self._now_ns())
                else:
                    self._failure = failure
                self._news.notify_all()
