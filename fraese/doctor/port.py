"""Is the configured port there, and ours? One table of checks for each kind.

    kind         looked at from outside                     opened
    simulation   nothing                                    no
    bridge       device file, permission, USB               greeted, told its card, tried
    ppdev        device file, permission, lp                claimed alone
    devport      /dev/port, permission, lockdown, ppdev     locked

Rule 1: the port is opened once, before the checks (``opening.py``). A check only judges.
Rule 2: a refusal is told in the port's own sentence; it says what would help.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from fraese.doctor.bridge import BRIDGE_CHECKS
from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.motor.pins import STATUS_PINS
from fraese.motor.ports.facts import DeviceFacts

_MODPROBE: Final = "Load the drivers with sudo modprobe -a parport_pc ppdev."
_UDEV: Final = (
    'Write SUBSYSTEM=="ppdev", GROUP="lp", MODE="0660" into /etc/udev/rules.d/60-parport.rules,'
    " load ppdev anew, join group lp and log in again."
)


def _simulated(_: Patient) -> Finding:
    return Finding(
        "port",
        State.OK,
        "The simulated mill: it needs no port, and nothing of what follows; its time is its own."
        " What follows holds for this computer with a parallel port.",
    )


def _microcontroller(_: Patient) -> Finding:
    return Finding(
        "bridge",
        State.OK,
        "The microcontroller times the steps by itself: but for suspend, what follows holds for"
        " this computer with a parallel port.",
    )


def _parport(patient: Patient) -> Finding:
    return _device(patient.port.device, _MODPROBE)


def _ioport(patient: Patient) -> Finding:
    return _device(patient.port.ioport, 'Use port.kind = "ppdev": this kernel has no /dev/port.')


def _device(device: DeviceFacts, change: str) -> Finding:
    if not device.present:
        return Finding("device", State.BAD, f"{device.path} does not exist.", change)
    if not device.is_device:
        return Finding("device", State.BAD, f"{device.path} is not a device file.", change)
    who = f"{device.mode}, {device.owner}, group {device.group}"
    return Finding("device", State.OK, f"{device.path} is there ({who}).")


def _may_use_parport(patient: Patient) -> Finding:
    device = patient.port.device
    helps = device.mode[4:6] == "rw" and device.group != "root"
    join = f"Join its group with sudo usermod -aG {device.group} $USER and log in again."
    return _permission(device, join if helps else _UDEV)


def _may_use_ioport(patient: Patient) -> Finding:
    return _permission(patient.port.ioport, 'Run as root, or use port.kind = "ppdev".')


def _permission(device: DeviceFacts, change: str) -> Finding:
    if device.allowed:
        return Finding("permission", State.OK, f"This user may read and write {device.path}.")
    if not device.present:
        return Finding("permission", State.BAD, f"There is no {device.path} to use.")
    return Finding("permission", State.BAD, f"This user may not use {device.path}.", change)


def _printer_driver(patient: Patient) -> Finding:
    port = patient.port
    if port.lp_holds_it:
        return Finding(
            "printer driver",
            State.BAD,
            f"The printer driver lp has {port.device.path}.",
            "Unload it with sudo rmmod lp; it comes again at boot if /etc/modules-load.d names it.",
        )
    if "lp" in port.modules:
        return Finding(
            "printer driver", State.OK, "lp is loaded, but has not got the port: it does no harm."
        )
    return Finding("printer driver", State.OK, "lp is not loaded.")


def _lockdown_of_ppdev(patient: Patient) -> Finding:
    locked = patient.port.lockdown or "not known to this kernel"
    return Finding("lockdown", State.OK, f"Lockdown: {locked}; ppdev works in spite of it.")


def _lockdown_of_ioport(patient: Patient) -> Finding:
    if patient.port.is_locked_down:
        return Finding(
            "lockdown",
            State.BAD,
            f"The kernel is locked down ({patient.port.lockdown}): it refuses /dev/port.",
            'Use port.kind = "ppdev", or switch secure boot off.',
        )
    return Finding("lockdown", State.OK, "The kernel is not locked down.")


def _better_way(patient: Patient) -> Finding:
    device = patient.port.device
    if device.present:
        return Finding(
            "way",
            State.WARN,
            f"{device.path} is there too; /dev/port does not see who else uses the port.",
            'Use port.kind = "ppdev".',
        )
    return Finding("way", State.OK, "There is no ppdev device that could be used instead.")


def _opened(patient: Patient) -> Finding:
    if patient.opening.error:
        return Finding("claim", State.BAD, patient.opening.error)
    return Finding(
        "claim",
        State.OK,
        "Opened for this program alone and given back, with motors and outputs off.",
    )


def _inputs(patient: Patient) -> Finding:
    lines = patient.opening.lines
    if lines is None:
        return Finding("inputs", State.BAD, "The inputs could not be read.")
    read = f"{_levels(lines.pins)}; status register {lines.register:#04x}"
    switches = patient.config.switches
    bit = STATUS_PINS[switches.pin].bit
    if bool(lines.register & bit) == bool(switches.closed_reads):
        return Finding(
            "inputs",
            State.WARN,
            f"{read}. Pin {switches.pin} shows contact.",
            "Let go of the end switches, or look at their plug and at switches.closed_reads: a"
            " plug that is not in reads like contact, too.",
        )
    return Finding("inputs", State.OK, f"{read}. Pin {switches.pin}: no end switch is pressed.")


def _outputs(patient: Patient) -> Finding:
    if not patient.opening.pins:
        return Finding("outputs", State.WARN, "Nothing was written; what stands there is unknown.")
    return Finding("outputs", State.OK, f"Left with motors off: {_levels(patient.opening.pins)}.")


def _levels(pins: Iterable[tuple[int, bool]]) -> str:
    """As in "pins 10, 12 high; 11 low"."""
    found = {True: [], False: []}  # type: dict[bool, list[str]]
    for pin, high in pins:
        found[high].append(str(pin))
    parts = [
        f"{', '.join(found[high])} {word}" for high, word in ((True, "high"), (False, "low"))
        if found[high]
    ]  # fmt: skip
    return f"pins {'; '.join(parts)}"


PORT_CHECKS: Final[Mapping[str, Sequence[Check]]] = {
    "simulation": (_simulated,),
    "bridge": (*BRIDGE_CHECKS, _inputs, _microcontroller),
    "ppdev": (
        _parport, _may_use_parport, _printer_driver, _lockdown_of_ppdev, _opened, _inputs, _outputs,
    ),
    "devport": (
        _ioport, _may_use_ioport, _lockdown_of_ioport, _better_way, _opened, _inputs, _outputs,
    ),
}  # fmt: skip
