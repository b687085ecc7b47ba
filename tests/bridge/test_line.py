"""The serial port, with a pseudo-terminal in its place: whose it is, and what is said otherwise."""

import errno
import fcntl
import os
import subprocess
import sys
import termios
from array import array
from collections.abc import Iterator
from pathlib import Path

import pytest

from fraese.errors import PortError
from fraese.motor.bridge.line import SerialLine

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a pty takes the port's place")

#: Asks for settings with any rate, which is the last of eleven numbers.
TCGETS2 = 0x802C542A

#: Opens a port as a program does that has never heard of locks; root would be let in.
STRANGER = """
import os, sys
if os.getuid() == 0:
    os.setgid(65534)
    os.setuid(65534)
try:
    os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
except OSError as error:
    sys.exit(error.errno)
"""


@pytest.fixture
def port() -> Iterator[str]:
    ours, theirs = os.openpty()
    name = os.ttyname(theirs)
    os.chmod(name, 0o666)
    yield name
    os.close(ours)
    os.close(theirs)


def stranger(port: str) -> int:
    """With which error another program is refused; 0: it is not."""
    return subprocess.run([sys.executable, "-c", STRANGER, port], check=False).returncode


def test_nobody_else_gets_the_port_until_it_is_given_back(port: str) -> None:
    assert stranger(port) == 0
    line = SerialLine(port, 250_000)
    assert stranger(port) == errno.EBUSY
    line.close()
    line.close()
    assert stranger(port) == 0


def test_a_second_one_of_us_is_told_so(port: str) -> None:
    line = SerialLine(port, 250_000)
    with pytest.raises(PortError, match=f"^{port} is in use by another program: close that one"):
        SerialLine(port, 250_000)
    line.close()
    SerialLine(port, 250_000).close()


@pytest.mark.parametrize("baud", [115_200, 250_000])
def test_a_port_that_is_closed_does_not_hang_up(port: str, baud: int) -> None:
    """With DTR an Arduino would be reset, and forget what it knows."""
    fd = os.open(port, os.O_RDWR | os.O_NOCTTY)
    settings = termios.tcgetattr(fd)
    termios.tcsetattr(
        fd, termios.TCSANOW, [*settings[:2], settings[2] | termios.HUPCL, *settings[3:]]
    )
    SerialLine(port, baud).close()
    assert not termios.tcgetattr(fd)[2] & termios.HUPCL
    numbers = array("I", bytes(64))
    fcntl.ioctl(fd, TCGETS2, numbers)
    assert numbers[10] == baud
    os.close(fd)


def test_a_port_that_is_gone_can_be_closed() -> None:
    ours, theirs = os.openpty()
    line = SerialLine(os.ttyname(theirs), 250_000)
    os.close(ours)
    os.close(theirs)
    with pytest.raises(PortError, match=r"is gone( \(.*\))?: is the plug still in\?"):
        line.read(0.01)
    line.close()


def test_a_file_that_is_no_serial_port_is_said(tmp_path: Path) -> None:
    path = tmp_path / "notes"
    path.touch()
    with pytest.raises(PortError, match=f"^{path} is no serial port: correct port.device"):
        SerialLine(str(path), 250_000)
