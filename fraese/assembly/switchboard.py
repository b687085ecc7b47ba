"""The switches of the simulated mill: which line each end is on, and how the lines read.

Rule 1: ends are those of the carriages, by the names that they have in the machine's coordinates.
Rule 2: a switch for referencing closes a little before the carriage is at its end.
"""

from collections.abc import Sequence

from fraese.assembly.trueaxis import TrueAxis
from fraese.assembly.trueplaces import reference_mm
from fraese.config import Config
from fraese.config.switches import SwitchLine
from fraese.control.endswitches import line_bits
from fraese.motor.ports.sim import Pressed, Wiring
from fraese.motor.seams import End

#: Of a shared line that there is not: its readings change no bit.
_NO_LINE = (0, 0)


def true_end(axes: Sequence[TrueAxis], name: str) -> End:
    """The end of a carriage, by its name (xmin)."""
    motor = next(n for n, axis in enumerate(axes) if axis.name == name[:1])
    sign = 1 if name.endswith("max") else -1
    return End(motor, sign * axes[motor].sign)


def own_lines(config: Config, axes: Sequence[TrueAxis]) -> list[frozenset[End]]:
    """Ends on every line of its own that stops the motors."""
    return [frozenset(true_end(axes, end) for end in line.ends) for line in _own(config)]


def wiring(config: Config, axes: Sequence[TrueAxis]) -> Wiring:
    """How the lines meet the status register."""
    lines = config.switch_lines
    shared = next((line_bits(line) for line in lines if not line.name), _NO_LINE)
    near = tuple(
        (*line_bits(line), _pressed(config, axes, line)) for line in lines if not line.stops
    )
    return Wiring(*shared, own=tuple(line_bits(line) for line in _own(config)), near=near)


def _own(config: Config) -> list[SwitchLine]:
    return [line for line in config.switch_lines if line.name and line.stops]


def _pressed(config: Config, axes: Sequence[TrueAxis], line: SwitchLine) -> Pressed:
    """Whether some carriage presses a switch of this line: asked at every reading."""
    way_mm, places = reference_mm(config), list[tuple[int, int, float]]()
    for end in line.ends:
        motor, sign = true_end(axes, end)
        axis = axes[motor]
        if axis.travel is not None:
            at_mm = axis.travel - way_mm if sign > 0 else way_mm
            places.append((motor, sign, sign * float(at_mm * axis.half_steps_per_unit)))

    def is_pressed(carriages_steps: Sequence[float]) -> bool:
        return any(sign * carriages_steps[motor] >= at for motor, sign, at in places)

    return is_pressed
