"""Senders at a machine that the app has: they come in, and the app shows them."""

import threading
import time

from fraese.cli.serving import doors_of
from fraese.config.serving import ServeConfig
from fraese.control.controller import Controller
from fraese.phrases import joined, phrase
from fraese.serve.access import Access
from fraese.serve.server import Door, Server
from fraese.serve.session import Session
from fraese.serve.store import Store
from fraese.serve.system import Write
from fraese.ui.machinelink import MachineLink


class AppSenders:
    """A session and a server beside the app; as ``ui.senders.Senders``.

    Args:
        controller: of the machine.
        store: what is kept for senders.
        write: changes the configuration.
        how: how they come in.
        access: who may.

    Raises:
        PortError: a door cannot be had.
        ConfigError: the link cannot be made.
    """

    def __init__(
        self,
        controller: Controller,
        store: Store,
        write: Write,
        how: ServeConfig,
        access: Access,
    ) -> None:
        self._link: MachineLink | None = None
        self._session = Session(
            controller, store, write, time.monotonic,
            wake=self._wake, is_cancelled=self._was_stopped,
        )  # fmt: skip
        self._server = Server(self._session, self._say)
        self._doors: list[Door] = doors_of(how, access, self._server.wants_turn)
        self._server.open(self._doors)
        self._thread = threading.Thread(target=self._server.serve, name="senders", daemon=True)
        controller.set_tell(self._session.tell)

    @property
    def sentence(self) -> str:
        """Where they find the machine."""
        names = joined(phrase(" and "), [door.name for door in self._doors])
        return phrase("Senders find the machine at {names}.", names=names)

    def go_by(self, link: MachineLink) -> None:
        """This is the app's way to the machine; before ``start``."""
        self._link = link
        link.let_in(self)

    def _was_stopped(self) -> bool:
        return self._link is not None and self._link.was_stopped

    def _say(self, sentence: str) -> None:
        if self._link is not None:
            self._link.note(sentence)

    def start(self) -> None:
        """Let them in."""
        self._thread.start()

    def close(self) -> None:
        """Show out who is there."""
        self._server.close()
        if self._thread.is_alive():
            self._thread.join(timeout=2)
        elif self._thread.ident is None:
            # It never began.
            doors, self._doors = self._doors, []
            for door in doors:
                door.close()

    def look(self) -> None:
        """See to what one wants; at standstill, in the machine's thread."""
        if self._link is not None and self._session.has_work:
            self._link.order(self._session.turn)

    def between(self) -> None:
        """The same between two rounds of a job."""
        self._session.between()

    def take(self, *, out: bool) -> None:
        """Take over, or give the machine back."""
        self._session.take(out=out)

    def _wake(self) -> None:
        if self._link is not None and not self._link.busy:
            self._link.order(self._session.turn)
