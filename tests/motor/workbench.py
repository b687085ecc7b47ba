"""A bench to try the motor world on: a simulated mill, a card, a clock and the core.

Tests speak the machine's language: run a block, look where the carriage is, press a switch.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

from fraese.blocks import (
    CYCLES_PER_S,
    Block,
    Outputs,
    Piece,
    Watch,
    accel_q_from_hz_s,
    rate_q8_from_hz,
)
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import Electronics, SmcElectronics, StepDirElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.phases import LEVEL_MAPS, MOTRUN
from fraese.motor.ports.recorder import Access, Recorder
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import CONTROL, DATA, Card, Clock, End, Report, SwitchMode
from fraese.motor.switches import SwitchInput
from fraese.planner.ramps import trapezoid

AXES: Final = "xyz"
TRAVEL_STEPS: Final = 20_000
MOTORS: Final = 3

#: Limits of the blocks below; the simulated motors' own are a little wider.
JUMP_HZ: Final = 1000.0
MAX_HZ: Final = 5000.0
ACCELERATION_HZ_S: Final = 40_000.0

#: A rotor that follows anything: for tests of what is written, not of what can follow.
TIRELESS: Final = RotorLimits(1e9, 1e9, 1e12)

#: Two free outputs that both kinds of card have, on the first pins that are free there.
SMC_OUTPUTS: Final = (OutputPin(14), OutputPin(17))
STEPDIR_OUTPUTS: Final = (OutputPin(1), OutputPin(14))


def end(name: str) -> End:
    """``end("x+")`` is the upper end of the first motor."""
    return End(AXES.index(name[0]), 1 if name[1] == "+" else -1)


def ends(*names: str) -> frozenset[End]:
    return frozenset(end(name) for name in names)


EVERY_END: Final = ends("x-", "x+", "y-", "y+", "z-", "z+")


def steady(
    *steps: int,
    rate_hz: float = JUMP_HZ,
    jump_hz: float = JUMP_HZ,
    ends_at_rest: bool = True,
    watch: Watch | None = None,
    outputs: Outputs | None = None,
    tag: int = 0,
) -> Block:
    """A line at one rate; missing motors stand."""
    ticks = max(abs(n) for n in steps)
    law = (Piece(ticks, round(CYCLES_PER_S * 256 / rate_hz)),)
    return _block(steps, law, jump_hz, ends_at_rest, watch, outputs, tag)


def line(
    *steps: int,
    rate_hz: float = MAX_HZ,
    entry_hz: float = JUMP_HZ,
    exit_hz: float = JUMP_HZ,
    watch: Watch | None = None,
    outputs: Outputs | None = None,
    tag: int = 0,
) -> Block:
    """A line with its ramps, within the limits of the bench."""
    ticks = max(abs(n) for n in steps)
    law = trapezoid(ticks, entry_hz, rate_hz, exit_hz, ACCELERATION_HZ_S)
    return _block(steps, tuple(law), JUMP_HZ, exit_hz <= JUMP_HZ, watch, outputs, tag)


def _block(
    steps: Sequence[int],
    law: tuple[Piece, ...],
    jump_hz: float,
    ends_at_rest: bool,
    watch: Watch | None,
    outputs: Outputs | None,
    tag: int,
) -> Block:
    return Block(
        steps=(*steps, *[0] * (MOTORS - len(steps))),
        pieces=law,
        accel_q=accel_q_from_hz_s(ACCELERATION_HZ_S),
        jump_rate_q8=rate_q8_from_hz(jump_hz),
        weight=1000,
        ends_at_rest=ends_at_rest,
        watch=watch,
        outputs=outputs,
        tag=tag,
    )


class BusyClock(VirtualClock):
    """A clock whose owner is away now and then: some waits return late."""

    def __init__(self, late_ns: Callable[[int], int]) -> None:
        super().__init__()
        self._late_ns = late_ns
        self._waits = 0

    def wait_until(self, deadline_ns: int) -> int:
        """Return at the deadline, or as much later as the plan for this wait says."""
        if deadline_ns > self.now_ns():
            self._waits += 1
            deadline_ns += self._late_ns(self._waits)
        return super().wait_until(deadline_ns)


@dataclass
class Workbench:
    """Everything put together. Distances are steps since the bench was built.

    Attributes:
        wiring: "smc", "x4step" or "paper".
        outputs: the card has two free outputs.
    """

    wiring: str = "smc"
    limits: RotorLimits = field(default_factory=RotorLimits)
    readings: int = 3
    lag_s: float = 0.0
    bounce_readings: int = 0
    settle_s: float = 0.02
    capacity: int = 256
    safe_outputs: int = 0
    table: bytes = MOTRUN
    outputs: bool = False
    #: From a switch to the mechanical end behind it.
    overrun_steps: int = 400
    travel_steps: int = TRAVEL_STEPS
    #: Where the motors are plugged in, in motor order.
    sockets: tuple[int, ...] = tuple(range(MOTORS))
    #: Of the electronics, in one electrical turn.
    steps_in_turn: int = 8
    clock: Clock = field(default_factory=VirtualClock)

    def __post_init__(self) -> None:
        self.mill = Mill(
            [
                Slide(
                    self.travel_steps,
                    self.limits,
                    self.overrun_steps,
                    steps_in_turn=self.steps_in_turn,
                )
            ]
            * len(self.sockets),
            lag_s=self.lag_s,
            bounce_readings=self.bounce_readings,
        )
        self.electronics, self.card = self._electronics_and_card()
        self.simulated = SimulatedMill(self.mill, self.electronics, self.clock)
        self.port = Recorder(self.simulated, self.clock)
        self.core = MotorCore(
            self.port,
            self.card,
            self.clock,
            SwitchInput(readings=self.readings),
            settle_s=self.settle_s,
            capacity=self.capacity,
            safe_outputs=self.safe_outputs,
        )
        self._home = self.mill.carriages_steps()

    def _electronics_and_card(self) -> tuple[Electronics, Card]:
        if self.wiring == "smc":
            return (
                SmcElectronics(self.mill, self.clock, LEVEL_MAPS["field"], sockets=self.sockets),
                SmcCard(
                    self.table,
                    outputs=SMC_OUTPUTS if self.outputs else (),
                    sockets=self.sockets,
                ),
            )
        return (
            StepDirElectronics(self.mill, self.clock, sockets=self.sockets),
            StepDirCard(
                STEPDIR_PROFILES[self.wiring],
                outputs=STEPDIR_OUTPUTS if self.outputs else (),
                sockets=self.sockets,
            ),
        )

    # --- working ---------------------------------------------------------------------------------

    def push(self, *blocks: Block) -> "Workbench":
        for block in blocks:
            assert self.core.push(block)
        return self

    def run(self, *blocks: Block, budget_s: float = 1.0) -> Report:
        """Push, then play until the motors stand."""
        self.push(*blocks)
        report = self.core.poll(budget_s)
        while report.running:
            report = self.core.poll(budget_s)
        return report

    def run_for(self, seconds: float, *blocks: Block) -> Report:
        self.push(*blocks)
        return self.core.poll(seconds)

    def run_until_tick(self, tick: int, *blocks: Block) -> Report:
        """Play until so many ticks of the present block are done, or the motors stand."""
        self.push(*blocks)
        report = self.core.poll(1e-6)
        while report.running and report.tick < tick:
            report = self.core.poll(20e-6)
        return report

    def wait(self, seconds: float = 1.0) -> "Workbench":
        """Let time pass at standstill."""
        self.clock.wait_until(self.clock.now_ns() + round(seconds * 1e9))
        return self

    def report(self) -> Report:
        return self.core.poll(0)

    def ignore_switches(self) -> "Workbench":
        self.core.set_switch_mode(SwitchMode.IGNORE)
        return self

    # --- looking ---------------------------------------------------------------------------------

    def carriage(self, axis: str) -> float:
        """How far a carriage has come since the bench was built."""
        motor = AXES.index(axis)
        return self.simulated.look().carriages_steps[motor] - self._home[motor]

    def carriages(self) -> tuple[float, ...]:
        now = self.simulated.look().carriages_steps
        return tuple(at - home for at, home in zip(now, self._home, strict=True))

    def lost(self) -> tuple[float, ...]:
        return self.simulated.look().lost_steps

    def currents(self) -> list[tuple[float, float]]:
        """What a clamp meter shows on every motor's coils."""
        return [(*pair,) for pair in self.simulated.look().currents]

    def place(self, axis: str, from_low_steps: float) -> "Workbench":
        """Put a carriage so far from its lower switch; distances count from there."""
        self.mill.place(AXES.index(axis), from_low_steps, self.clock.now_ns())
        self._home = self.mill.carriages_steps()
        return self

    def outputs_on(self) -> set[int]:
        """Free outputs whose pins are high; both are on inverted pins of the control register."""
        written = [a.value for a in self.accesses() if a.register == CONTROL]
        bits = (0b0010, 0b1000) if self.wiring == "smc" else (0b0001, 0b0010)
        return {number for number, bit in enumerate(bits) if not written[-1] & bit}

    # --- the wire --------------------------------------------------------------------------------

    def mark(self) -> int:
        """A place in the record to compare from."""
        return len(self.port.accesses)

    def accesses(self, since: int = 0) -> list[Access]:
        return self.port.accesses[since:]

    def writes(self, since: int = 0) -> list[tuple[int, int]]:
        return [
            (a.register, a.value) for a in self.accesses(since) if a.register in (DATA, CONTROL)
        ]

    def data_writes(self, since: int = 0) -> list[int]:
        return [a.value for a in self.accesses(since) if a.register == DATA]

    def edges_ns(self, motor: int = 0, since: int = 0) -> tuple[list[int], list[int]]:
        """Times of the rising and of the falling edges of a clock line (step/direction)."""
        clock, before = 2 << 2 * motor, 0
        rising: list[int] = []
        falling: list[int] = []
        for access in self.accesses(since):
            if access.register == DATA:
                if access.value & clock and not before & clock:
                    rising.append(access.at_ns)
                elif before & clock and not access.value & clock:
                    falling.append(access.at_ns)
                before = access.value
        return rising, falling
