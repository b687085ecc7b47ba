"""How late the steps are on this machine: the real child, the real core, a port that leads nowhere.

Rule 1: what is measured is what drives metal, up to the last call before the port. A real port adds
        about 1.2 us of bus time per access.
Rule 2: lateness is measured at the leader's edge, against the deadline that the core waited for.
        The core moves all that follows a tick that is late by more than a quarter of its interval;
        so one long delay is one late tick, not many.
"""

import contextlib
import subprocess
import sys
from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from fraese.blocks import CYCLES_PER_S, Q8, Block, Piece, accel_q_from_hz_s, rate_q8_from_hz
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import Meter, RealtimeOptions, Setup
from fraese.motor.seams import CONTROL, DATA, Card

#: Clock lines of step/direction drives, strobe of a phase card; else whatever is written.
_CLOCKS: Final = (DATA, 0xAA)
_STROBE: Final = (CONTROL, 0x01)
_BYTE: Final = (DATA, 0xFF)
#: Percentiles that are told, per cent.
PERCENTILES: Final = (50.0, 99.0, 99.9, 100.0)
_POLL_S: Final = 0.02
_LEAD_S: Final = 1.0
_ROOM: Final = 1.1
#: So much of a rate must be played where it is said to hold.
_AS_WANTED: Final = 0.98


@dataclass(frozen=True, slots=True)
class Duty:
    """What the step loop has to do.

    Attributes:
        card: what is on the port.
        rate_hz: ticks a second.
        motors: how many step on every tick.
        block_ticks: length of the blocks that are fed.
        options: how the child gets its time; ``top_rate_hz`` is taken from ``rate_hz``.
    """

    card: Card
    rate_hz: float
    motors: int
    block_ticks: int = 2000
    options: RealtimeOptions = field(default_factory=RealtimeOptions)

    @property
    def interval_us(self) -> float:
        """Between two ticks."""
        return 1e6 / self.rate_hz

    def block(self) -> Block:
        """A line at that rate, on which all motors step on every tick."""
        steps = [self.block_ticks] * self.motors + [0] * (self.card.motors - self.motors)
        return Block(
            steps=tuple(steps),
            pieces=(Piece(self.block_ticks, round(CYCLES_PER_S * Q8 / self.rate_hz)),),
            accel_q=accel_q_from_hz_s(40_000),
            jump_rate_q8=rate_q8_from_hz(self.rate_hz),
            weight=1000,
        )


def smc_duty(rate_hz: float = 5000.0, motors: int = 3) -> Duty:
    """Phase cards: at 5 kHz on three axes nine writes and three readings every 200 us."""
    return Duty(SmcCard(), rate_hz, motors)


def stepdir_duty(profile: str, rate_hz: float = 0.0, motors: int = 4) -> Duty:
    """Step/direction drives of a profile, at its highest rate if none is given."""
    card = StepDirCard(STEPDIR_PROFILES[profile])
    return Duty(card, rate_hz or STEPDIR_PROFILES[profile].max_rate_hz, motors)


