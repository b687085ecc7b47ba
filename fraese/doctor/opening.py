"""The configured port, really opened once, and left as a standing machine leaves it."""

from collections.abc import Callable
from dataclasses import dataclass

from fraese.errors import PortError
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.facts import StatusLines, output_pins, status_lines
from fraese.motor.ports.recorder import Recorder
from fraese.motor.realtime.rescue import switch_off
from fraese.motor.seams import CONTROL, DATA, Card, Port


@dataclass(frozen=True, slots=True)
class Opening:
    """What came of it.

    Attributes:
        error: why it failed; empty: it did not.
        lines: inputs as they read; None: not read.
        pins: outputs as they were left: DB25 pin, and whether it is high.
    """

    error: str = ""
    lines: StatusLines | None = None
    pins: tuple[tuple[int, bool], ...] = ()


def try_port(open_port: Callable[[], Port], card: Card) -> Opening:
    """Open it, read the inputs, write motors and outputs off, give it back.

    With ppdev the claim puts the control lines to rest. Rest may mean "on" for an output: so they
    are not left like that.

    Args:
        open_port: as the machine would do it.
        card: what is on the port.
    """
    try:
        port = Recorder(open_port(), MonotonicClock())
        try:
            lines = status_lines(port)
        finally:
            switch_off(lambda: port, card)
    except PortError as error:
        return Opening(error=str(error))
    last = dict(port.writes())
    return Opening(lines=lines, pins=output_pins(last.get(DATA, 0), last.get(CONTROL, 0)))


def try_board(device: str, baud: int) -> Opening:
    """Open the serial line of the bridge, and close it again; most boards start anew with that.

    Args:
        device: of the line; empty: of the only board that looks like one.
        baud: its rate.
    """
    # Nobody else needs pyserial.
    from fraese.motor.bridge.line import SerialLine, only_candidate, serial_ports

    try:
        SerialLine(device or only_candidate(serial_ports()), baud).close()
    except PortError as error:
        return Opening(error=str(error))
    return Opening()
