"""What can be known about a parallel port without claiming it.

    /dev/parport0 --number--> /proc/sys/dev/parport/parport0/   base address, who is registered
    /proc/modules                                               lp, ppdev, parport_pc
    /sys/kernel/security/lockdown                               none [integrity] confidentiality

Rule 1: nothing here opens a port or changes anything.
Rule 2: what cannot be found out is None or empty, never an error: on another system there is
        simply less to say.
Rule 3: ``root`` is where the file system begins; tests bring their own.
"""

import os
import re
import stat
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fraese.errors import PortError
from fraese.motor.pins import CONTROL_PINS, DATA_PINS, STATUS_PINS, levels
from fraese.motor.seams import Port
from fraese.phrases import phrase

_ROOT: Final = Path("/")

#: Kernel modules that matter, and what for.
MODULES: Final = {
    "parport_pc": phrase("drives the port"),
    "ppdev": phrase("hands it to programs"),
    "lp": phrase("takes it for a printer"),
}


@dataclass(frozen=True, slots=True)
class DeviceFacts:
    """A device file.

    Attributes:
        path: as configured.
        present: there is such a file.
        is_device: it is a character device.
        allowed: this user may read and write it, as far as its mode says.
        mode: as ``ls -l`` prints it; empty if there is none.
        owner: name, or number where it has none.
        group: the same.
    """

    path: str
    present: bool
    is_device: bool = False
    allowed: bool = False
    mode: str = ""
    owner: str = ""
    group: str = ""


@dataclass(frozen=True, slots=True)
class StatusLines:
    """The five inputs.

    Attributes:
        register: the byte as it reads.
        pins: DB25 pin, and whether it is high; from the lowest pin on.
    """

    register: int
    pins: tuple[tuple[int, bool], ...]


@dataclass(frozen=True, slots=True)
class PortFacts:
    """Everything about one port.

    Attributes:
        device: the ppdev device file.
        ioport: ``/dev/port``.
        base: first I/O address that the kernel knows for the device, or None.
        modules: those of ``MODULES`` that are loaded.
        registered: drivers that have the port now ("lp", "ppdev0"), if this can be seen.
        openers: processes that hold the device open ("python3, pid 123"), if this can be seen.
        lockdown: "none", "integrity", "confidentiality"; empty if this cannot be seen.
    """

    device: DeviceFacts
    ioport: DeviceFacts
    base: int | None
    modules: tuple[str, ...]
    registered: tuple[str, ...]
    openers: tuple[str, ...]
    lockdown: str

    @property
    def lp_holds_it(self) -> bool:
        """The printer driver has the port."""
        return "lp" in self.registered

    @property
    def is_locked_down(self) -> bool:
        """The kernel refuses direct access to I/O ports."""
        return self.lockdown not in ("", "none")


def describe(device: str = "/dev/parport0", root: Path = _ROOT) -> PortFacts:
    """Look a port over from outside.

    Args:
        device: its ppdev device file.
        root: where the file system begins.
    """
    return PortFacts(
        device=device_facts(device, root),
        ioport=device_facts("/dev/port", root),
        base=base_address(device, root),
        modules=tuple(name for name in MODULES if name in loaded_modules(root)),
        registered=registered(device, root),
        openers=openers(device, root),
        lockdown=lockdown(root),
    )


def status_lines(port: Port) -> StatusLines:
    """The inputs of an open port.

    Raises:
        PortError: if it cannot be read.
    """
    return lines_of(port.read_status())


def lines_of(register: int) -> StatusLines:
    """The inputs as the status register reads them."""
    return StatusLines(register, tuple(levels(register, STATUS_PINS).items()))


def output_pins(data: int, control: int) -> tuple[tuple[int, bool], ...]:
    """What stands on the outputs: DB25 pin, and whether it is high; from the lowest pin on.

    Args:
        data: data register, as it was written last.
        control: control register, likewise.
    """
    return tuple(sorted({**levels(data, DATA_PINS), **levels(control, CONTROL_PINS)}.items()))


def device_facts(path: str, root: Path = _ROOT) -> DeviceFacts:
    """A device file: is it there, and who may use it."""
    place = _under(root, path)
    try:
        found = place.stat()
    except OSError:
        return DeviceFacts(path, present=False)
    return DeviceFacts(
        path,
        present=True,
        is_device=stat.S_ISCHR(found.st_mode),
        allowed=os.access(place, os.R_OK | os.W_OK),
        mode=stat.filemode(found.st_mode),
        owner=_named(place.owner, found.st_uid),
        group=_named(place.group, found.st_gid),
    )


def loaded_modules(root: Path = _ROOT) -> frozenset[str]:
    """Names of the kernel's loaded modules; what is built in is not among them."""
    lines = _text(root / "proc/modules").splitlines()
    return frozenset(line.split()[0] for line in lines if line.strip())


def registered(device: str, root: Path = _ROOT) -> tuple[str, ...]:
    """Drivers that are registered with the port: "lp", "ppdev0"."""
    folder = _parport(device, root)
    if folder is None:
        return ()
    return tuple(sorted(entry.name for entry in _entries(folder / "devices") if entry.is_dir()))


def base_address(device: str, root: Path = _ROOT) -> int | None:
    """First I/O address of the port behind a ppdev device."""
    folder = _parport(device, root)
    words = _text(folder / "base-addr").split() if folder is not None else []
    return int(words[0]) if words and words[0].isdecimal() else None


def openers(device: str, root: Path = _ROOT) -> tuple[str, ...]:
    """Other processes that have a device open, as far as this user may see it."""
    target = os.path.realpath(_under(root, device))
    found = []
    for process in _entries(root / "proc"):
        if not process.name.isdecimal() or int(process.name) == os.getpid():
            continue
        if any(_link(descriptor) == target for descriptor in _entries(process / "fd")):
            name = _text(process / "comm").strip() or "a process"
            found.append(f"{name}, pid {process.name}")
    return tuple(found)


def lockdown(root: Path = _ROOT) -> str:
    """What the kernel is locked down to; secure boot usually means "integrity"."""
    chosen = re.search(r"\[(\w+)\]", _text(root / "sys/kernel/security/lockdown"))
    return chosen[1] if chosen else ""


def wrapped(error: OSError, sentences: Mapping[int, str], otherwise: str) -> PortError:
    """The sentence for a foreign error; where there is none, what the system says about it.

    Args:
        error: as it was caught.
        sentences: by errno.
        otherwise: beginning of the sentence for any other.
    """
    known = sentences.get(error.errno or 0)
    return PortError(known or f"{otherwise}: {os.strerror(error.errno or 0)}.")


# --- what may fail, and then says nothing --------------------------------------------------------


def _under(root: Path, path: str) -> Path:
    return root / path.lstrip("/")


def _parport(device: str, root: Path) -> Path | None:
    """The kernel's folder about the port of that number; the device may be a link to it."""
    number = re.search(r"(\d+)$", os.path.realpath(_under(root, device)))
    return root / f"proc/sys/dev/parport/parport{number[1]}" if number else None


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8", "replace")
    except OSError:
        return ""


def _entries(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError:
        return []


def _link(path: Path) -> str:
    try:
        return str(path.readlink())
    except OSError:
        return ""


def _named(look_up: Callable[[], str], number: int) -> str:
    try:
        return look_up()
    except (KeyError, NotImplementedError, OSError):
        return str(number)