@dataclass(frozen=True, slots=True)
class Lateness:
    """What came out.

    Attributes:
        duty: what was to be done.
        late_us: how late each edge was.
        played_hz: ticks a second as they were really made, all delays included.
        late_ticks: edges, falling ones too, late by more than a quarter of their interval.
        dry_queues: how often blocks came too late.
        notes: what the system granted and refused the child.
    """

    duty: Duty
    late_us: npt.NDArray[np.float64]
    played_hz: float
    late_ticks: int
    dry_queues: int
    notes: tuple[str, ...]

    def percentiles_us(self) -> tuple[float, ...]:
        """Median, p99, p99.9 and the longest."""
        if not len(self.late_us):
            return (0.0,) * len(PERCENTILES)
        return tuple(float(value) for value in np.percentile(self.late_us, PERCENTILES))

    def late_edges(self) -> int:
        """Leader's edges that were late by more than a quarter of the interval."""
        return int(np.count_nonzero(self.late_us > self.duty.interval_us / 4))

    def histogram(self, edges_us: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """How many edges were how late: counts between neighbours of ``edges_us``."""
        return np.histogram(self.late_us, edges_us)[0].astype(np.int64)


def edge_of(card: Card) -> tuple[int, int]:
    """By which access a step is known: its register, and the bits of which one is set."""
    if card.fall:
        return _CLOCKS
    tried = deepcopy(card)
    tried.begin([1] * card.motors, 0)
    has_strobe = any(
        register == CONTROL and value & _STROBE[1] for register, value in tried.tick(1)
    )
    return _STROBE if has_strobe else _BYTE


def measure(duty: Duty, seconds: float) -> Lateness:
    """Run the step loop for so long.

    Raises:
        PortError: if the child does not start, or dies.
    """
    ticks = max(2, round(duty.rate_hz * seconds))
    # At a low rate one long block would take longer than that.
    duty = replace(duty, block_ticks=min(duty.block_ticks, ticks))
    meter = Meter(*edge_of(duty.card), round(ticks * _ROOM) + 1)
    options = duty.options
    setup = Setup(
        NullPort,
        duty.card,
        options=RealtimeOptions(duty.rate_hz, options.core, options.silent_s, options.pump),
        settle_s=0.05,
        meter=meter,
    )
    driver = RealtimeDriver(setup)
    try:
        late_ticks, dry_queues = _play(driver, duty, ticks)
        late_ns, span_s = driver.samples()
    finally:
        driver.close()
    late_us = np.frombuffer(late_ns, dtype=np.uint32) / 1000.0
    played_hz = (len(late_us) - 1) / span_s if span_s else 0.0
    return Lateness(duty, late_us, played_hz, late_ticks, dry_queues, driver.notes)


@dataclass(frozen=True, slots=True)
class Rung:
    """One rate that was tried.

    Attributes:
        rate_hz: ticks a second that were wanted.
        p999_us: 999 of 1000 edges were less late than this.
        played_hz: ticks a second that were made.
    """

    rate_hz: float
    p999_us: float
    played_hz: float

    @property
    def holds(self) -> bool:
        """999 of 1000 edges are late by less than a quarter of the interval, and none is missing.

        A loop that is too slow shifts all that follows: it is not late, it plays more slowly.
        """
        quarter_us = 1e6 / self.rate_hz / 4
        return self.p999_us < quarter_us and self.played_hz > _AS_WANTED * self.rate_hz


def ladder(duty: Duty, seconds: float, rates_hz: Sequence[float]) -> list[Rung]:
    """Try some rates from the lowest up, until one does not hold, twice in a row.

    Twice, since one long delay by somebody else says nothing about the rate.

    Args:
        duty: what has to be done.
        seconds: at each rate.
        rates_hz: ascending.

    Returns:
        What came of each that was tried; all but the last hold, or all.
    """
    rungs = []
    for rate_hz in rates_hz:
        tried = _rung(duty, seconds, rate_hz)
        if not tried.holds:
            tried = _rung(duty, seconds, rate_hz)
        rungs.append(tried)
        if not tried.holds:
            break
    return rungs


def highest_rate_hz(rungs: Sequence[Rung]) -> float:
    """The highest rate of a ladder that holds; 0: not even the lowest."""
    return max((rung.rate_hz for rung in rungs if rung.holds), default=0.0)


def _rung(duty: Duty, seconds: float, rate_hz: float) -> Rung:
    result = measure(replace(duty, rate_hz=rate_hz), seconds)
    return Rung(rate_hz, result.percentiles_us()[2], result.played_hz)


def _play(driver: RealtimeDriver, duty: Duty, ticks: int) -> tuple[int, int]:
    """Feed blocks until so many ticks are played."""
    block = duty.block()
    blocks = max(1, round(ticks / duty.block_ticks))
    lead = max(4, round(_LEAD_S * duty.rate_hz / duty.block_ticks))
    pushed = 0
    while True:
        report = driver.poll(_POLL_S if pushed else 0)
        while pushed < blocks and report.queued + 1 < lead and driver.push(block):
            pushed += 1
            report = driver.poll(0)
        if pushed >= blocks and not report.running:
            return report.late_ticks, report.dry_queues


@contextlib.contextmanager
def hogs(number: int) -> Iterator[tuple[int, ...]]:
    """So many processes beside it that do nothing but compute; gives their numbers."""
    command = [sys.executable, "-S", "-c", "while True: pass"]
    processes = [subprocess.Popen(command) for _ in range(number)]
    try:
        yield tuple(process.pid for process in processes)
    finally:
        for process in processes:
            process.kill()
            process.wait()
