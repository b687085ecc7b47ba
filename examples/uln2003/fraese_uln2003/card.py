"""The card: which byte makes a step.

    data   7    6    5    4  |  3    2    1    0
         +----+----+----+----+----+----+----+----+
         | D    C    B    A  |  D    C    B    A  |     socket 2 | socket 1
         +----+----+----+----+----+----+----+----+

Rule 1: a coil carries current while its bit is set. There is no strobe and no clock: the byte on
        the pins is what the motors do, all of them in one write.
Rule 2: the table is one-hot with both neighbours on in between: eight half-steps.
Rule 3: there is no smaller current: at standstill the coils are on or off.
"""

from collections.abc import Sequence

from fraese.motor.cards.control import NOTHING, READING, ControlLines, OutputPin
from fraese.motor.seams import DATA, Entries, Entry, IdleLevel

#: A, A and B, B, B and C ...: one entry a half-step.
TABLE = (0b0001, 0b0011, 0b0010, 0b0110, 0b0100, 0b1100, 0b1000, 0b1001)
BITS_A_SOCKET = 4


class UlnCard:
    """Two unipolar motors.

    Args:
        outputs: free outputs, on any control pin.
        sockets: where each motor is plugged in, 0 or 1; empty: in order.

    Attributes:
        motors: how many.
    """

    step_word = "half-step"
    setup_cycles = pulse_cycles = duty_q16 = 0
    #: 20 us: motors that follow another one may step between its steps.
    beat_cycles = 320
    fall = NOTHING

    def __init__(self, outputs: Sequence[OutputPin] = (), sockets: Sequence[int] = ()) -> None:
        self.sockets = tuple(sockets) or (0, 1)
        self.motors = len(self.sockets)
        self.lines = ControlLines(0, outputs)
        self._index = [0] * self.motors
        self._directions = [0] * self.motors

    def _byte(self, indices: Sequence[int]) -> int:
        byte = 0
        for socket, index in zip(self.sockets, indices, strict=True):
            byte |= TABLE[index % len(TABLE)] << BITS_A_SOCKET * socket
        return byte

    def _after(self, moving: int) -> list[int]:
        return [
            (index + direction * (moving >> motor & 1)) % len(TABLE)
            for motor, (index, direction) in enumerate(
                zip(self._index, self._directions, strict=True)
            )
        ]

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Nothing to set up: a direction is the order of the table."""
        self._directions[:] = directions
        return NOTHING

    def tick(self, moving: int) -> Entries:
        """One byte for all of them, and a reading."""
        return (Entry(DATA, self._byte(self._after(moving))), *READING) if moving else READING

    def stepped(self, moving: int) -> None:
        """The indices follow."""
        self._index[:] = self._after(moving)

    def signals(self, active: bool, boost: bool) -> Entries:
        """There are no such lines."""
        return NOTHING

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Bit 0 is the first configured output."""
        before = self.lines.value
        self.lines.set_outputs(mask, value)
        return NOTHING if self.lines.value == before else self.lines.entries()

    def energise(self) -> Entries:
        """The coils of the present half-steps."""
        return (Entry(DATA, self._byte(self._index)),)

    def idle(self, level: IdleLevel) -> Entries:
        """On or off: see rule 3."""
        return self.energise() if level is IdleLevel.HOLD else (Entry(DATA, 0),)

    def phases(self) -> tuple[int, ...]:
        """Index into the table, per motor."""
        return tuple(self._index)

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up indices that were kept."""
        self._index[:] = [phase % len(TABLE) for phase in phases]
