"""The lines of step/direction drives: what the X4Step manual promises, over random moves."""

import math
from itertools import pairwise

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from fraese.blocks import Block, Piece, accel_q_from_hz_s, dwell, rate_q8_from_hz
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard, StepDirProfile
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.null import NullPort
from fraese.motor.ports.recorder import Recorder
from fraese.motor.seams import Ended, Report, SwitchMode
from fraese.planner.ramps import interval_q8, trapezoid
from tests.motor.waves import CYCLE_NS, Waves

TWO_CYCLES_NS = 125
SHORTEST_NS = 25_000
LEAD_NS = 100_000
X4STEP = STEPDIR_PROFILES["x4step"]

#: Runs of seconds of virtual time take their time: what fails is shown as it was found.
_AS_FOUND = settings(phases=[Phase.explicit, Phase.generate])


class Drives:
    """Four motors on a core, and what was written."""

    def __init__(self, profile: StepDirProfile = X4STEP) -> None:
        self.clock = VirtualClock()
        self.port = Recorder(NullPort(), self.clock)
        self.core = MotorCore(self.port, StepDirCard(profile), self.clock, settle_s=0)
        self.core.set_switch_mode(SwitchMode.IGNORE)

    def run(self, *blocks: Block) -> Report:
        for block in blocks:
            assert self.core.push(block)
        report = self.core.poll(1000)
        while report.running:
            report = self.core.poll(1000)
        return report

    def wait(self) -> None:
        self.clock.wait_until(self.clock.now_ns() + 1_000_000)

    def waves(self) -> Waves:
        return Waves(self.port.accesses)


def path(*steps: int, rate_hz: float, ramp_ms: float) -> Block:
    """A path as X4Step drives it: from rest to rest, its longest axis at that rate."""
    ticks = max(map(abs, steps))
    if ramp_ms:
        acceleration = 1000 * rate_hz / ramp_ms
        law = tuple(trapezoid(ticks, 0, rate_hz, 0, acceleration))
        # A step from rest, as the law begins.
        jump_hz = math.sqrt(acceleration / 2)
    else:
        law = (Piece(ticks, interval_q8(rate_hz)),)
        acceleration, jump_hz = 1e6, rate_hz
    return Block(
        (*steps, *[0] * (4 - len(steps))),
        law,
        accel_q_from_hz_s(acceleration),
        rate_q8_from_hz(jump_hz),
        weight=1,
    )


@st.composite
def paths(draw: st.DrawFn, rates_hz: tuple[int, int] = (10, 20_000)) -> Block:
    rate_hz = draw(st.integers(*rates_hz))
    ramp_ms = draw(st.sampled_from([0, 1, 1]) | st.integers(0, min(1000, rate_hz)))
    most = draw(st.sampled_from([1, 2, 4, 7, 30, 120, 300]))
    steps = [draw(st.integers(-most, most)) for _ in range(4)]
    steps[draw(st.integers(0, 3))] = most
    return path(*steps, rate_hz=rate_hz, ramp_ms=ramp_ms)


def assert_pulses(waves: Waves, braked_ns: int = -1) -> None:
    """What holds for every run, however it was driven; and braked, if it was, at some moment."""
    together = {stretch for clock in waves.clocks for stretch in clock.stretches()}
    times = sorted(together)
    assert all(after[0] > before[1] for before, after in pairwise(times))
    assert waves.shortest_ns() >= SHORTEST_NS
    assert waves.lead_ns() >= LEAD_NS
    for clock in waves.clocks:
        assert not clock.blips
    assert {*waves.active.blips, *waves.boost.blips} <= {braked_ns}


def assert_symmetric(waves: Waves) -> None:
    """Every pulse is as long as the pause before it."""
    pulses = [fall - rise for rise, fall in waves.pulses()]
    for pause, pulse in zip(waves.pauses_ns(), pulses[1:], strict=True):
        assert abs(pause - pulse) <= TWO_CYCLES_NS


