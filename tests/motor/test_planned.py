"""A waveform from the planned blocks, beside what the core that played them wrote itself."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.meaning import Meaning
from fraese.motor.planned import PlannedDriver, PlannedTrace, begun
from fraese.motor.ports.null import NullPort
from fraese.motor.ports.traced import TracedPort
from fraese.motor.seams import Card, IdleLevel, Report
from fraese.motor.waveform import Waveform
from tests.cli.test_trace_option import Wave
from tests.motor.workbench import JUMP_HZ, MOTORS, line, steady

CARDS: dict[str, Callable[[], Card]] = {
    "stepdir": lambda: StepDirCard(motors=MOTORS),
    "smc1500": lambda: SmcCard(motors=MOTORS),
}


class Pair:
    """A core with a waveform of its own, driven through one that is drawn from its blocks."""

    def __init__(self, folder: Path, card: str = "stepdir") -> None:
        self.paths = folder / "real.vcd", folder / "planned.vcd"
        self.clock = VirtualClock()
        meaning = Meaning({})
        self._real, planned = (Waveform(path, "port", meaning) for path in self.paths)
        port = TracedPort(NullPort(), self.clock.now_ns, self._real.note)
        core = MotorCore(port, CARDS[card](), self.clock)
        self._trace = PlannedTrace(planned, CARDS[card](), self.clock, 0.02, 0)
        self.driver: PlannedDriver = self._trace.on(core)

    def play(self) -> Report:
        report = self.driver.poll(0.05)
        while report.running:
            report = self.driver.poll(0.05)
        return report

    def waves(self) -> tuple[Wave, Wave]:
        self.driver.close()
        self._trace.close()
        self._real.close(self.clock.now_ns())
        return Wave(self.paths[0]), Wave(self.paths[1])


def edges(wave: Wave, name: str) -> list[tuple[int, str | float]]:
    return [(c.at_ns, c.value) for c in wave.changes[name] if c.value != "x"]


@pytest.mark.parametrize("card", list(CARDS))
def test_what_is_played_as_planned_is_drawn_to_the_nanosecond(tmp_path: Path, card: str) -> None:
    pair = Pair(tmp_path, card)
    for block in (
        line(300, -120, 7, exit_hz=3000),
        steady(40, 0, 39, rate_hz=3000, ends_at_rest=False),
        line(-200, 150, 0, entry_hz=JUMP_HZ),
    ):
        assert pair.driver.push(block)
    pair.play()
    pair.driver.idle(IdleLevel.OFF)
    pair.clock.pass_by(70_000_000)
    pair.driver.set_outputs(0, 0)
    assert pair.driver.push(line(0, 0, -33))
    pair.play()
    real, planned = pair.waves()
    for name in real.changes:
        if name[:5] in ("pin10", "pin11", "pin12", "pin13", "pin15"):
            continue
        assert edges(planned, name) == edges(real, name), name


BLOCKS = st.lists(
    st.tuples(st.integers(-90, 90), st.integers(-90, 90), st.integers(-90, 90)).filter(any),
    min_size=1,
    max_size=6,
)


@given(
    st.lists(
        st.tuples(BLOCKS, st.sampled_from(["", "stop", "brake"]), st.integers(0, 12)),
        min_size=1,
        max_size=4,
    )
)
def test_as_many_edges_as_steps_however_it_ends(
    tmp_path_factory: pytest.TempPathFactory, runs: list[tuple[list[tuple[int, ...]], str, int]]
) -> None:
    """Runs that are stopped, or braked and dropped, at any moment: counts are exact."""
    pair = Pair(tmp_path_factory.mktemp("planned"))
    report = pair.driver.poll(0)
    for blocks, end, slices in runs:
        for steps in blocks:
            assert pair.driver.push(steady(*steps))
        for _ in range(slices):
            pair.driver.poll(0.007)
        if end == "stop":
            pair.driver.stop()
        elif end == "brake":
            pair.driver.brake()
        report = pair.play()
        if end == "brake":
            pair.driver.flush()
    real, planned = pair.waves()
    signed = []
    for motor in range(MOTORS):
        clock, direction = f"pin{3 + 2 * motor:02d}_free", f"pin{2 + 2 * motor:02d}_free"
        assert len(planned.edges(clock, "1")) == len(real.edges(clock, "1"))
        forward = edges(planned, direction)
        levels = [[v for at, v in forward if at <= step][-1] for step in planned.edges(clock, "1")]
        signed.append(sum(1 if level == "1" else -1 for level in levels))
    assert signed == list(report.position_steps)


@given(st.tuples(*[st.integers(-50, 50)] * 3).filter(any), st.data())
def test_the_beginning_of_a_block(steps: tuple[int, int, int], data: st.DataObject) -> None:
    block: Block = line(*steps)
    done = data.draw(st.integers(0, block.ticks()))
    leader = max(range(3), key=lambda motor: abs(steps[motor]))
    made = [0, 0, 0]
    made[leader] = done if steps[leader] > 0 else -done
    first = begun(block, made)
    assert (first is None) == (done == 0)
    if first is not None:
        assert first.ticks() == done == abs(first.steps[leader])
        assert first.duration_cycles() <= block.duration_cycles()
        assert (first.steps == block.steps) == (done == block.ticks())
