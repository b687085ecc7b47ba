"""The serial port: bytes in and out, and one sentence for whatever goes wrong with it.

Rule 1: a write is whole and may come from any thread: a brake need not wait for whoever reads.
Rule 2: a port is ours alone. Programs that ask (flock) are told by pyserial; all others but root's
        are refused by the kernel (TIOCEXCL), until the port is given back.
Rule 3: a port that is closed does not hang up: on an Arduino that line (DTR) is the reset, and a
        device that lived on through the end of its program is to be asked what it knows.
Rule 4: a board that looks like an Arduino is known by the maker of its USB chip; nothing is opened
        to find out, since opening resets it.
"""

import errno
import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Final, NamedTuple, Protocol

import serial
from serial.tools import list_ports

from fraese import alarms
from fraese.errors import PortError
from fraese.phrases import phrase

#: Longest wait within pyserial; what is waited for longer is waited for in such slices.
_SLICE_S: Final = 0.005
_WRITE_TIMEOUT_S: Final = 1.0

#: USB vendors of such boards and of the serial chips on their copies.
MAKERS: Final = {
    0x2341: "Arduino",
    0x2A03: "Arduino",
    0x1A86: "CH340",
    0x0403: "FTDI",
    0x10C4: "CP210x",
    0x067B: "PL2303",
    0x1B4F: "SparkFun",
    0x239A: "Adafruit",
}


class Line(Protocol):
    """Bytes there and back.

    Raises:
        PortError: from every method but ``close``, when the line is gone.
    """

    def read(self, timeout_s: float) -> bytes:
        """What has come; waits so long for the first byte of it, at most."""

    def write(self, data: bytes) -> None:
        """Send all of it. From any thread."""

    def set_baud(self, baud: int) -> None:
        """Speak at another rate."""

    def close(self) -> None:
        """Let go. Safe to call twice."""


OpenLine = Callable[[], Line]


class SerialLine:
    """A Line on a serial port.

    Args:
        device: name of the port.
        baud: rate.

    Raises:
        PortError: if it is not there, not allowed, or somebody else's.
    """

    def __init__(self, device: str, baud: int) -> None:
        self._device = device
        self._lock = threading.Lock()
        try:
            self._port = serial.Serial(
                device,
                baud,
                timeout=_SLICE_S,
                write_timeout=_WRITE_TIMEOUT_S,
                exclusive=True,
            )
            _keep_others_out(self._port, True)
            _hold_up_when_closed(self._port)
        except (OSError, ValueError) as error:
            raise PortError(_refusal(device, baud, error)) from error

    def read(self, timeout_s: float) -> bytes:
        """What has come; waits so long for the first byte of it, at most.

        Raises:
            PortError: if the port is gone.
        """
        until_s = time.monotonic() + timeout_s
        try:
            while True:
                data: bytes = self._port.read(max(1, self._port.in_waiting))
                if data or time.monotonic() >= until_s:
                    return data
        except (OSError, TypeError) as error:
            raise self._gone(error) from error

    def write(self, data: bytes) -> None:
        """Send all of it. From any thread.

        Raises:
            PortError: if the port is gone.
        """
        try:
            with self._lock:
                self._port.write(data)
        except (OSError, TypeError) as error:
            raise self._gone(error) from error

    def set_baud(self, baud: int) -> None:
        """Speak at another rate.

        Raises:
            PortError: if the port is gone, or cannot.
        """
        try:
            self._port.baudrate = baud
        except (OSError, ValueError) as error:
            raise self._gone(error) from error

    def close(self) -> None:
        """Let go. Safe to call twice."""
        # Where somebody else has it open already, the kernel would go on refusing all others.
        with suppress(OSError, TypeError):
            _keep_others_out(self._port, False)
        with suppress(OSError, TypeError):
            self._port.close()

    def _gone(self, error: Exception) -> PortError:
        if not self._port.is_open:
            return PortError(
                phrase("{device} is used after it was given back.", device=self._device)
            )
        number = getattr(error, "errno", None)
        # Without a number it is pyserial's guess, in words that help nobody.
        why = f" ({os.strerror(number)})" if number else ""
        return PortError(
            phrase("{device} is gone{why}: is the plug still in?", device=self._device, why=why),
            alarms.BRIDGE_LOST,
        )