class TestOnePath:
    @_AS_FOUND
    @given(paths())
    def test_pause_and_pulse_are_equal(self, block: Block) -> None:
        drives = Drives()
        report = drives.run(block)
        waves = drives.waves()
        assert_pulses(waves)
        assert_symmetric(waves)
        assert report.position_steps == block.steps == waves.steps()

    @_AS_FOUND
    @given(paths())
    def test_the_plan_is_played_to_the_cycle(self, block: Block) -> None:
        """From fall to fall; the first tick comes from rest."""
        drives = Drives()
        drives.run(block)
        falls = [fall for _, fall in drives.waves().pulses()]
        planned = [
            max(800, piece.interval_q8 + n * piece.add_q8 >> 8)
            for piece in block.pieces
            for n in range(piece.ticks)
        ]
        for (before, after), cycles in zip(pairwise(falls), planned[1:], strict=True):
            assert abs(after - before - cycles * CYCLE_NS) < CYCLE_NS

    @_AS_FOUND
    @given(paths())
    def test_active_from_the_directions_to_the_last_fall(self, block: Block) -> None:
        drives = Drives()
        start_ns = drives.clock.now_ns()
        drives.run(block)
        waves = drives.waves()
        rise, _ = waves.pulses()[0]
        _, fall = waves.pulses()[-1]
        assert waves.active.stretches() == [(start_ns, fall)]
        assert rise - start_ns == LEAD_NS

    @_AS_FOUND
    @given(paths())
    def test_boost_in_the_ramps_and_only_there(self, block: Block) -> None:
        """High in every interval that is longer than the shortest, once up and once down."""
        drives = Drives()
        drives.run(block)
        waves = drives.waves()
        stretches, pulses = waves.boost.stretches(), waves.pulses()
        assert len(stretches) <= 2
        shortest = min(p.interval_q8 for p in block.pieces if not p.add_q8) >> 8
        edges = [start for start, _ in waves.active.stretches()] + [fall for _, fall in pulses]
        assert {at for stretch in stretches for at in stretch} <= set(edges)
        cycles = [
            piece.interval_q8 + n * piece.add_q8 >> 8
            for piece in block.pieces
            for n in range(piece.ticks)
        ]
        for at_ns, interval in zip(edges, cycles, strict=False):
            if interval > shortest + 1:
                assert waves.boost.at(at_ns)
        level = max((p for p in block.pieces if not p.add_q8), key=lambda p: p.ticks)
        before = block.pieces.index(level)
        first = sum(piece.ticks for piece in block.pieces[:before])
        if level.ticks > 1 or len(block.pieces) == 1:
            for at_ns in edges[first : first + level.ticks]:
                assert not waves.boost.at(at_ns)

    def test_a_thousand_steps_at_a_thousand(self) -> None:
        """The figures by which the rise in the middle was chosen."""
        drives = Drives()
        drives.run(path(1000, rate_hz=1000, ramp_ms=50))
        pulses = drives.waves().pulses()
        halves = [fall - rise for rise, fall in pulses]
        assert halves[0] == pytest.approx(5_000_000, rel=0.01)
        planned_ns = pulses[-1][1] - pulses[0][0] + halves[0]
        assert planned_ns == pytest.approx(1_050_000_000, rel=0.000_3)
        for up, down in zip(halves, reversed(halves), strict=True):
            assert abs(up - down) <= CYCLE_NS
        (up_ns, level_ns), (down_ns, rest_ns) = drives.waves().boost.stretches()
        assert rest_ns - down_ns == pytest.approx(50_000_000, rel=0.05)
        assert level_ns - up_ns == pytest.approx(45_000_000, rel=0.05)


class TestBrakeAndStop:
    @_AS_FOUND
    @given(block=paths(), part=st.floats(0, 1.1))
    def test_a_brake_at_any_time(self, block: Block, part: float) -> None:
        """Edges are counted, whole and symmetric; intervals only grow from there on."""
        drives = Drives()
        assert drives.core.push(block)
        drives.core.poll(block.duration_cycles() / 16e6 * part)
        braked_ns = drives.clock.now_ns()
        drives.core.brake()
        report = drives.run()
        waves = drives.waves()
        assert_pulses(waves, braked_ns)
        assert_symmetric(waves)
        assert report.position_steps == waves.steps()
        late = [fall for _, fall in waves.pulses() if fall > braked_ns]
        periods = [after - before for before, after in pairwise(late)][1:]
        assert all(after >= before - CYCLE_NS for before, after in pairwise(periods))
        assert not waves.active.high
        assert not waves.boost.high
        assert len(waves.boost.stretches()) <= 2

    @_AS_FOUND
    @given(block=paths(), part=st.floats(0, 1.1))
    def test_a_stop_at_any_time(self, block: Block, part: float) -> None:
        """No edge after the pulse in hand, and that is whole."""
        drives = Drives()
        assert drives.core.push(block)
        drives.core.poll(block.duration_cycles() / 16e6 * part)
        stopped_ns = drives.clock.now_ns()
        drives.core.stop()
        report = drives.run()
        waves = drives.waves()
        assert report.position_steps == waves.steps()
        pulses = waves.pulses()
        assert all(rise <= stopped_ns for rise, _ in pulses)
        if pulses:
            assert_pulses(waves, stopped_ns)
            assert_symmetric(waves)
            assert waves.active.stretches()[-1][1] == max(pulses[-1][1], stopped_ns)

    @_AS_FOUND
    @given(block=paths(rates_hz=(200, 20_000)), part=st.floats(0.01, 1.0))
    def test_brake_and_resume_make_the_same_edges(self, block: Block, part: float) -> None:
        drives = Drives()
        assert drives.core.push(block)
        drives.core.poll(block.duration_cycles() / 16e6 * part)
        braked_ns = drives.clock.now_ns()
        drives.core.brake()
        drives.run()
        drives.wait()
        drives.core.resume()
        report = drives.run()
        waves = drives.waves()
        assert_pulses(waves, braked_ns)
        assert report.position_steps == block.steps == waves.steps()

    @_AS_FOUND
    @given(block=paths(), after=paths(), part=st.floats(0, 1.1))
    def test_after_a_brake_and_a_flush_the_next_path_moves(
        self, block: Block, after: Block, part: float
    ) -> None:
        """Also when the brake came within the path's own braking, or after its end."""
        drives = Drives()
        assert drives.core.push(block)
        drives.core.poll(block.duration_cycles() / 16e6 * part)
        braked_ns = drives.clock.now_ns()
        drives.core.brake()
        made = drives.run().position_steps
        drives.core.flush()
        drives.wait()
        report = drives.run(after)
        assert report.ended is Ended.TARGET
        moved = tuple(b - a for a, b in zip(made, report.position_steps, strict=True))
        assert moved == after.steps
        assert_pulses(drives.waves(), braked_ns)
        assert report.position_steps == drives.waves().steps()


