"""Where the bridge is: options that its commands share."""

from typing import Annotated, NamedTuple

import typer

from fraese.config import Config
from fraese.motor.bridge.line import SerialLine, only_candidate, serial_ports

DeviceOption = Annotated[
    str | None,
    typer.Option(
        "--device", metavar="PORT", help="Serial port; else port.device, or the only one."
    ),
]
BaudOption = Annotated[
    int | None, typer.Option("--baud", metavar="RATE", help="Its rate; else port.baud.")
]


class Place(NamedTuple):
    """Where the bridge is."""

    config: Config
    device: str
    baud: int

    def line(self) -> SerialLine:
        """Open it."""
        return SerialLine(self.device, self.baud)


def place_of(config: Config, device: str | None, baud: int | None) -> Place:
    """As the options say, else the configuration, else the only board that is plugged in.

    Raises:
        PortError: there is none, or there are several.
    """
    port = config.port
    configured = port.device if port.kind == "bridge" else ""
    return Place(config, device or configured or only_candidate(serial_ports()), baud or port.baud)