def _keep_others_out(port: serial.Serial, wanted: bool) -> None:
    """Whether the kernel refuses the port to whoever opens it next; Windows does so anyway."""
    if sys.platform == "win32" or not port.is_open:
        return
    import fcntl
    import termios

    fcntl.ioctl(port.fileno(), termios.TIOCEXCL if wanted else termios.TIOCNXCL)


def _hold_up_when_closed(port: serial.Serial) -> None:
    """See rule 3; it holds for whoever opens the port next, until the plug is pulled."""
    if sys.platform == "win32":
        return
    import termios

    settings = termios.tcgetattr(port.fileno())
    settings[2] &= ~termios.HUPCL
    # Here a rate is one of a list; the true one is set again by the library.
    settings[4] = settings[5] = termios.B38400
    termios.tcsetattr(port.fileno(), termios.TCSANOW, settings)
    port.baudrate = port.baudrate


class SerialPort(NamedTuple):
    """A serial port of this computer.

    Attributes:
        device: its name.
        description: what it says of itself.
        vid, pid: numbers of its USB chip; None: it has none.
        maker: of a board or chip that may carry the bridge; empty: none that is known.
    """

    device: str
    description: str
    vid: int | None
    pid: int | None
    maker: str


def serial_ports() -> list[SerialPort]:
    """All of them; those that look like an Arduino first."""
    found = [
        SerialPort(
            port.device, port.description or "", port.vid, port.pid, MAKERS.get(port.vid, "")
        )
        for port in list_ports.comports()
    ]
    return sorted(found, key=lambda port: (not port.maker, port.device))


def chosen_port(name: str) -> str:
    """The port of that name; of none, the one that can be meant.

    Raises:
        PortError: if there is none, or several.
    """
    return name or only_candidate(serial_ports())


def only_candidate(ports: list[SerialPort]) -> str:
    """The one port that can be meant.

    Raises:
        PortError: if there is none, or several.
    """
    likely = [port.device for port in ports if port.maker]
    if len(likely) == 1:
        return likely[0]
    if not likely:
        raise PortError(
            phrase(
                "No board is plugged in that looks like an Arduino: plug it in, or name its"
                " port in port.device (see fraese ports)."
            ),
            alarms.BRIDGE_MISSING,
        )
    raise PortError(
        phrase(
            "Several boards are plugged in ({likely}): name the one that is meant in port.device.",
            likely=", ".join(likely),
        ),
        alarms.BRIDGE_MISSING,
    )


def _refusal(device: str, baud: int, error: Exception) -> str:
    number = getattr(error, "errno", None)
    if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV):
        return phrase(
            "{device} does not exist: plug the board in, or correct port.device.", device=device
        )
    if number in (errno.EACCES, errno.EPERM):
        return phrase(
            "{device} may not be used by this user: join its group with sudo usermod -aG"
            " dialout $USER and log in again.",
            device=device,
        )
    if number in (errno.EBUSY, errno.EAGAIN):
        return phrase("{device} is in use by another program: close that one first.", device=device)
    if isinstance(error, ValueError):
        return phrase(
            "{device} cannot be opened at {baud} baud: correct port.baud.", device=device, baud=baud
        )
    # pyserial gives no number when the file has no line to be set up.
    if number is None and "configure" in str(error):
        return phrase(
            "{device} is no serial port: correct port.device (see fraese ports).", device=device
        )
    return phrase("{device} cannot be opened: {reason}.", device=device, reason=_reason(error))


def _reason(error: Exception) -> str:
    """What the system said, without the words that pyserial puts round it."""
    number = getattr(error, "errno", None)
    return os.strerror(number) if number else str(error).rstrip(".")
