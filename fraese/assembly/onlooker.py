"""Looking on at a simulated mill: where the carriages really are, and which steps were lost.

    rotors, carriages --what each axis really is--> millimetres of the machine --> MachineState

Rule 1: half-steps of the motors become millimetres and steps of the card here, and only here.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Final

from fraese.anythread import any_thread
from fraese.assembly.trueaxis import TrueAxis, true_axes
from fraese.assembly.trueplaces import true_way, true_zero
from fraese.config import Config
from fraese.control.onlooker import Seen
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.rotor import Hindrance
from fraese.motor.seams import End
from fraese.phrases import joined, phrase


def _limits(axis: TrueAxis) -> str:
    motor = axis.motor
    return phrase(
        "its motor starts and stops at {start_turns_s:g} turns/s and changes its rate by"
        " {acceleration_turns_s2:g} turns/s in a second",
        start_turns_s=motor.start_turns_s,
        acceleration_turns_s2=motor.acceleration_turns_s2,
    )


def _bands(axis: TrueAxis) -> str:
    bands = axis.motor.resonances_turns_s
    return joined(", ", (phrase("{low:g} to {high:g}", low=low, high=high) for low, high in bands))


#: Why steps were lost, half a sentence.
_WHY: Final[Mapping[Hindrance, Callable[[TrueAxis], str]]] = {
    Hindrance.TOO_FAST: lambda axis: phrase(
        "too fast: its motor follows up to {max_turns_s:g} turns/s",
        max_turns_s=axis.motor.max_turns_s,
    ),
    Hindrance.TOO_STEEP: lambda axis: phrase("too steep: {limits}", limits=_limits(axis)),
    Hindrance.RESONANCE: lambda axis: phrase(
        "resonance: its motor cannot stay at {bands} turns/s", bands=_bands(axis)
    ),
    Hindrance.STOPPED_DEAD: lambda axis: phrase(
        "stopped too suddenly: {limits}", limits=_limits(axis)
    ),
}


class MillOnlooker:
    """Looks on at a simulated mill, in the coordinates of the machine.

    Args:
        config: which way the axes are configured, and where machine zero is meant to be.
        port: the mill.
    """

    def __init__(self, config: Config, port: SimulatedMill) -> None:
        self._port = port
        self._axes = true_axes(config)
        tables = config.axes.table
        self._signs = [-1 if axis.inverted else 1 for axis in tables.values()]
        self._zeros = [
            true_zero(axis, config, table)
            for axis, table in zip(self._axes, tables.values(), strict=True)
        ]

    def begin(self) -> None:
        """A job begins: what was lost so far is old."""
        for rotor in self._port.mill.rotors:
            rotor.forget()

    def rest(self) -> None:
        """The motors stand: what they had to run on they have done."""
        for rotor in self._port.mill.rotors:
            rotor.rest()

    @any_thread
    def look(self) -> Seen:
        """What is to be seen now; it only reads."""
        mill = self._port.mill
        carriages = mill.carriages_steps()
        missed = [rotor.missed_steps for rotor in mill.rotors]
        return Seen(
            carriages_mm=tuple(
                float(true_way(axis, at) - zero)
                for axis, at, zero in zip(self._axes, carriages, self._zeros, strict=True)
            ),
            lost_steps=tuple(
                float(Fraction(steps) / axis.half_steps_per_step * axis.sense * sign)
                for axis, steps, sign in zip(self._axes, missed, self._signs, strict=True)
            ),
            lost_why=tuple(
                _why(axis, rotor.hindrance) if steps else ""
                for axis, rotor, steps in zip(self._axes, mill.rotors, missed, strict=True)
            ),
        )

    def end(self, name: str) -> End:
        """The end of that name (xmin) as the mill counts it, in motor direction.

        Raises:
            ValueError: if there is no such axis.
        """
        motor = [axis.name for axis in self._axes].index(name[:1])
        return End(motor, (1 if name.endswith("max") else -1) * self._axes[motor].sign)


def _why(axis: TrueAxis, hindrance: Hindrance | None) -> str:
    if hindrance is None:
        return ""
    known = _WHY.get(hindrance)
    return known(axis) if known else hindrance.value
