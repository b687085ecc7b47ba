"""A port on the network at which senders come in.

Rule 1: who is not admitted by his address has to say the token, and has some seconds for it; not
        many are waited for at once. Until then he is told nothing.
"""

import os
import select
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from fraese.errors import PortError
from fraese.phrases import phrase, reason
from fraese.serve.access import MOST_TOKEN, Access
from fraese.serve.connection import Connection

_SAY_IT_WITHIN_S: Final = 10.0
_MOST_ASKED: Final = 8
#: After two silent seconds once a second; three without an answer, and he has gone.
_FEELING: Final = {"TCP_KEEPIDLE": 2, "TCP_KEEPINTVL": 1, "TCP_KEEPCNT": 3}
_NOT_ADMITTED: Final = b"[MSG:This address is not allowed, see serve.allow]\r\n"


@dataclass
class _Guest:
    """Somebody outside, who is asked for the token."""

    socket: socket.socket
    name: str
    until_s: float
    said: bytes = b""


class TcpDoor:
    """One port.

    Args:
        host: address at which it is.
        port: its number; 0: any that is free.
        access: who may come in.
        wants_turn: see ``Connection``.

    Raises:
        PortError: it cannot be had.
    """

    def __init__(
        self, host: str, port: int, access: Access, wants_turn: Callable[[], object]
    ) -> None:
        self._access = access
        self._wants_turn = wants_turn
        self._guests: list[_Guest] = []
        self._sockets: dict[int, socket.socket] = {}
        try:
            family, _, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
            self._listens = socket.create_server(place[:2], family=family, backlog=_MOST_ASKED)
        except OSError as error:
            raise PortError(
                phrase(
                    "{host} port {port} cannot be had: {reason}.",
                    host=host,
                    port=port,
                    reason=reason(error),
                )
            ) from error
        self._listens.setblocking(False)

    @property
    def name(self) -> str:
        """Where a sender finds it."""
        return _name(self._listens.getsockname())

    def fds(self) -> tuple[int, ...]:
        """Who comes, and who is asked."""
        return (self._listens.fileno(), *(guest.socket.fileno() for guest in self._guests))

    def arrived(self) -> Connection | None:
        """Somebody who may come in."""
        for guest in list(self._guests):
            admitted = self._ask(guest)
            if admitted is not None:
                return admitted
        try:
            came, place = self._listens.accept()
        except OSError:
            return None
        came.setblocking(False)
        came.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _feel_for(came)
        if self._access.admits(place[0]):
            return self._inside(came, _name(place))
        if self._access.has_token and len(self._guests) < _MOST_ASKED:
            until_s = time.monotonic() + _SAY_IT_WITHIN_S
            self._guests.append(_Guest(came, _name(place), until_s))
            return None
        with came:
            came.send(_NOT_ADMITTED)
        return None

    def left(self, connection: Connection) -> None:
        """He has gone."""
        connection.close()
        self._sockets.pop(connection.fd).close()

    def close(self) -> None:
        """For good."""
        for each in (self._listens, *(guest.socket for guest in self._guests)):
            each.close()
        for each in self._sockets.values():
            each.close()

    def _inside(self, came: socket.socket, name: str) -> Connection:
        self._sockets[came.fileno()] = came
        return Connection(came.fileno(), name, self._wants_turn)

    def _ask(self, guest: _Guest) -> Connection | None:
        """What he says: the token, and he is in; anything else, and he is out."""
        try:
            # One by one: what follows his first line is not for us.
            while select.select([guest.socket], [], [], 0)[0]:
                byte = os.read(guest.socket.fileno(), 1)
                if byte in (b"", b"\n", b"\r") or len(guest.said) > MOST_TOKEN:
                    return self._judge(guest)
                guest.said += byte
        except OSError:
            guest.until_s = 0.0
        if time.monotonic() > guest.until_s:
            self._guests.remove(guest)
            guest.socket.close()
        return None

    def _judge(self, guest: _Guest) -> Connection | None:
        self._guests.remove(guest)
        if self._access.knows(guest.said):
            return self._inside(guest.socket, guest.name)
        guest.socket.close()
        return None


def _feel_for(there: socket.socket) -> None:
    """A computer that is switched off says nothing: see within seconds that it has gone."""
    there.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _FEELING.items():
        if hasattr(socket, name):
            there.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _name(place: tuple[str, int]) -> str:
    host, port = place[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
