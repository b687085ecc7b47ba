"""A parallel port through the kernel's ppdev driver: /dev/parport0.

    open --> PPEXCL --> PPCLAIM --> PPWDATA, PPFCONTROL, PPRSTATUS ... --> PPRELEASE --> close
                        (writes control twice)                    (neither writes anything)

Rule 1: exclusive, then claim. Without PPEXCL a second program could take the port in the middle of
        a move, for seconds; with it that program is refused at once.
Rule 2: control is changed by frob (mask and value) and only its low four bits: bit 4 is the
        kernel's interrupt bit, bit 5 turns the data lines round.
Rule 3: giving the port back changes no pin. Motors are switched off before, by whoever drives them.
Rule 4: an access costs little more than the system call. Its argument lies ready in a table of
        bytearrays: ``ioctl`` takes ``bytes`` four times slower.
"""

import errno
import os
from typing import Final

from fraese.errors import PortError
from fraese.motor.ports import facts
from fraese.motor.ports.held import HeldFile
from fraese.phrases import phrase

try:
    from fcntl import ioctl
except ImportError:  # not a Unix: the package imports, the port does not open
    ioctl = None  # type: ignore[assignment]

# linux/ppdev.h, _IO(0x70, ...) as on x86 and ARM.
_PPCLAIM: Final = 0x708B
_PPRELEASE: Final = 0x708C
_PPEXCL: Final = 0x708F
_PPRSTATUS: Final = 0x80017081
_PPWDATA: Final = 0x40017086
_PPFCONTROL: Final = 0x4002708E

_CONTROL_MASK: Final = 0x0F
_DATA_ARGUMENTS: Final = tuple(bytearray((value,)) for value in range(256))
_CONTROL_ARGUMENTS: Final = tuple(bytearray((_CONTROL_MASK, value)) for value in range(16))


class PpdevPort(HeldFile):
    """A Port on a ppdev device, claimed alone.

    Args:
        device: the device file.

    Raises:
        PortError: if it is not there, not allowed, or somebody else's.
    """

    def __init__(self, device: str = "/dev/parport0") -> None:
        super().__init__(device, _open(device))
        self._status = bytearray(1)
        try:
            _claim(self._fd, device)
        except PortError:
            os.close(self._fd)
            raise

    def write_data(self, value: int) -> None:
        """Put a byte on DB25 pins 2 to 9.

        Raises:
            PortError: if the port went away.
        """
        try:
            ioctl(self._fd, _PPWDATA, _DATA_ARGUMENTS[value])
        except OSError as error:
            raise self._gone(error) from error

    def write_control(self, value: int) -> None:
        """Set the low four bits of the control register; the others stay the kernel's.

        Raises:
            PortError: if the port went away.
        """
        try:
            ioctl(self._fd, _PPFCONTROL, _CONTROL_ARGUMENTS[value])
        except OSError as error:
            raise self._gone(error) from error

    def read_status(self) -> int:
        """The status register as it reads.

        Raises:
            PortError: if the port went away.
        """
        status = self._status
        try:
            ioctl(self._fd, _PPRSTATUS, status)
        except OSError as error:
            raise self._gone(error) from error
        return status[0]

    def _give_back(self, fd: int) -> None:
        ioctl(fd, _PPRELEASE)


def _open(device: str) -> int:
    if ioctl is None:
        raise PortError(phrase("{device} needs Linux; use the simulation here.", device=device))
    try:
        return os.open(device, os.O_RDWR | os.O_CLOEXEC)
    except OSError as error:
        raise facts.wrapped(
            error, _open_sentences(device), phrase("{device} cannot be opened", device=device)
        ) from error


def _open_sentences(device: str) -> dict[int, str]:
    found = facts.device_facts(device)
    missing = phrase(
        "{device} does not exist: is there a parallel port? Load its drivers with sudo"
        " modprobe -a parport_pc ppdev.",
        device=device,
    )
    forbidden = phrase("{device} may not be used by this user: ", device=device) + (
        phrase(
            "join its group with sudo usermod -aG {group} $USER and log in again.",
            group=found.group,
        )
        if _group_helps(found)
        else phrase(
            'write SUBSYSTEM=="ppdev", GROUP="lp", MODE="0660" into'
            " /etc/udev/rules.d/60-parport.rules, load ppdev anew, join group lp, log in"
            " again."
        )
    )
    return {
        errno.ENOENT: missing,
        errno.ENXIO: missing,
        errno.ENODEV: missing,
        errno.EACCES: forbidden,
        errno.EPERM: forbidden,
        errno.EBUSY: phrase(
            "{device} is in use by another program: close that one first.", device=device
        ),
    }


def _group_helps(found: facts.DeviceFacts) -> bool:
    """Members of the file's group may use it, and it is not root's own group."""
    return found.mode[4:6] == "rw" and found.group != "root"


def _claim(fd: int, device: str) -> None:
    """Alone or not at all.

    The kernel notices another owner at the claim; older ones are said to notice at PPEXCL.
    """
    try:
        ioctl(fd, _PPEXCL)
        ioctl(fd, _PPCLAIM)
    except OSError as error:
        raise facts.wrapped(
            error, _claim_sentences(device), phrase("{device} cannot be claimed", device=device)
        ) from error


def _claim_sentences(device: str) -> dict[int, str]:
    taken = _taken(device)
    return {
        errno.ENXIO: taken,
        errno.EBUSY: taken,
        errno.EAGAIN: taken,
        errno.ENOTTY: phrase(
            "{device} is not a ppdev device; the first port is /dev/parport0.", device=device
        ),
        errno.EINVAL: phrase(
            "{device} is not a ppdev device; the first port is /dev/parport0.", device=device
        ),
    }


def _taken(device: str) -> str:
    """Who has the port, as far as can be seen."""
    known = facts.registered(device)
    if "lp" in known or (not known and "lp" in facts.loaded_modules()):
        return phrase(
            "{device} is held by the printer driver lp: unload it with sudo rmmod lp.",
            device=device,
        )
    others = "; ".join(facts.openers(device))
    return phrase(
        "{device} is held by another program{what}: close that one first; if it is the"
        " printer driver, unload it with sudo rmmod lp.",
        device=device,
        what=f" ({others})" if others else "",
    )
