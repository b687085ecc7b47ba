"""What a card may hang on: serial and parallel ports of this computer."""

import json
from pathlib import Path
from typing import Final

import typer

from fraese.cli.leaving import leave
from fraese.cli.options import JsonOption
from fraese.cli.output import say
from fraese.motor.bridge.line import SerialPort, serial_ports
from fraese.phrases import joined, phrase

app = typer.Typer()

_PARALLEL: Final = "parport*"


@app.command()
def ports(as_json: JsonOption = False) -> None:
    """List the ports that a card may hang on; boards that look like an Arduino first."""

    def go() -> int:
        serial, parallel = serial_ports(), parallel_ports()
        if as_json:
            say(json.dumps({"serial": [_as_dict(port) for port in serial], "parallel": parallel}))
            return 0
        for port in serial:
            say(_in_words(port))
        for device in parallel:
            say(phrase("{device}  parallel port", device=device))
        if not serial and not parallel:
            say(phrase("no serial or parallel port"))
        return 0

    leave(go, as_json)


def parallel_ports(folder: Path = Path("/dev")) -> list[str]:
    """Device files of parallel ports."""
    return sorted(str(path) for path in folder.glob(_PARALLEL))


def _ids(port: SerialPort) -> str:
    return "" if port.vid is None or port.pid is None else f"{port.vid:04X}:{port.pid:04X}"


def _as_dict(port: SerialPort) -> dict[str, object]:
    return {
        "device": port.device,
        "description": port.description,
        "usb": _ids(port),
        "candidate": bool(port.maker),
    }


def _in_words(port: SerialPort) -> str:
    likely = (
        phrase("{maker}, may carry the bridge", maker=port.maker)
        if port.maker
        else phrase("serial port")
    )
    parts = (port.device, likely, _ids(port), port.description)
    return joined("  ", [part for part in parts if part])
