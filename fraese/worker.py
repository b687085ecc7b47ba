"""A thread that owns a controller: for an app whose own thread must stay free.

Rule 1: commands wait in line one at a time. While something runs, at most one more is taken, so
        that a held key leaves no backlog that moves the mill after it is let go.
Rule 2: brake and stop do not wait in line: they go straight to the driver's flag, and what waits
        is dropped.
Rule 3: nothing that a command raises is lost: refusals and surprises go to ``on_refusal``; after a
        surprise the motors have been stopped.
"""

import queue
import threading
import time
from collections.abc import Callable

from fraese import log
from fraese.controller import Controller
from fraese.errors import FraeseError
from fraese.state import Status

Command = Callable[[], object]

#: How often the inputs are looked at when nothing runs.
_IDLE_S = 0.05


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
        self._commands: queue.Queue[Command] = queue.Queue(maxsize=1)
        self._quit = threading.Event()
        self._thread = threading.Thread(target=self._loop, name="machine", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def submit(self, command: Command) -> bool:
        """Do this next; False: something waits already and the command was not taken."""
        try:
            self._commands.put_nowait(command)
        except queue.Full:
            return False
        return True

    def cancel(self) -> None:
        """Brake, and drop what waits."""
        self._forget()
        self._controller.cancel()

    def stop(self) -> None:
        """Stop without ramp, and drop what waits."""
        self._forget()
        self._controller.stop()

    def close(self) -> None:
        """Cancel what runs, wait for standstill, motors off."""
        self._quit.set()
        self.cancel()
        self._thread.join(timeout=10)
        self._controller.close()

    def _forget(self) -> None:
        while True:
            try:
                self._commands.get_nowait()
            except queue.Empty:
                return

    def _loop(self) -> None:
        while not self._quit.is_set():
            since = time.monotonic()
            try:
                command = self._commands.get(timeout=_IDLE_S)
            except queue.Empty:
                self._controller.idle(time.monotonic() - since)
                self._on_idle()
                continue
            self._do(command)
            self._on_idle()

    def _do(self, command: Command) -> None:
        try:
            command()
            if self._controller.run() is Status.CANCEL:
                self._controller.acknowledge()
        except FraeseError as error:
            self._on_refusal(str(error))
        except Exception as error:
            log.write("worker", "_do", "error", repr(error))
            self._controller.stop()
            self._on_refusal(f"Stopped by an error in the program: {error!r}.")
