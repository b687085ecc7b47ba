"""The configured parallel port, really opened once, and left as a standing machine leaves it."""

from collections.abc import Callable

from fraese.doctor.opening import Opening
from fraese.errors import PortError
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.facts import output_pins, status_lines
from fraese.motor.ports.recorder import Recorder
from fraese.motor.realtime.rescue import switch_off
from fraese.motor.seams import CONTROL, DATA, Card, Port


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
