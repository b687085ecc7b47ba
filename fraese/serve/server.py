"""Who is at the doors, and one of them at the machine: the thread that reads and writes lines.

Rule 1: one sender at a time has the machine. Another one is told so, and what he says is dropped.
Rule 2: nothing here waits for the machine.
"""

import select
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Final, Protocol

from fraese.comefirst import come_first_when_woken
from fraese.phrases import phrase
from fraese.serve.connection import Connection
from fraese.serve.session import Session

_LOOK_EVERY_MS: Final = 50
_TAKEN: Final = "[MSG:Another sender is connected]\r\n"


class Door(Protocol):
    """Where senders come in."""

    @property
    def name(self) -> str:
        """Where they find it."""

    def fds(self) -> tuple[int, ...]:
        """Descriptors that say that somebody is there."""

    def arrived(self) -> Connection | None:
        """Somebody who may come in."""

    def left(self, connection: Connection) -> None:
        """He has gone, or is shown out."""

    def close(self) -> None:
        """For good."""


class Server:
    """Doors, and the session behind them.

    Args:
        session: of the machine.
        told: told who comes and goes, a sentence; in the thread that serves.
    """

    def __init__(self, session: Session, told: Callable[[str], object]) -> None:
        self._session = session
        self._told = told
        self._doors: Sequence[Door] = ()
        self._inside: tuple[Door, Connection] | None = None
        # Who came while somebody was inside: what he says is dropped.
        self._outside: dict[int, tuple[Door, Connection]] = {}
        self._wakes, self._woken = socket.socketpair()
        self._wakes.setblocking(False)
        self._woken.setblocking(False)
        self._ends = False

    def open(self, doors: Sequence[Door]) -> None:
        """These are the doors; before ``serve``."""
        self._doors = doors

    def wants_turn(self) -> None:
        """Something is to be written; from any thread."""
        with suppress(OSError):
            self._wakes.send(b"!")

    def serve(self) -> None:
        """Until ``close`` is called."""
        come_first_when_woken()
        try:
            while not self._ends:
                self._round()
        finally:
            if self._inside is not None:
                self._show_out(*self._inside)
            for door in self._doors:
                door.close()
            for end in (self._wakes, self._woken):
                end.close()

    def close(self) -> None:
        """Let ``serve`` come to its end; from any thread."""
        self._ends = True
        self.wants_turn()

    def _round(self) -> None:
        poll = select.poll()
        poll.register(self._woken, select.POLLIN)
        for door in self._doors:
            for fd in door.fds():
                poll.register(fd, select.POLLIN)
        if self._inside is not None:
            connection = self._inside[1]
            reads = 0 if self._session.is_full else select.POLLIN
            poll.register(connection.fd, reads | (select.POLLOUT if connection.is_waiting else 0))
        for fd in self._outside:
            poll.register(fd, select.POLLIN)
        ready = dict(poll.poll(_LOOK_EVERY_MS))
        if ready.pop(self._woken.fileno(), 0):
            with suppress(OSError):
                self._woken.recv(4096)
        if self._inside is not None and self._inside[1].fd in ready:
            self._hear(*self._inside, ready[self._inside[1].fd])
        for fd in [fd for fd in self._outside if fd in ready]:
            self._drop(*self._outside[fd])
        for door in self._doors:
            if (arrived := door.arrived()) is not None:
                self._let_in(door, arrived)

    def _hear(self, door: Door, connection: Connection, events: int) -> None:
        if events & select.POLLOUT:
            connection.flush()
        if events & ~select.POLLOUT:
            data = connection.read()
            if data is None:
                self._show_out(door, connection)
            elif data:
                self._session.feed(data)

    def _let_in(self, door: Door, connection: Connection) -> None:
        if self._inside is not None:
            connection.put(_TAKEN)
            self._outside[connection.fd] = (door, connection)
            return
        self._inside = (door, connection)
        self._told(phrase("A sender is connected: {name}.", name=connection.name))
        self._session.connected(connection.name, connection.put)

    def _show_out(self, door: Door, connection: Connection) -> None:
        self._inside = None
        self._session.lost()
        door.left(connection)
        self._told(phrase("The sender has gone: {name}.", name=connection.name))

    def _drop(self, door: Door, connection: Connection) -> None:
        if connection.read() is None:
            del self._outside[connection.fd]
            door.left(connection)
