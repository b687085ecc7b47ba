"""A thread that owns a controller: for an app whose own thread must stay free.

Rule 1: one command runs, and at most one waits: a held key leaves no backlog that moves the mill
        after it is let go. What waits must say that it may follow what runs (a jog a jog), so that
        nothing given while a long program runs is done when it ends.
Rule 2: brake and stop do not wait in line: they go straight to the driver's flag, and what waits
        is dropped. They also count for a command that has been taken but has not yet started.
Rule 3: nothing that a command raises is lost: refusals and surprises go to ``on_refusal``; after a
        surprise the motors have been stopped.
"""

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from fraese import log
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import FraeseError
from fraese.phrases import phrase

Command = Callable[[], object]

#: How often the inputs are looked at when nothing runs.
_IDLE_S = 0.05


@dataclass(frozen=True, slots=True)
class _Item:
    command: Command
    group: str


class Worker:
    """Runs commands and the run loop in a thread.

    Args:
        controller: only touched from the thread from now on, except for its any-thread methods.
        on_refusal: told one sentence when a command was refused; called in the thread.
        on_idle: called in the thread at standstill, some twenty times a second.
    """

    def __init__(
        self,
        controller: Controller,
        on_refusal: Callable[[str], None],
        on_idle: Callable[[], None],
    ) -> None:
        self._controller = controller
        self._on_refusal = on_refusal
        self._on_idle = on_idle
        self._news = threading.Condition()
        self._waiting: _Item | None = None
        self._doing: _Item | None = None
        self._guest: _Item | None = None
        self._cancelled = False
        self._trouble = ""
        self._quit = False
        self._closing = threading.Lock()
        self._closed = False
        controller.set_break_key(self._between)
        self._thread = threading.Thread(target=self._loop, name="machine", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Something runs or waits."""
        with self._news:
            return self._doing is not None or self._waiting is not None

    @property
    def cancelled(self) -> bool:
        """Since the command in hand was taken, somebody has told it to end."""
        return self._cancelled

    def submit(self, command: Command, group: str = "") -> bool:
        """Do this next; False: it was not taken, since something else runs or waits.

        While a job asks the operator something it is done at once, as the job's guest.

        Args:
            command: called in the thread; then the run loop works off what it started.
            group: while a command of the same group runs, this one may wait behind it.
        """
        with self._news:
            if self._quit or self._waiting is not None:
                return False
            if self._doing is not None and self._controller.question:
                if self._guest is not None:
                    return False
                self._guest = _Item(command, group)
                return True
            if self._doing is not None and not (group and group == self._doing.group):
                return False
            self._waiting = _Item(command, group)
            self._news.notify()
        return True

    def cancel(self) -> None:
        """Brake, and drop what waits."""
        self._forget()
        if self._controller.status is Status.RUN:
            self._controller.cancel()

    def stop(self) -> None:
        """Stop without ramp, and drop what waits."""
        self._forget()
        if self._controller.status is Status.RUN:
            self._controller.stop()

    def close(self) -> None:
        """Cancel what runs, wait for standstill, motors off.

        Safe to call twice, also at once from two threads: both come back when it is closed.
        """
        with self._closing:
            if self._closed:
                return
            self._closed = True
            with self._news:
                self._quit = True
                self._news.notify()
            self.cancel()
            if self._thread.is_alive():
                self._thread.join(timeout=10)
            self._controller.close()

    def _forget(self) -> None:
        with self._news:
            self._waiting = self._guest = None
            self._cancelled = True

    def _take(self) -> _Item | None:
        with self._news:
            if self._waiting is None and not self._quit:
                self._news.wait(_IDLE_S)
            self._doing, self._waiting = self._waiting, None
            self._cancelled = False
            return self._doing

    def _between(self) -> None:
        """Between two slices of a job: a guest's turn; who closes waits for nobody's answer."""
        with self._news:
            guest, self._guest = self._guest, None
            leaves = self._quit
        if leaves:
            self._controller.cancel()
        if guest is None:
            return
        try:
            guest.command()
        except FraeseError as error:
            self._on_refusal(str(error))
        except Exception as error:
            log.write("worker", "_between", "error", repr(error))
            self._controller.stop()
            self._on_refusal(
                phrase("Stopped by an error in the program: {error}.", error=repr(error))
            )

    def _loop(self) -> None:
        while not self._quit:
            since = time.monotonic()
            item = self._take()
            if item is None:
                self._idle(time.monotonic() - since)
            else:
                self._do(item.command)
                with self._news:
                    self._doing = self._guest = None
            self._on_idle()

    def _idle(self, elapsed_s: float) -> None:
        """Look at the machine; the same trouble is told once, not twenty times a second."""
        try:
            self._controller.idle(elapsed_s)
            self._trouble = ""
        except Exception as error:
            if repr(error) != self._trouble:
                self._trouble = repr(error)
                self._on_refusal(str(error))

    def _do(self, command: Command) -> None:
        before = self._controller.status
        try:
            command()
            # Only now is there a job that a cancel can reach.
            if self._cancelled:
                self._controller.cancel()
            if self._controller.run() is Status.CANCEL:
                self._controller.acknowledge()
        except FraeseError as error:
            self._abandon(before)
            self._on_refusal(str(error))
        except Exception as error:
            log.write("worker", "_do", "error", repr(error))
            self._abandon(before)
            self._on_refusal(
                phrase("Stopped by an error in the program: {error}.", error=repr(error))
            )

    def _abandon(self, before: Status) -> None:
        """Whatever was raised in the middle of a run: it is ended, and the machine is free again.

        An error that waited to be acknowledged before goes on waiting.
        """
        if self._controller.status is Status.RUN:
            self._controller.stop()
            with contextlib.suppress(Exception):
                self._controller.run()
        if before is not Status.ERROR:
            self._controller.acknowledge()
