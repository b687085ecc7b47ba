"""A serial line that ends in this program: a pseudo-terminal, and a link with a name that stays.

Rule 1: somebody is there as long as he has it open. Who opens it next finds it as it was in the
        beginning: raw, and with nothing left to read.
Rule 2: only a link is replaced by a link, and only the own one is taken away.
"""

import os
import select
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from fraese.errors import ConfigError, PortError
from fraese.phrases import phrase, reason
from fraese.serve.connection import Connection


class PtyDoor:
    """One pseudo-terminal.

    Args:
        link: path of a link to it; None: none is made.
        wants_turn: see ``Connection``.

    Raises:
        PortError: there are no pseudo-terminals here.
        ConfigError: the link cannot be made.
    """

    def __init__(self, link: Path | None, wants_turn: Callable[[], object]) -> None:
        try:
            self._master, slave = os.openpty()
        except (OSError, AttributeError) as error:
            raise PortError(
                phrase("There is no pseudo-terminal to be had: {error}.", error=error)
            ) from error
        self.path = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self._master, False)
        self._link = link
        self._wants_turn = wants_turn
        self._connection: Connection | None = None
        self._calm()
        if link is not None:
            self._make_link(link)

    @property
    def name(self) -> str:
        """Where a sender finds it."""
        return self.path if self._link is None else str(self._link)

    def arrived(self) -> Connection | None:
        """Somebody who has opened it since the last look; None: nobody."""
        if self._connection is not None or not self._is_open():
            return None
        self._connection = Connection(self._master, self.name, self._wants_turn)
        return self._connection

    def left(self, connection: Connection) -> None:
        """He has closed it."""
        connection.close()
        self._connection = None
        self._calm()

    def fds(self) -> tuple[int, ...]:
        """What is to be watched for who arrives: nothing, it has to be looked at."""
        return ()

    def close(self) -> None:
        """Hang up, and take the link away."""
        if self._link is not None:
            with suppress(OSError):
                if os.readlink(self._link) == self.path:
                    self._link.unlink()
        with suppress(OSError):
            os.close(self._master)

    def _is_open(self) -> bool:
        poll = select.poll()
        poll.register(self._master, select.POLLIN)
        return not any(events & select.POLLHUP for _, events in poll.poll(0))

    def _calm(self) -> None:
        """No echo, no lines, nothing of what was told to who was there before."""
        import termios
        import tty

        slave = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        try:
            tty.setraw(slave)
            termios.tcflush(slave, termios.TCIFLUSH)
        finally:
            os.close(slave)

    def _make_link(self, link: Path) -> None:
        beside = link.with_name(f".{link.name}.{os.getpid()}")
        try:
            with suppress(FileNotFoundError):
                if not stat.S_ISLNK(os.lstat(link).st_mode):
                    os.close(self._master)
                    raise ConfigError(
                        phrase("{path}: is there already, and no link; name another.", path=link)
                    )
            os.symlink(self.path, beside)
            os.replace(beside, link)
        except OSError as error:
            os.close(self._master)
            raise ConfigError(
                phrase("{path}: cannot be made: {reason}.", path=link, reason=reason(error))
            ) from error
