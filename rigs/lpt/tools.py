"""What scenarios of the guest are made of: ports in children, a look at the lines, modules."""

import os
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

from fraese.errors import PortError
from rigs.lpt.forked import Forked
from rigs.lpt.kernel import kernel
from rigs.lpt.machine import MARK
from tests.rigs.lpt.play import PORTS
from tests.rigs.lpt.remote import RemotePort
from tests.rigs.lpt.steps import MOTORS_OFF

#: What a scenario tells.
Said = dict[str, Any]

BASE: Final = 0x378
#: Marks the end of a scenario; beginnings are numbered from 1.
END_MARK: Final = 0


class Here:
    """Starts Python modules on the guest's own port."""

    def start(self, *arguments: str) -> Forked:
        """A module and the arguments of its ``main``."""
        return Forked(*arguments)


@contextmanager
def remote(kind: str) -> Iterator[RemotePort]:
    """A port in a process of its own."""
    port = RemotePort(Here(), kind)
    try:
        yield port
    finally:
        port.quit()


@contextmanager
def io_port() -> Iterator[int]:
    """The registers behind everybody's back, for looking and marking."""
    fd = os.open("/dev/port", os.O_RDWR)
    try:
        yield fd
    finally:
        os.close(fd)


def mark(number: int) -> None:
    """Leave a mark in the trace, where the kernel allows it."""
    with suppress(OSError), io_port() as fd:
        os.pwrite(fd, bytes((number,)), BASE + MARK)


def pins() -> int:
    """What stands on the data lines."""
    with io_port() as fd:
        return os.pread(fd, 1, BASE)[0]


def refusal(kind: str) -> str:
    """The sentence with which a port does not open; empty if it does."""
    try:
        PORTS[kind]().close()
    except PortError as error:
        return str(error)
    return ""


def insmod(name: str) -> None:
    """Load a module."""
    subprocess.run(["busybox", "insmod", str(kernel().module(name))], check=True)


def rmmod(name: str) -> None:
    """Unload a module."""
    subprocess.run(["busybox", "rmmod", name], check=True)


def wait_for(what: Callable[[], bool]) -> None:
    """Until something can be seen; half a minute at most."""
    end_s = time.monotonic() + 30
    while not what():
        if time.monotonic() > end_s:
            raise TimeoutError("it did not happen in time")
        time.sleep(0.002)


def wait_until_it_moves() -> int:
    """A phase byte on the pins, other than those with which the motors were energised."""
    seen: list[int] = []

    def moves() -> bool:
        value = pins()
        if value not in MOTORS_OFF and value not in seen:
            seen.append(value)
        return len(seen) > 6

    wait_for(moves)
    return seen[-1]