class TestSeams:
    @_AS_FOUND
    @given(st.lists(paths(rates_hz=(100, 20_000)), min_size=2, max_size=5))
    def test_one_path_after_the_other(self, blocks: list[Block]) -> None:
        """No pulse and no pause is cut short, directions stand, nobody is driven too fast."""
        drives = Drives()
        report = drives.run(*blocks)
        waves = drives.waves()
        assert_pulses(waves)
        assert report.position_steps == waves.steps()
        assert len(waves.active.stretches()) == 1

    @_AS_FOUND
    @given(first=paths(), then=paths(), pause_s=st.sampled_from([0.0, 0.000_2, 0.01, 2.0]))
    def test_from_one_run_to_the_next(self, first: Block, then: Block, pause_s: float) -> None:
        """The lead is the directions' time, or what is left of the pause of an interval."""
        drives = Drives()
        drives.run(first)
        _, fall = drives.waves().pulses()[-1]
        drives.clock.wait_until(drives.clock.now_ns() + round(pause_s * 1e9))
        start_ns = drives.clock.now_ns()
        drives.run(then)
        waves = drives.waves()
        assert_pulses(waves, start_ns)
        rise = min(rise for wave in waves.clocks for rise, _ in wave.stretches() if rise > fall)
        pause_ns = max(800, then.pieces[0].interval_q8 >> 8) * CYCLE_NS / 2
        wanted = max(start_ns + LEAD_NS, fall + pause_ns)
        assert abs(rise - wanted) <= 2 * CYCLE_NS

    @_AS_FOUND
    @given(first=paths(), then=paths(), wait_s=st.sampled_from([0.0, 0.000_3, 0.013]))
    def test_over_a_dwell(self, first: Block, then: Block, wait_s: float) -> None:
        drives = Drives()
        report = drives.run(first, dwell(4, wait_s), then)
        waves = drives.waves()
        assert_pulses(waves)
        assert report.position_steps == waves.steps()
        assert len(waves.active.stretches()) == 1


class TestDuty:
    #: The two delays of the paper: 0x30 and 2 x 0x0310 loops.
    PAPER = STEPDIR_PROFILES["paper"]._replace(duty=0x30 / (0x30 + 2 * 0x0310))

    @_AS_FOUND
    @given(
        rate_hz=st.integers(20, 100_000),
        duty=st.floats(0.01, 0.99),
        steps=st.tuples(st.integers(1, 60), st.integers(-60, 60)),
    )
    def test_any_share(self, rate_hz: int, duty: float, steps: tuple[int, int]) -> None:
        """Pulse and pause to a cycle, but neither below the shortest pulse."""
        drives = Drives(STEPDIR_PROFILES["paper"]._replace(duty=duty))
        block = path(*steps, rate_hz=rate_hz, ramp_ms=0)
        drives.run(block)
        waves = drives.waves()
        cycles = block.pieces[0].interval_q8 >> 8
        wanted = min(max(8, cycles * duty), cycles - 8)
        assert waves.steps() == block.steps
        for rise, fall in waves.pulses():
            assert abs((fall - rise) / CYCLE_NS - wanted) <= 1 + cycles / 65536
        for (_, fall), (_, after) in pairwise(waves.pulses()):
            assert abs((after - fall) / CYCLE_NS - cycles) < 1

    def test_the_papers_delays(self) -> None:
        """48 to 1568: at 10 kHz a pulse of 3 us."""
        drives = Drives(self.PAPER)
        drives.run(path(100, rate_hz=10_000, ramp_ms=0))
        waves = drives.waves()
        assert {fall - rise for rise, fall in waves.pulses()} <= {2937, 2938}
        assert waves.pulses()[1][0] - waves.pulses()[0][1] == pytest.approx(97_062, abs=1)

    def test_direction_and_clock_in_one_write(self) -> None:
        """MOTOR.ASM: 0B, 01, ..., one motor forward, one back."""
        drives = Drives(self.PAPER)
        drives.port.accesses.clear()
        drives.run(path(3, -3, rate_hz=10_000, ramp_ms=0))
        data = [access.value for access in drives.port.accesses if access.register == 0]
        assert data == [0x0B, 0x01] * 3
