"""A machine's thread with a sender at it, and nobody else: what ``fraese serve`` runs."""

import time
from collections.abc import Callable, Sequence

from fraese.control.controller import Controller
from fraese.control.worker import Worker
from fraese.serve.server import Door, Server
from fraese.serve.session import Session
from fraese.serve.store import Store
from fraese.serve.system import Write


class Desk:
    """Puts worker, session and server together.

    Args:
        controller: owned by the worker's thread until ``close``, and closed then.
        store: what is kept for senders.
        write: changes the configuration.
        told: told what a person should know; from several threads.
    """

    def __init__(
        self,
        controller: Controller,
        store: Store,
        write: Write,
        told: Callable[[str], object],
    ) -> None:
        self._told = told
        self._worker = worker = Worker(controller, on_refusal=self._tell, on_idle=self._look)
        self.session = Session(
            controller, store, write, time.monotonic,
            wake=self._wake, is_cancelled=lambda: worker.cancelled,
        )  # fmt: skip
        self._server = Server(self.session, told)
        self.wants_turn = self._server.wants_turn
        controller.set_tell(self._tell)
        controller.set_show_pos(self.session.between)

    def serve(self, doors: Sequence[Door]) -> None:
        """Until ``leave``; in the calling thread."""
        self._server.open(doors)
        self._worker.start()
        self._server.serve()

    def leave(self) -> None:
        """Brake, and let ``serve`` come to its end; from any thread."""
        self._worker.cancel()
        self._server.close()

    def close(self) -> None:
        """Wait for standstill, motors off."""
        self._worker.close()

    def _tell(self, message: str) -> None:
        self._told(message)
        self.session.tell(message)

    def _wake(self) -> None:
        if not self._worker.busy:
            self._worker.submit(self.session.turn)

    def _look(self) -> None:
        """At standstill, in the machine's thread."""
        if self.session.has_work:
            self._worker.submit(self.session.turn)
