r"""SMC800/SMC1500: phase currents, one motor after the other, a reading after each.

    data     ==X=========X==========X=====      the byte: motor, phase B, phase A
    strobe   __/~\_______/~\________/~\__      control bit 0; the pin is the inverse
    status      r         r          r

Rule 1: within a tick the leader comes first, then motor order.
Rule 2: a movement is data, strobe set, strobe clear, reading. The strobe bit rests clear.
Rule 3: the card has no direction lines and no clock: a direction is the order of the table.
"""

from collections.abc import Sequence
from typing import Final

from fraese.motor.cards.control import NOTHING, READING, ControlLines, OutputPin
from fraese.motor.phases import MOTRUN, MOTZERO, holding_table, motor_bits, step_word
from fraese.motor.pins import CONTROL_PINS
from fraese.motor.seams import CONTROL, DATA, STATUS, Entries, Entry, IdleLevel

_STROBE_BIT: Final = CONTROL_PINS[1].bit


def _orders(motors: int) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """For every leader and every bit mask of moving motors: their order within a tick."""

    def order(leader: int, moving: int) -> tuple[int, ...]:
        by_rank = sorted(range(motors), key=lambda motor: (motor != leader, motor))
        return tuple(motor for motor in by_rank if moving >> motor & 1)

    return tuple(
        tuple(order(leader, moving) for moving in range(1 << motors)) for leader in range(motors)
    )


class SmcCard:
    """SMC800/SMC1500 without its add-on board: phase currents, one motor a write.

    Args:
        table: drive table, one entry a step, of any length.
        holding_percent: current at ``IdleLevel.HOLD``; 0 means off.
        levels: level map, a row of ``LEVEL_MAPS``; only used to derive the holding table.
        outputs: free outputs on pins 14, 16 and 17; pin 1 is the strobe.
        motors: 1 to 3.
        sockets: where each motor is plugged in, 0 to 2; empty: in order.

    Attributes:
        motors: how many.
        sockets: as given.
        step_word: what one step of the table is called.
        table: drive table.
        hold_table: the bytes at ``IdleLevel.HOLD``; empty: off as well.
        lines: the control register.
    """

    setup_cycles = 0
    pulse_cycles = 0
    duty_q16 = 0
    #: 20 us: one movement by a microcontroller of 16 MHz, with its counting.
    beat_cycles = 320
    fall = NOTHING

    def __init__(
        self,
        table: bytes = MOTRUN,
        holding_percent: int = 0,
        levels: tuple[int, int, int, int] = (100, 60, 20, 0),
        outputs: Sequence[OutputPin] = (),
        motors: int = 3,
        sockets: Sequence[int] = (),
    ) -> None:
        self.sockets = tuple(sockets) or tuple(range(motors))
        self.motors = motors = len(self.sockets)
        self.table = table
        self.hold_table = holding_table(table, holding_percent, levels) if holding_percent else b""
        self.step_word = step_word(table)
        self.lines = ControlLines(0, outputs)
        self._index = [0] * motors
        self._directions = [0] * motors
        self._next = [0] * motors
        self._orders = _orders(motors)
        self._order = self._orders[0]
        self._made: dict[int, list[list[Entries]]] = {}
        self._run = self._columns()

    def _latch(self, byte: int) -> Entries:
        control = self.lines.value
        return (
            Entry(DATA, byte),
            Entry(CONTROL, control | _STROBE_BIT),
            Entry(CONTROL, control & ~_STROBE_BIT),
        )

    def _columns(self) -> list[list[Entries]]:
        """Per motor and index, a whole movement; made once for every state of the outputs."""
        control = self.lines.value
        if control not in self._made:
            self._made[control] = [
                [
                    (*self._latch(motor_bits(socket) | byte), Entry(STATUS, motor))
                    for byte in self.table
                ]
                for motor, socket in enumerate(self.sockets)
            ]
        return self._made[control]

    def _stand(self, table: bytes) -> Entries:
        return tuple(
            entry
            for socket, index in zip(self.sockets, self._index, strict=True)
            for entry in self._latch(motor_bits(socket) | table[index])
        )

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Nothing to set up: the direction is the order of the table."""
        self._directions[:] = directions
        self._order = self._orders[leader]
        self._look_ahead()
        return NOTHING

    def _look_ahead(self) -> None:
        length = len(self.table)
        self._next[:] = [
            (index + direction) % length
            for index, direction in zip(self._index, self._directions, strict=True)
        ]

    def tick(self, moving: int) -> Entries:
        """Data, strobe set, strobe clear, reading; for each moving motor."""
        if not moving:
            return READING
        run, following = self._run, self._next
        entries = NOTHING
        for motor in self._order[moving]:
            movement = run[motor][following[motor]]
            entries = entries + movement if entries else movement
        return entries

    def stepped(self, moving: int) -> None:
        """The phase indices follow."""
        index, following = self._index, self._next
        for motor in self._order[moving]:
            at = index[motor] = following[motor]
            following[motor] = (at + self._directions[motor]) % len(self.table)

    def signals(self, active: bool, boost: bool) -> Entries:
        """The card has no such lines."""
        return NOTHING

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Bit 0 is the first configured output."""
        before = self.lines.value
        self.lines.set_outputs(mask, value)
        if self.lines.value == before:
            return NOTHING
        self._run = self._columns()
        return self.lines.entries()

    def energise(self) -> Entries:
        """Every motor at full current in its present phase."""
        return self._stand(self.table)

    def idle(self, level: IdleLevel) -> Entries:
        """Holding current from the second table, or both phases of every motor off."""
        if level is IdleLevel.HOLD and self.hold_table:
            return self._stand(self.hold_table)
        return self._stand(bytes([MOTZERO]) * len(self.table))

    def phases(self) -> tuple[int, ...]:
        """Index into the drive table, per motor."""
        return tuple(self._index)

    def set_phases_of(self, table: bytes, phases: Sequence[int]) -> None:
        """Take up another table of the same length, and where in it each motor stands."""
        self.table = table
        self._made.clear()
        self._run = self._columns()
        self.set_phases(phases)

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up indices that were kept."""
        self._index[:] = [phase % len(self.table) for phase in phases]
        self._look_ahead()
