"""One program drives a machine at a time.

Rule 1: the lock is the system's (flock): it goes with the last process that holds the descriptor,
        however that ends. So a step process that still brakes after its program was killed keeps
        it, and the next program waits for that. A library would hide the descriptor.
Rule 2: the file says who holds it, and stays: whoever removed it would remove another's lock.
"""

import contextlib
import json
import os
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from fraese.errors import BusyError, ConfigError
from fraese.journal.files import create, make_folder, open_plain, read_all, write_all
from fraese.phrases import phrase, reason

try:
    import fcntl
except ImportError:  # pragma: no cover (no Unix)
    fcntl = None  # type: ignore[assignment]

_MOST_BYTES: Final = 4096
_MOST_CHARACTERS: Final = 200
_LOOK_S: Final = 0.02
#: Where processes can be looked at.
_OWN: Final = Path("/proc/self/stat")
_ENDED: Final = (b"Z", b"X")
#: A step process whose program was killed has braked and left within this.
_LEAVES_S: Final = 3.0


@dataclass(frozen=True, slots=True)
class Holder:
    """Who drives a machine.

    Attributes:
        command: as it was typed.
        pid: process number; 0: nobody knows.
        started: when, as the system counts it; tells it from a later process of that number.
    """

    command: str = ""
    pid: int = 0
    started: str = ""

    @property
    def lives(self) -> bool:
        """It has not ended."""
        return self.pid > 0 and _started(self.pid) == self.started != ""

    def in_words(self) -> str:
        """For people; a step process may hold it longer than its program lived."""
        if not self.pid:
            return phrase("another program")
        left = "" if self.lives else phrase("what is left of ")
        return phrase(
            "{left}{command} (process {pid})", left=left, command=self.command, pid=self.pid
        )


class MachineLock:
    """The right to drive one machine.

    Args:
        path: of the lock file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._fd: int | None = None

    @property
    def descriptor(self) -> int | None:
        """For a process that is to hold it too; None: it is not held."""
        return self._fd

    def take(self, command: str, leaves_s: float = _LEAVES_S) -> None:
        """Take it, for this process.

        Args:
            command: as it was typed.
            leaves_s: how long to wait for what a killed program left behind.

        Raises:
            BusyError: if another program has it, with its name.
            ConfigError: if the file cannot be written.
        """
        try:
            self._fd = self._opened()
            self._wait(self._fd, leaves_s)
            me = Holder(command[:_MOST_CHARACTERS], os.getpid(), _started(os.getpid()))
            os.ftruncate(self._fd, 0)
            write_all(self._fd, json.dumps(asdict(me)).encode(), 0)
        except OSError as error:
            self.let_go()
            raise ConfigError(
                phrase(
                    "{path}: the state cannot be written: {reason}.",
                    path=self.path,
                    reason=reason(error),
                )
            ) from error
        except BusyError:
            self.let_go()
            raise

    def _opened(self) -> int:
        make_folder(self.path.parent)
        while True:
            fd = open_plain(self.path, os.O_RDWR)
            if fd is not None:
                return fd
            with contextlib.suppress(FileExistsError):
                return create(self.path)

    def _wait(self, fd: int, leaves_s: float) -> None:
        until_s = time.monotonic() + leaves_s
        while not _locked(fd):
            holder = _holder(fd)
            if holder.lives or time.monotonic() >= until_s:
                raise BusyError(
                    phrase(
                        "The machine is driven by {in_words} already; nothing has moved.",
                        in_words=holder.in_words(),
                    ),
                    command=holder.command,
                    pid=holder.pid,
                )
            time.sleep(_LOOK_S)

    def let_go(self) -> None:
        """Give it back, also for processes that hold it too. Safe to call twice."""
        fd, self._fd = self._fd, None
        if fd is None:
            return
        with contextlib.suppress(OSError):
            os.close(fd)

    def holder(self) -> Holder | None:
        """Who has it now; None: nobody. Writes nothing."""
        with contextlib.suppress(OSError, ConfigError):
            fd = open_plain(self.path, os.O_RDONLY)
            if fd is None:
                return None
            try:
                return None if _locked(fd, shared=True) else _holder(fd)
            finally:
                os.close(fd)
        return None


def _locked(fd: int, *, shared: bool = False) -> bool:
    if fcntl is None:  # pragma: no cover (no Unix)
        return True
    try:
        fcntl.flock(fd, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _holder(fd: int) -> Holder:
    with contextlib.suppress(OSError, ValueError, TypeError):
        holder = Holder(**json.loads(read_all(fd, _MOST_BYTES)))
        if type(holder.pid) is int and isinstance(holder.command, str):
            return holder
    return Holder()


def _started(pid: int) -> str:
    """When a process was started, in the system's ticks; empty: there is none, or it has ended."""
    if not _OWN.exists():
        return "?"
    with contextlib.suppress(OSError, IndexError):
        # Behind the name, which may hold anything, in brackets.
        facts = Path(f"/proc/{pid}/stat").read_bytes().rpartition(b")")[2].split()
        # A dead process has a number until its parent has heard of it.
        return "" if facts[0] in _ENDED else facts[19].decode()
    return ""
