"""The same card as seen from the plug, for the simulated mill.

Rule 1: it decodes bits into coils by itself; it shares nothing with the card but the wiring. Where
        it agrees with the card, two have thought the same.
"""

import math
from collections.abc import Sequence

from fraese.motor.mill import Mill
from fraese.motor.phases import Currents, exact_angle
from fraese.motor.seams import Clock

#: Half-steps in one electrical turn; coils A to D point two of them apart.
TURN = 8
COILS = 4


def field_angle(bits: int) -> float | None:
    """Where the field of four coils points, in half-steps; None: nowhere."""
    east = (bits & 1) - (bits >> 2 & 1)
    north = (bits >> 1 & 1) - (bits >> 3 & 1)
    if not east and not north:
        return None
    return exact_angle(math.atan2(north, east) * TURN / math.tau % TURN)


class UlnElectronics:
    """Eight transistors.

    Args:
        mill: what the motors move.
        clock: when it happens.
        sockets: in which each motor of the mill hangs, 0 or 1.
    """

    def __init__(self, mill: Mill, clock: Clock, sockets: Sequence[int]) -> None:
        self._mill = mill
        self._now_ns = clock.now_ns
        self._shifts = [COILS * socket for socket in sockets]
        self._angle_of = [field_angle(bits) for bits in range(1 << COILS)]
        self.angles = [0.0] * len(mill.rotors)
        self._data = self._control = 0
        self._supplied = True

    def data(self, value: int) -> None:
        """The coils follow at once."""
        before, self._data = self._data, value
        for motor, shift in enumerate(self._shifts):
            if (before ^ value) >> shift & 0xF:
                self._turn(motor, value >> shift & 0xF)

    def _turn(self, motor: int, bits: int) -> None:
        rotor, angle = self._mill.rotors[motor], self._angle_of[bits]
        if angle is None:
            rotor.release()
            return
        if not rotor.powered and self._supplied:
            rotor.energise()
        delta = (angle - self.angles[motor] + TURN / 2) % TURN - TURN / 2
        self.angles[motor] = angle
        if delta:
            self._mill.turn(motor, delta, self._now_ns())

    def control(self, value: int) -> None:
        """Free outputs; nothing of the card."""
        self._control = value

    @property
    def pins(self) -> tuple[int, int]:
        """Data byte and control register."""
        return self._data, self._control

    def set_angle(self, motor: int, angle: float) -> None:
        """As it was left."""
        self.angles[motor] = angle

    def currents(self, motor: int) -> Currents:
        """Coils A and C, and B and D, as the two windings of one motor."""
        bits = self._data >> self._shifts[motor] & 0xF if self._supplied else 0
        east = (bits & 1) - (bits >> 2 & 1)
        north = (bits >> 1 & 1) - (bits >> 3 & 1)
        return Currents(100 * east, 100 * north)

    def cut_power(self) -> None:
        """All coils without current."""
        self._supplied = False
        for rotor in self._mill.rotors:
            rotor.release()

    def restore_power(self) -> None:
        """Current again, where bits are set."""
        self._supplied = True
        for motor, shift in enumerate(self._shifts):
            if self._data >> shift & 0xF:
                self._mill.rotors[motor].energise()
