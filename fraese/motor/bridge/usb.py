"""What can be known about the bridge's serial port without opening it.

    /dev/ttyUSB0 --name--> /sys/class/tty/ttyUSB0/device --> .. --> the folder with idVendor
                                    latency_timer                   power/control

Rule 1: what cannot be found out is None, never an error: on another system there is less to say.
Rule 2: ``root`` is where the file system begins; tests bring their own.
"""

from dataclasses import dataclass
from pathlib import Path

from fraese.motor.ports.facts import DeviceFacts, device_facts


@dataclass(frozen=True, slots=True)
class SerialFacts:
    """A serial port from outside.

    Attributes:
        device: its device file.
        latency_file: where its USB chip's latency timer is set; None: it has none (only FTDI's).
        latency_ms: so long the chip collects bytes before it passes them on.
        power_file: where it is set whether USB may put the board to sleep; None: it is not on USB.
        may_sleep: it may.
    """

    device: DeviceFacts
    latency_file: Path | None = None
    latency_ms: int | None = None
    power_file: Path | None = None
    may_sleep: bool = False


def serial_facts(device: str, root: Path = Path("/")) -> SerialFacts:
    """Look a serial port over from outside; the device may be a link to it."""
    name = (root / device.lstrip("/")).resolve().name
    place = root / "sys/class/tty" / name / "device"
    latency, power = place / "latency_timer", _power_of(place)
    timer, control = _text(latency), _text(power) if power else ""
    return SerialFacts(
        device=device_facts(device, root),
        latency_file=latency if timer.isdecimal() else None,
        latency_ms=int(timer) if timer.isdecimal() else None,
        power_file=power if control else None,
        may_sleep=control == "auto",
    )


def _power_of(place: Path) -> Path | None:
    """The setting of the USB device that an interface belongs to."""
    if not place.exists():
        return None
    for folder in place.resolve().parents:
        if (folder / "idVendor").exists():
            return folder / "power/control"
    return None


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8", "replace").strip()
    except OSError:
        return ""
