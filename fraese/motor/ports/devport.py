"""A parallel port by its I/O addresses, through /dev/port: for where there is no ppdev.

    base + 0  data        base + 1  status        base + 2  control

Rule 1: nobody hands the port out here: two programs of this kind exclude each other by a lock on
        the three bytes, but ppdev, lp and others do not see it.
Rule 2: bits 4 to 7 of control (interrupt, direction, and what a chip may keep there) are read once
        and written back as they were.
Rule 3: one byte a write. A longer one would go to the registers one after the other.
Rule 4: giving the port back changes no pin. Motors are switched off before, by whoever drives them.
"""

import errno
import os
from typing import Final

from fraese.errors import PortError
from fraese.motor.ports import facts
from fraese.motor.ports.held import HeldFile
from fraese.motor.seams import CONTROL, STATUS
from fraese.phrases import phrase, reason

try:
    from fcntl import LOCK_EX, LOCK_NB, lockf
except ImportError:  # not a Unix: the package imports, the port does not open
    lockf = None  # type: ignore[assignment]

_DEVICE: Final = "/dev/port"
_REGISTERS: Final = 3
_KEPT_CONTROL: Final = 0xF0
#: What reads like this in all three registers is no port: nothing drives the bus.
_NOTHING_THERE: Final = b"\xff\xff\xff"

_BYTES: Final = tuple(bytes((value,)) for value in range(256))


class DevPort(HeldFile):
    """A Port at an I/O address.

    Args:
        base: address of the data register; 0x378 is the first port of most machines.

    Raises:
        PortError: if it is not allowed, locked, or there is no port.
    """

    def __init__(self, base: int = 0x378) -> None:
        self._data = base
        self._status = base + STATUS
        self._control = base + CONTROL
        super().__init__(phrase("The port at {base:#x}", base=base), _open(base))
        try:
            kept = _look(self._fd, base) & _KEPT_CONTROL
        except PortError:
            os.close(self._fd)
            raise
        self._controls = tuple(_BYTES[kept | value] for value in range(16))

    def write_data(self, value: int) -> None:
        """Put a byte on DB25 pins 2 to 9.

        Raises:
            PortError: if the port went away.
        """
        try:
            os.pwrite(self._fd, _BYTES[value], self._data)
        except OSError as error:
            raise self._gone(error) from error

    def write_control(self, value: int) -> None:
        """Set the low four bits of the control register.

        Raises:
            PortError: if the port went away.
        """
        try:
            os.pwrite(self._fd, self._controls[value], self._control)
        except OSError as error:
            raise self._gone(error) from error

    def read_status(self) -> int:
        """The status register as it reads.

        Raises:
            PortError: if the port went away.
        """
        try:
            return os.pread(self._fd, 1, self._status)[0]
        except OSError as error:
            raise self._gone(error) from error


def _open(base: int) -> int:
    if lockf is None:
        raise PortError(phrase("{device} needs Linux; use the simulation here.", device=_DEVICE))
    try:
        fd = os.open(_DEVICE, os.O_RDWR | os.O_CLOEXEC)
    except OSError as error:
        raise facts.wrapped(
            error, _open_sentences(), phrase("{device} cannot be opened", device=_DEVICE)
        ) from error
    try:
        lockf(fd, LOCK_EX | LOCK_NB, _REGISTERS, base)
    except OSError as error:
        os.close(fd)
        raise PortError(
            phrase(
                "The port at {base:#x} is held by another program: close that one first.", base=base
            )
        ) from error
    return fd


def _open_sentences() -> dict[int, str]:
    locked = facts.lockdown()
    root_only = phrase("is for root with the right CAP_SYS_RAWIO only; run as root")
    reasons = {
        "": phrase("needs the right CAP_SYS_RAWIO, and a kernel that is not locked down"),
        "none": root_only,
    }
    refused = phrase(
        "is refused by the kernel's lockdown ({locked}), as with secure boot", locked=locked
    )
    return {
        errno.ENOENT: _better(phrase("is missing in this kernel")),
        errno.EACCES: _better(root_only),
        errno.EPERM: _better(reasons.get(locked, refused)),
    }


def _better(reason: str) -> str:
    return phrase(
        '{device} {reason}: port.kind "ppdev" needs none of this.', device=_DEVICE, reason=reason
    )


def _look(fd: int, base: int) -> int:
    """The control register as found, once it is sure that something is there."""
    try:
        found = b"".join(os.pread(fd, 1, base + register) for register in range(_REGISTERS))
    except OSError as error:
        raise PortError(
            phrase(
                "The port at {base:#x} cannot be read: {reason}.", base=base, reason=reason(error)
            )
        ) from error
    if found == _NOTHING_THERE:
        raise PortError(
            phrase(
                "There is no parallel port at {base:#x}: all three registers read 0xff; see"
                " /proc/ioports, or the BIOS, for its address.",
                base=base,
            )
        )
    return found[CONTROL]
