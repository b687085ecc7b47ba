"""Cards as seen from the plug: the electronics of a simulated mill.

Rule 1: everything comes in through the pins, as on metal. A byte means something only at the
        strobe, or at the edge of a clock.
Rule 2: where a field points is remembered while there is no current; a rotor then follows nothing
        until the current is back, and what it missed is lost.
Rule 3: currents are what a clamp meter would show, not what was asked for.
Rule 4: angles of a field are whole parts of a power of two: however far it turns, their sum is
        exact.
"""

from collections.abc import Sequence
from typing import Final, Protocol

from fraese.motor.mill import Mill
from fraese.motor.phases import (
    MOTRUN,
    MOTZERO,
    TURN_STEPS,
    Currents,
    currents_of,
    exact_angle,
    field_angle,
)
from fraese.motor.seams import Clock

_STROBE: Final = 1


class Electronics(Protocol):
    """A card as seen from the plug."""

    def data(self, value: int) -> None:
        """The data pins changed to this byte."""

    def control(self, value: int) -> None:
        """The control register was written."""

    @property
    def pins(self) -> tuple[int, int]:
        """The data byte and the control register, as they are on the pins."""

    #: Where each motor's field pointed last, in half-steps of a turn; read only.
    angles: list[float]

    def set_angle(self, motor: int, angle: float) -> None:
        """Let the field of a motor point there, before anything moves."""

    def currents(self, motor: int) -> Currents:
        """What a clamp meter would show on the coils."""

    def cut_power(self) -> None:
        """The supply is gone; rotors are free."""

    def restore_power(self) -> None:
        """The supply is back; currents are nil until something is commanded."""


class SmcElectronics:
    """SMC800/SMC1500: latches the data byte on nStrobe, holds the phase currents.

    Args:
        mill: what the motors move.
        clock: when it happens.
        levels: what the current codes really mean on this card.
        rest: the byte in whose field the rotors stand at first.
        sockets: where each motor is plugged in, 0 to 2; empty: in order.
    """

    def __init__(
        self,
        mill: Mill,
        clock: Clock,
        levels: tuple[int, int, int, int],
        rest: int = MOTRUN[0],
        sockets: Sequence[int] = (),
    ) -> None:
        sockets = sockets or range(len(mill.rotors))
        self._motor_at = {socket: motor for motor, socket in enumerate(sockets)}
        self._mill = mill
        self._now_ns = clock.now_ns
        self._levels = levels
        self._angle_of = [field_angle(byte, levels) for byte in range(64)]
        self.angles = [self._angle_of[rest & 63] or 0.0] * len(mill.rotors)
        self._latched = [MOTZERO] * len(mill.rotors)
        self._data = 0
        self._control = 0
        self._supplied = True

    def data(self, value: int) -> None:
        """Only seen at the next strobe."""
        self._data = value

    def control(self, value: int) -> None:
        """The strobe's setting edge latches."""
        if value & _STROBE and not self._control & _STROBE:
            self._latch(self._data)
        self._control = value

    @property
    def pins(self) -> tuple[int, int]:
        """Data byte and control register."""
        return self._data, self._control

    def set_angle(self, motor: int, angle: float) -> None:
        """As it was left."""
        self.angles[motor] = angle

    def _latch(self, byte: int) -> None:
        motor = self._motor_at.get(byte >> 6)
        if motor is None:
            return
        self._latched[motor] = byte
        angle = self._angle_of[byte & 63]
        rotor = self._mill.rotors[motor]
        if angle is None:
            if rotor.powered:
                rotor.release()
            return
        delta = angle - self.angles[motor]
        self.angles[motor] = angle
        if not rotor.powered and self._supplied:
            rotor.energise()
        if delta:
            if delta > 4:
                delta -= 8
            elif delta < -4:
                delta += 8
            self._mill.turn(motor, delta, self._now_ns())

    def currents(self, motor: int) -> Currents:
        """From the byte last latched."""
        return currents_of(self._latched[motor] if self._supplied else MOTZERO, self._levels)

    def cut_power(self) -> None:
        """All coils without current; what is latched meanwhile moves nothing and is lost."""
        self._supplied = False
        for rotor in self._mill.rotors:
            rotor.release()

    def restore_power(self) -> None:
        """Currents flow again from the next byte on."""
        self._supplied = True
        self._latched = [MOTZERO] * len(self._mill.rotors)


def _ring(pulses: int) -> dict[bool, dict[float, tuple[float, float]]]:
    """The angles of one electrical turn in so many pulses.

    Returns:
        by direction, True forward, and by angle: the next angle, and how far it is.
    """
    angles = [exact_angle(TURN_STEPS * n / pulses) for n in range(pulses)]
    nexts = [*angles[1:], float(TURN_STEPS)]
    return {
        True: {a: (b % TURN_STEPS, b - a) for a, b in zip(angles, nexts, strict=True)},
        False: {b % TURN_STEPS: (a, a - b) for a, b in zip(angles, nexts, strict=True)},
    }


class StepDirElectronics:
    """Step/direction drives: data bits 2k, 2k+1 are direction and clock of socket k.

    How many pulses make one electrical turn, the slides of the mill say.

    Args:
        mill: what the motors move.
        clock: when it happens.
        clock_idles_high: a step is then the falling edge.
        forward_high: level of the direction lines for positive steps.
        sockets: where each motor is plugged in, 0 to 3; empty: in order.
    """

    def __init__(
        self,
        mill: Mill,
        clock: Clock,
        clock_idles_high: bool = False,
        forward_high: bool = True,
        sockets: Sequence[int] = (),
    ) -> None:
        self._mill = mill
        # Place of each motor's direction bit.
        self._places = [2 * socket for socket in sockets or range(len(mill.rotors))]
        self._now_ns = clock.now_ns
        # Inverted wiring is turned round at the plug.
        self._inverted = (0xAA if clock_idles_high else 0) | (0 if forward_high else 0x55)
        self._rings = [_ring(slide.steps_in_turn) for slide in mill.slides]
        self.angles = [0.0] * len(mill.rotors)
        # Pulled up before anybody writes: the first byte is no rising edge.
        self._data = 0xFF
        self._control = 0
        self.restore_power()

    def data(self, value: int) -> None:
        """A rising clock steps its motor."""
        value ^= self._inverted
        rising = value & ~self._data
        self._data = value
        for motor, place in enumerate(self._places):
            if rising >> place & 2:
                ring = self._rings[motor][bool(value >> place & 1)]
                self.angles[motor], delta = ring[self.angles[motor]]
                self._mill.turn(motor, delta, self._now_ns())

    @property
    def pins(self) -> tuple[int, int]:
        """Data byte and control register."""
        return self._data ^ self._inverted, self._control

    def set_angle(self, motor: int, angle: float) -> None:
        """As it was left; the nearest that the drive knows."""
        self.angles[motor] = min(self._rings[motor][True], key=lambda known: abs(known - angle))

    def control(self, value: int) -> None:
        """ACTIVE and BOOST change the current, not the position."""
        self._control = value

    def currents(self, motor: int) -> Currents:
        """A drive regulates its own currents; on or off is all that is known here."""
        level = 100 if self._supplied else 0
        return Currents(level, level)

    def cut_power(self) -> None:
        """Motors without current; the drives count on, and what they count is lost."""
        self._supplied = False
        for rotor in self._mill.rotors:
            rotor.release()

    def restore_power(self) -> None:
        """Current again: rotors turn to the nearest angle of their field."""
        self._supplied = True
        for rotor in self._mill.rotors:
            rotor.energise()
