r"""Cards: what the registers mean. Data and arithmetic, no clock.

Rule 1: a card owns the shadow of the control register; nobody else writes it.
Rule 2: bits of the control register that a card does not use stay as they rest. 0xFF is never
        written: it would also set the interrupt and direction bits.
Rule 3: within a tick the leader comes first, then motor order.

SMC1500, one motor after the other, a reading after each:

    data     ==X=========X==========X=====      the byte: motor, phase B, phase A
    strobe   __/~\_______/~\________/~\__      control bit 0; the pin is the inverse
    status      r         r          r

Step/direction (X4Step, paper), all motors in one byte:

    data     ==X(dir)=====X(clocks high)===X(clocks low)==
               |<- setup ->|<-- half int. -->|
    status                  r
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from fraese.motor.phases import MOTRUN, MOTZERO, holding_table, motor_bits
from fraese.motor.seams import CONTROL, DATA, EVERY_MOTOR, STATUS, Entries, Entry, IdleLevel

#: Control register bit behind each DB25 pin, and whether pin and register are inverted.
CONTROL_PINS: Final = {
    1: (0b0001, True),
    14: (0b0010, True),
    16: (0b0100, False),
    17: (0b1000, True),
}

STROBE_BIT: Final = CONTROL_PINS[1][0]
BOOST_PIN: Final = 16
ACTIVE_PIN: Final = 17

_CYCLES_PER_US: Final = 16
_NOTHING: Final[Entries] = ()
_READING: Final[Entries] = (Entry(STATUS, EVERY_MOTOR),)


class OutputPin(NamedTuple):
    """A free output: a DB25 pin of the control register, and which level means on."""

    pin: int
    active_high: bool = True


class ControlLines:
    """The shadow of the control register.

    Args:
        value: how the register rests; bits of ``outputs`` are changed to their off level.
        outputs: free outputs, in the order of the bits of ``set_outputs``.
    """

    def __init__(self, value: int, outputs: Sequence[OutputPin]) -> None:
        self.value = value
        self._outputs = tuple(outputs)
        self.set_outputs(~0, 0)

    def set_pin(self, pin: int, high: bool) -> None:
        """Change the shadow so that a pin is high or low."""
        bit, inverted = CONTROL_PINS[pin]
        self.value = self.value | bit if high != inverted else self.value & ~bit

    def set_outputs(self, mask: int, value: int) -> None:
        """Change the shadow of the free outputs in ``mask``."""
        for bit, output in enumerate(self._outputs):
            if mask >> bit & 1:
                self.set_pin(output.pin, bool(value >> bit & 1) == output.active_high)

    def entries(self) -> Entries:
        """Write the shadow."""
        return (Entry(CONTROL, self.value),)


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
        table: drive table, one entry a half-step, of any length.
        holding_percent: current at ``IdleLevel.HOLD``; 0 means off.
        levels: level map, a row of ``LEVEL_MAPS``; only used to derive the holding table.
        outputs: free outputs on pins 14, 16 and 17; pin 1 is the strobe.
        motors: 1 to 3.
    """

    setup_cycles = 0
    pulse_cycles = 0
    fall = _NOTHING

    def __init__(
        self,
        table: bytes = MOTRUN,
        holding_percent: int = 0,
        levels: tuple[int, int, int, int] = (100, 60, 20, 0),
        outputs: Sequence[OutputPin] = (),
        motors: int = 3,
    ) -> None:
        self.motors = motors
        self._table = table
        self._holding = holding_table(table, holding_percent, levels)
        self._holds = holding_percent > 0
        self._lines = ControlLines(0, outputs)
        self._index = [0] * motors
        self._directions = [0] * motors
        self._orders = _orders(motors)
        self._order = self._orders[0]
        self._run = self._columns()

    def _latch(self, byte: int) -> Entries:
        control = self._lines.value
        return (
            Entry(DATA, byte),
            Entry(CONTROL, control | STROBE_BIT),
            Entry(CONTROL, control & ~STROBE_BIT),
        )

    def _columns(self) -> list[list[Entries]]:
        """Per motor and index, a whole movement; made anew when an output changes."""
        return [
            [(*self._latch(motor_bits(motor) | byte), Entry(STATUS, motor)) for byte in self._table]
            for motor in range(self.motors)
        ]

    def _stand(self, table: bytes) -> Entries:
        return tuple(
            entry
            for motor, index in enumerate(self._index)
            for entry in self._latch(motor_bits(motor) | table[index])
        )

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Nothing to set up: the direction is the order of the table."""
        self._directions[:] = directions
        self._order = self._orders[leader]
        return _NOTHING

    def tick(self, moving: int) -> Entries:
        """Data, strobe set, strobe clear, reading; for each moving motor."""
        if not moving:
            return _READING
        entries = _NOTHING
        for motor in self._order[moving]:
            column = self._run[motor]
            at = self._index[motor] = (self._index[motor] + self._directions[motor]) % len(column)
            entries = entries + column[at] if entries else column[at]
        return entries

    def signals(self, active: bool, boost: bool) -> Entries:
        """The card has no such lines."""
        return _NOTHING

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Bit 0 is the first configured output."""
        before = self._lines.value
        self._lines.set_outputs(mask, value)
        if self._lines.value == before:
            return _NOTHING
        self._run = self._columns()
        return self._lines.entries()

    def energise(self) -> Entries:
        """Every motor at full current in its present phase."""
        return self._stand(self._table)

    def idle(self, level: IdleLevel) -> Entries:
        """Holding current from the second table, or both phases of every motor off."""
        if level is IdleLevel.HOLD and self._holds:
            return self._stand(self._holding)
        return self._stand(bytes([MOTZERO]) * len(self._table))

    def phases(self) -> tuple[int, ...]:
        """Index into the drive table, per motor."""
        return tuple(self._index)

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up indices that were kept."""
        self._index[:] = [phase % len(self._table) for phase in phases]


class StepDirProfile(NamedTuple):
    """Timing of a step/direction wiring, in cycles."""

    setup_cycles: int
    pulse_cycles: int
    max_rate_hz: int


#: X4Step: clock high and low equally long, never under 25 us, direction 100 us ahead. The paper:
#: at least 0.5 us, direction and clock together; its top speed is 133 kHz.
STEPDIR_PROFILES: Final = {
    "x4step": StepDirProfile(100 * _CYCLES_PER_US, 25 * _CYCLES_PER_US, 20_000),
    "paper": StepDirProfile(0, _CYCLES_PER_US // 2, 133_333),
}


class StepDirCard:
    """Step/direction drives: data bits 2k and 2k+1 are direction and clock of motor k.

    Args:
        profile: a row of ``STEPDIR_PROFILES``.
        clock_idles_high: the clock's resting level.
        forward_high: the direction line's level for positive steps.
        outputs: free outputs on pins 1 and 14; 16 is BOOST, 17 is ACTIVE.
        enable: bit of ``outputs`` that carries the drives' enable, or None. The wiring has no
            enable line of its own; without one the current cannot be switched off here.
        motors: 1 to 4.
    """

    def __init__(
        self,
        profile: StepDirProfile = STEPDIR_PROFILES["x4step"],
        clock_idles_high: bool = False,
        forward_high: bool = True,
        outputs: Sequence[OutputPin] = (),
        enable: int | None = None,
        motors: int = 4,
    ) -> None:
        self.motors = motors
        self.setup_cycles = profile.setup_cycles
        self.pulse_cycles = profile.pulse_cycles
        self._forward = 1 if forward_high else -1
        self._enable = 0 if enable is None else 1 << enable
        # All four control pins low: ACTIVE and BOOST off.
        self._lines = ControlLines(0b1011, outputs)
        clocks = [2 << 2 * motor for motor in range(motors)]
        self._clock_rest = sum(clocks) if clock_idles_high else 0
        self._clocks = [
            sum(clock for motor, clock in enumerate(clocks) if moving >> motor & 1)
            for moving in range(1 << motors)
        ]
        self._count = [0] * motors
        self._directions = [0] * motors
        self._data = self._clock_rest
        self.fall: Entries = _NOTHING
        self._rises: list[Entries] = []
        self._rebuild()

    def _rebuild(self) -> None:
        """The entries of every tick, which depend on the direction bits only."""
        self.fall = (Entry(DATA, self._data),)
        self._rises = [
            (Entry(DATA, self._data ^ clocks), *_READING) if clocks else _READING
            for clocks in self._clocks
        ]

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Direction bits of the motors that will move; the others keep theirs."""
        self._directions[:] = directions
        data = self._data
        for motor, direction in enumerate(directions):
            bit = 1 << 2 * motor
            if direction:
                data = data | bit if direction == self._forward else data & ~bit
        if data == self._data:
            return _NOTHING
        self._data = data
        self._rebuild()
        return self.fall

    def tick(self, moving: int) -> Entries:
        """All clocks of the tick rise in one byte; one reading."""
        for motor, direction in enumerate(self._directions):
            if moving >> motor & 1:
                self._count[motor] += direction
        return self._rises[moving]

    def signals(self, active: bool, boost: bool) -> Entries:
        """ACTIVE while any motor runs, BOOST in ramps."""
        before = self._lines.value
        self._lines.set_pin(ACTIVE_PIN, active)
        self._lines.set_pin(BOOST_PIN, boost)
        return _NOTHING if self._lines.value == before else self._lines.entries()

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Bit 0 is the first configured output."""
        before = self._lines.value
        self._lines.set_outputs(mask, value)
        return _NOTHING if self._lines.value == before else self._lines.entries()

    def energise(self) -> Entries:
        """Enable the drives, where an output is configured for it; else nothing to do."""
        return self.set_outputs(self._enable, self._enable)

    def idle(self, level: IdleLevel) -> Entries:
        """ACTIVE and BOOST low; drives disabled for OFF where an output is configured for it."""
        enabled = self._enable if level is IdleLevel.HOLD else 0
        self._lines.set_pin(ACTIVE_PIN, False)
        self._lines.set_pin(BOOST_PIN, False)
        self._lines.set_outputs(self._enable, enabled)
        return (*self.fall, *self._lines.entries())

    def phases(self) -> tuple[int, ...]:
        """Net pulses; a drive keeps its own phase, so this is for reports only."""
        return tuple(self._count)

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up counts that were kept."""
        self._count[:] = phases
