"""Step/direction drives (X4Step, the paper): all motors in one byte.

    data     ==X(dir)=====X(clocks high)===X(clocks low)==
               |<- setup ->|<---- pulse ---->|
    status                  r

Rule 1: a step counts at the edge away from rest; all clocks of a tick leave it in one write.
Rule 2: direction lines change while the clocks rest, or with the edge where no set-up time is asked
        for; and only those of motors that will move.
Rule 3: inverted clocks and directions are a matter of the byte only.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from fraese.motor.cards.control import NOTHING, READING, ControlLines, OutputPin
from fraese.motor.seams import DATA, Entries, Entry, IdleLevel
from fraese.phrases import phrase

BOOST_PIN: Final = 16
ACTIVE_PIN: Final = 17

_CYCLES_PER_US: Final = 16


class StepDirProfile(NamedTuple):
    """Timing of a step/direction wiring.

    Attributes:
        setup_cycles: from a change of direction to the next edge; 0: both in one write.
        pulse_cycles: shortest pulse, and shortest pause.
        max_rate_hz: of a motor.
        duty: share of its interval for which a clock is away from rest, between 0 and 1.
    """

    setup_cycles: int
    pulse_cycles: int
    max_rate_hz: int
    duty: float = 0.5


#: X4Step: clock high and low equally long, never under 25 us, direction 100 us ahead. The paper:
#: at least 0.5 us, direction and clock in one write; its top speed is 133 kHz.
STEPDIR_PROFILES: Final = {
    "x4step": StepDirProfile(100 * _CYCLES_PER_US, 25 * _CYCLES_PER_US, 20_000),
    "paper": StepDirProfile(0, _CYCLES_PER_US // 2, 133_333),
}


class StepDirCard:
    """Step/direction drives: data bits 2k and 2k+1 are direction and clock of socket k.

    Args:
        profile: a row of ``STEPDIR_PROFILES``.
        clock_idles_high: the clock's resting level.
        forward_high: the direction line's level for positive steps.
        outputs: free outputs on pins 1 and 14; 16 is BOOST, 17 is ACTIVE.
        enable: bit of ``outputs`` that carries the drives' enable, or None. The wiring has no
            enable line of its own; without one the current cannot be switched off here.
        motors: 1 to 4.
        sockets: where each motor is plugged in, 0 to 3; empty: in order.

    Attributes:
        motors: how many.
        sockets: as given.
        lines_of: both data bits of each motor.
        clock_rest: data bits that are 1 while the clocks rest.
        forward_high: as given.
        enable_mask: the output that carries the drives' enable, a bit.
        lines: the control register.
    """

    #: All pulses have the leader's length, so a tick is not divided.
    beat_cycles = 0
    step_word: str = phrase("pulse")

    def __init__(
        self,
        profile: StepDirProfile = STEPDIR_PROFILES["x4step"],
        clock_idles_high: bool = False,
        forward_high: bool = True,
        outputs: Sequence[OutputPin] = (),
        enable: int | None = None,
        motors: int = 4,
        sockets: Sequence[int] = (),
    ) -> None:
        self.sockets = tuple(sockets) or tuple(range(motors))
        self.motors = motors = len(self.sockets)
        self.setup_cycles = profile.setup_cycles
        self.pulse_cycles = profile.pulse_cycles
        self.duty_q16 = round(profile.duty * 0x10000)
        self.forward_high = forward_high
        self._forward = 1 if forward_high else -1
        self.enable_mask = 0 if enable is None else 1 << enable
        # All four control pins low: ACTIVE and BOOST off.
        self.lines = ControlLines(0b1011, outputs)
        self.lines_of = tuple(3 << 2 * socket for socket in self.sockets)
        clocks = [2 << 2 * socket for socket in self.sockets]
        self.clock_rest = sum(clocks) if clock_idles_high else 0
        self._clocks = [
            sum(clock for motor, clock in enumerate(clocks) if moving >> motor & 1)
            for moving in range(1 << motors)
        ]
        self._count = [0] * motors
        self._directions = [0] * motors
        self._data = self.clock_rest
        self.fall: Entries = NOTHING
        self._rises: list[Entries] = []
        self._rebuild()

    def _rebuild(self) -> None:
        """The entries of every tick, which depend on the direction bits only."""
        self.fall = (Entry(DATA, self._data),)
        self._rises = [
            (Entry(DATA, self._data ^ clocks), *READING) if clocks else READING
            for clocks in self._clocks
        ]

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Direction bits of the motors that will move; the others keep theirs."""
        self._directions[:] = directions
        data = self._data
        for socket, direction in zip(self.sockets, directions, strict=True):
            bit = 1 << 2 * socket
            if direction:
                data = data | bit if direction == self._forward else data & ~bit
        if data == self._data:
            return NOTHING
        self._data = data
        self._rebuild()
        # Without a set-up time they change with the first edge.
        return self.fall if self.setup_cycles else NOTHING

    def tick(self, moving: int) -> Entries:
        """All clocks of the tick rise in one byte; one reading."""
        return self._rises[moving]

    def stepped(self, moving: int) -> None:
        """The counts follow."""
        for motor, direction in enumerate(self._directions):
            if moving >> motor & 1:
                self._count[motor] += direction

    def signals(self, active: bool, boost: bool) -> Entries:
        """ACTIVE while any motor runs, BOOST in ramps."""
        before = self.lines.value
        self.lines.set_pin(ACTIVE_PIN, active)
        self.lines.set_pin(BOOST_PIN, boost)
        return NOTHING if self.lines.value == before else self.lines.entries()

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Bit 0 is the first configured output."""
        before = self.lines.value
        self.lines.set_outputs(mask, value)
        return NOTHING if self.lines.value == before else self.lines.entries()

    def energise(self) -> Entries:
        """Enable the drives, where an output is configured for it; else nothing to do."""
        return self.set_outputs(self.enable_mask, self.enable_mask)

    def idle(self, level: IdleLevel) -> Entries:
        """ACTIVE and BOOST low; drives disabled for OFF where an output is configured for it."""
        enabled = self.enable_mask if level is IdleLevel.HOLD else 0
        self.lines.set_pin(ACTIVE_PIN, False)
        self.lines.set_pin(BOOST_PIN, False)
        self.lines.set_outputs(self.enable_mask, enabled)
        return (*self.fall, *self.lines.entries())

    def phases(self) -> tuple[int, ...]:
        """Net pulses; a drive keeps its own phase, so this is for reports only."""
        return tuple(self._count)

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up counts that were kept."""
        self._count[:] = phases
