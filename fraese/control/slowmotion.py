"""Slow motion: so many steps of one motor, at a rate at which each can be seen.

Rule 1: they are the motor's steps: backlash is not made up for.
Rule 2: limits and end switches count as in a jog.
"""

from fraese.control.calibration.moves import AxisMoves, with_rates
from fraese.control.controller import Controller
from fraese.control.jobs import Job
from fraese.errors import LimitError
from fraese.phrases import phrase


def turn_slowly(controller: Controller, axis: str, steps: int, rate_hz: float) -> None:
    """Turn a motor; the controller's ``run`` does it.

    Args:
        controller: of the machine.
        axis: name.
        steps: signed, in the direction of the axis.
        rate_hz: steps/s; not above the start/stop rate, so that there is no ramp.

    Raises:
        LimitError: if it would leave the travel, or is nothing.
        StateError: if the machine is not ready.
    """
    moves = AxisMoves(controller, axis)
    if not steps or not rate_hz > 0:
        raise LimitError(phrase("A motor is turned by at least one step, at more than 0 steps/s."))
    target = list(controller.position.position_steps)
    target[moves.motor] += steps
    controller.check_moves([tuple(target)])
    rate_hz = min(rate_hz, moves.axis.start_rate_hz)
    slow = with_rates(moves.axis, rate_hz, rate_hz, moves.axis.acceleration_hz_s)

    def job() -> Job:
        yield from moves.go(steps, axis=slow)

    controller.start(phrase("slow motion {axis}", axis=axis.upper()), job())
