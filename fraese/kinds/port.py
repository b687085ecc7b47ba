"""What the rest of the house asks of a port: one record.

    kind         opened by                              tells machines apart by
    simulation   nobody: the core writes to the mill    nothing
    ppdev        the step process                       its device file
    devport      the step process                       its address
    bridge       the driver of the bridge               its serial port
    another      the step process                       as its record says

Rule 1: a record is found by its name in ``peers.py: PORTS``.
Rule 2: a port that can be opened is one of metal: its steps are made by a process of their own.
        What opens it, and the port itself, is carried over to that process: see ``pickle``.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from fraese.config import Config
from fraese.config.wiring import PortConfig
from fraese.motor.seams import Port
from fraese.peers import PORTS
from fraese.phrases import phrase

_DEVICE: Final = re.compile(r"(/[^\x00-\x1f\x7f]{1,200}|COM[0-9]{1,3})?")


def _full_path(device: str) -> str:
    if _DEVICE.fullmatch(device):
        return ""
    return phrase("must be the full path of a device file, such as /dev/parport0")


def _device(port: PortConfig) -> str:
    return port.device


@dataclass(frozen=True)
class PortKind:
    """One kind of port.

    Attributes:
        opens: what opens it, as configured; None: it has a driver of its own.
        address: which port of its kind it is: each machine has its own kept state.
        device_fault: why ``port.device`` will not do, half a sentence; empty: it will.
        sets_power: it can set a laser's power by pulses.
    """

    opens: Callable[[Config], Callable[[], Port]] | None = None
    address: Callable[[PortConfig], str] = _device
    device_fault: Callable[[str], str] = _full_path
    sets_power: bool = False


def port_kind(port: PortConfig) -> PortKind:
    """The record of a port as configured."""
    found = PORTS.record(port.kind)
    assert isinstance(found, PortKind)
    return found


def port_opener(config: Config) -> Callable[[], Port]:
    """What opens the port of a machine of metal."""
    opens = port_kind(config.port).opens
    assert opens is not None, config.port.kind
    return opens(config)


def _ppdev(config: Config) -> Callable[[], Port]:
    # What ports need exists on Linux only.
    from fraese.motor.ports.ppdev import PpdevPort

    return partial(PpdevPort, config.port.parallel_device)


def _devport(config: Config) -> Callable[[], Port]:
    from fraese.motor.ports.devport import DevPort

    return partial(DevPort, config.port.base)


def _nothing(_port: PortConfig) -> str:
    return ""


def _parallel_device(port: PortConfig) -> str:
    return port.parallel_device


def _base(port: PortConfig) -> str:
    return f"{port.base:#x}"


SIMULATION: Final = PortKind(address=_nothing, sets_power=True)
PPDEV: Final = PortKind(_ppdev, _parallel_device)
DEVPORT: Final = PortKind(_devport, _base)
BRIDGE: Final = PortKind(sets_power=True)
