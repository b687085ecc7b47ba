"""Is the configured port there, and ours? One table of checks for each kind.

    kind         looked at from outside                     opened
    simulation   nothing                                    no
    bridge       device file, permission, USB               greeted, told its card, tried
    ppdev        device file, permission, lp                claimed alone
    devport      /dev/port, permission, lockdown, ppdev     locked
    another      nothing                                    as its package does

Rule 1: the port is opened once, before the checks (``opening.py``). A check only judges.
Rule 2: a refusal is told in the port's own sentence; it says what would help.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from fraese.doctor.bridge import BRIDGE_CHECKS
from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.motor.pins import STATUS_PINS
from fraese.motor.ports.facts import DeviceFacts
from fraese.phrases import joined, phrase

_MODPROBE: Final = phrase("Load the drivers with sudo modprobe -a parport_pc ppdev.")
_UDEV: Final = phrase(
    'Write SUBSYSTEM=="ppdev", GROUP="lp", MODE="0660" into'
    " /etc/udev/rules.d/60-parport.rules, load ppdev anew, join group lp and log in"
    " again."
)


def _simulated(_: Patient) -> Finding:
    return Finding(
        phrase("port"),
        State.OK,
        phrase(
            "The simulated mill: it needs no port, and nothing of what follows; its time is"
            " its own. What follows holds for this computer with a parallel port."
        ),
    )


def _microcontroller(_: Patient) -> Finding:
    return Finding(
        phrase("bridge"),
        State.OK,
        phrase(
            "The microcontroller times the steps by itself: but for suspend, what follows"
            " holds for this computer with a parallel port."
        ),
    )


def _parport(patient: Patient) -> Finding:
    return _device(patient.port.device, _MODPROBE)


def _ioport(patient: Patient) -> Finding:
    return _device(
        patient.port.ioport, phrase('Use port.kind = "ppdev": this kernel has no /dev/port.')
    )


def _device(device: DeviceFacts, change: str) -> Finding:
    if not device.present:
        return Finding(
            phrase("device"), State.BAD, phrase("{path} does not exist.", path=device.path), change
        )
    if not device.is_device:
        return Finding(
            phrase("device"),
            State.BAD,
            phrase("{path} is not a device file.", path=device.path),
            change,
        )
    who = f"{device.mode}, {device.owner}, group {device.group}"
    return Finding(
        phrase("device"), State.OK, phrase("{path} is there ({who}).", path=device.path, who=who)
    )


def _may_use_parport(patient: Patient) -> Finding:
    device = patient.port.device
    helps = device.mode[4:6] == "rw" and device.group != "root"
    join = phrase(
        "Join its group with sudo usermod -aG {group} $USER and log in again.", group=device.group
    )
    return _permission(device, join if helps else _UDEV)


def _may_use_ioport(patient: Patient) -> Finding:
    return _permission(patient.port.ioport, phrase('Run as root, or use port.kind = "ppdev".'))


def _permission(device: DeviceFacts, change: str) -> Finding:
    if device.allowed:
        return Finding(
            phrase("permission"),
            State.OK,
            phrase("This user may read and write {path}.", path=device.path),
        )
    if not device.present:
        return Finding(
            phrase("permission"), State.BAD, phrase("There is no {path} to use.", path=device.path)
        )
    return Finding(
        phrase("permission"),
        State.BAD,
        phrase("This user may not use {path}.", path=device.path),
        change,
    )


def _printer_driver(patient: Patient) -> Finding:
    port = patient.port
    if port.lp_holds_it:
        return Finding(
            phrase("printer driver"),
            State.BAD,
            phrase("The printer driver lp has {path}.", path=port.device.path),
            phrase(
                "Unload it with sudo rmmod lp; it comes again at boot if /etc/modules-load.d"
                " names it."
            ),
        )
    if "lp" in port.modules:
        return Finding(
            phrase("printer driver"),
            State.OK,
            phrase("lp is loaded, but has not got the port: it does no harm."),
        )
    return Finding(phrase("printer driver"), State.OK, phrase("lp is not loaded."))


def _lockdown_of_ppdev(patient: Patient) -> Finding:
    locked = patient.port.lockdown or phrase("not known to this kernel")
    return Finding(
        phrase("lockdown"),
        State.OK,
        phrase("Lockdown: {locked}; ppdev works in spite of it.", locked=locked),
    )


def _lockdown_of_ioport(patient: Patient) -> Finding:
    if patient.port.is_locked_down:
        return Finding(
            phrase("lockdown"),
            State.BAD,
            phrase(
                "The kernel is locked down ({lockdown}): it refuses /dev/port.",
                lockdown=patient.port.lockdown,
            ),
            phrase('Use port.kind = "ppdev", or switch secure boot off.'),
        )
    return Finding(phrase("lockdown"), State.OK, phrase("The kernel is not locked down."))


def _better_way(patient: Patient) -> Finding:
    device = patient.port.device
    if device.present:
        return Finding(
            phrase("way"),
            State.WARN,
            phrase(
                "{path} is there too; /dev/port does not see who else uses the port.",
                path=device.path,
            ),
            phrase('Use port.kind = "ppdev".'),
        )
    return Finding(
        phrase("way"), State.OK, phrase("There is no ppdev device that could be used instead.")
    )


def _opened(patient: Patient) -> Finding:
    if patient.opening.error:
        return Finding(phrase("claim"), State.BAD, patient.opening.error)
    return Finding(
        phrase("claim"),
        State.OK,
        phrase("Opened for this program alone and given back, with motors and outputs off."),
    )


def _inputs(patient: Patient) -> Finding:
    lines = patient.opening.lines
    if lines is None:
        return Finding(phrase("inputs"), State.BAD, phrase("The inputs could not be read."))
    read = phrase(
        "{levels}; status register {register:#04x}",
        levels=_levels(lines.pins),
        register=lines.register,
    )
    switches = patient.config.switch_lines
    closed = [
        line.pin
        for line in switches
        if bool(lines.register & STATUS_PINS[line.pin].bit) == bool(line.closed_reads)
    ]
    if closed:
        return Finding(
            phrase("inputs"),
            State.WARN,
            phrase("{read}. Pin {pin} shows contact.", read=read, pin=_numbers(closed)),
            phrase(
                "Let go of the end switches, or look at their plug and at"
                " switches.closed_reads: a plug that is not in reads like contact, too."
            ),
        )
    return Finding(
        phrase("inputs"),
        State.OK,
        phrase(
            "{read}. Pin {pin}: no end switch is pressed.",
            read=read,
            pin=_numbers([line.pin for line in switches]),
        ),
    )


def _numbers(pins: Sequence[int]) -> str:
    return ", ".join(map(str, pins))


def _outputs(patient: Patient) -> Finding:
    if not patient.opening.pins:
        return Finding(
            phrase("outputs"),
            State.WARN,
            phrase("Nothing was written; what stands there is unknown."),
        )
    return Finding(
        phrase("outputs"),
        State.OK,
        phrase("Left with motors off: {levels}.", levels=_levels(patient.opening.pins)),
    )


def _levels(pins: Iterable[tuple[int, bool]]) -> str:
    """As in "pins 10, 12 high; 11 low"."""
    found = {True: [], False: []}  # type: dict[bool, list[str]]
    for pin, high in pins:
        found[high].append(str(pin))
    words = {True: phrase("high"), False: phrase("low")}
    parts = [joined(" ", (", ".join(found[high]), words[high])) for high in words if found[high]]
    return phrase("pins {parts}", parts=joined("; ", parts))


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
#: Of a port that lives in a package of its own.
_OF_ANOTHER: Final[Sequence[Check]] = (_opened, _inputs, _outputs)


def port_checks(kind: str) -> Sequence[Check]:
    """The checks of that kind of port."""
    return PORT_CHECKS.get(kind, _OF_ANOTHER)
