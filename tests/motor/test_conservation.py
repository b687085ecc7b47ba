"""Where the carriages are, and what the mill says is lost, add up to the core's counters."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import Block, Watch, WatchAction, dwell
from fraese.motor.phases import exact_angle
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import End, IdleLevel, Report
from tests.motor.workbench import Workbench, line, steady

TRAVEL_STEPS = 800

steps = st.tuples(*[st.integers(-400, 400)] * 3).filter(any)
watches = st.none() | st.builds(
    Watch, st.just(0x80), st.sampled_from([0, 0x80]), st.sampled_from(list(WatchAction))
)
slow = st.builds(
    lambda s, r, w: steady(*s, rate_hz=r, watch=w), steps, st.floats(200, 1000), watches
)
gentle = st.one_of(
    slow,
    st.builds(lambda s, w: line(*s, watch=w), steps, watches),
    st.builds(lambda s: dwell(3, s), st.floats(0, 0.05)),
)
violent = st.one_of(
    gentle,
    st.builds(lambda s, r: steady(*s, rate_hz=r, jump_hz=r), steps, st.floats(800, 20_000)),
)

#: What somebody does after a poll of so many seconds.
acts = st.sampled_from(["nothing", "brake", "resume", "brake and flush", "idle", "hand"])
violence = acts | st.sampled_from(["stop", "power", "block", "power back", "let go"])
polls_s = st.floats(0.0001, 0.2)


def act(bench: Workbench, name: str) -> None:
    core, mill = bench.core, bench.mill
    if name == "brake":
        core.brake()
    elif name == "resume":
        core.resume()
    elif name == "brake and flush":
        core.brake()
        bench.run()
        core.flush()
    elif name == "stop":
        core.stop()
    elif name == "idle" and not bench.report().running:
        core.idle(IdleLevel.OFF)
    elif name == "hand":
        bench.simulated.press(End(1, 1))
        bench.report()
        bench.simulated.let_go(End(1, 1))
    elif name == "power":
        bench.electronics.cut_power()
    elif name == "power back":
        bench.electronics.restore_power()
    elif name in ("block", "let go"):
        mill.block(0, name == "block")


def play(bench: Workbench, story: list[tuple[Block, float, str]]) -> Report:
    for block, seconds, name in story:
        bench.run_for(seconds, block)
        act(bench, name)
    bench.core.resume()
    report = bench.run()
    bench.wait()
    return report


@pytest.mark.parametrize("wiring", ["smc", "x4step", "paper"])
class TestConservation:
    @settings(max_examples=60)
    @given(story=st.lists(st.tuples(gentle, polls_s, acts), max_size=6))
    def test_what_a_rotor_can_follow_is_followed(
        self, wiring: str, story: list[tuple[Block, float, str]]
    ) -> None:
        bench = Workbench(wiring, travel_steps=8 * TRAVEL_STEPS)
        report = play(bench, story)
        assert bench.lost() == (0, 0, 0)
        assert bench.carriages() == report.position_steps
        assert not report.torn

    @settings(max_examples=60)
    @given(
        story=st.lists(st.tuples(slow, polls_s, acts | st.just("stop")), max_size=8),
        readings=st.integers(1, 4),
        lag_s=st.floats(0, 0.01),
    )
    def test_contacts_and_stops_at_the_start_stop_rate_lose_nothing(
        self,
        wiring: str,
        story: list[tuple[Block, float, str]],
        readings: int,
        lag_s: float,
    ) -> None:
        bench = Workbench(
            wiring, travel_steps=300, overrun_steps=10_000, readings=readings, lag_s=lag_s
        )
        report = play(bench, story)
        assert bench.lost() == (0, 0, 0)
        assert bench.carriages() == report.position_steps
        assert not report.torn

    @settings(max_examples=120)
    @given(story=st.lists(st.tuples(violent, polls_s, violence), max_size=6), snaps=st.booleans())
    def test_what_it_cannot_is_counted(
        self, wiring: str, story: list[tuple[Block, float, str]], snaps: bool
    ) -> None:
        bench = Workbench(
            wiring, travel_steps=TRAVEL_STEPS, limits=RotorLimits(snaps_to_pole=snaps)
        )
        report = play(bench, story)
        found = tuple(c + n for c, n in zip(bench.carriages(), bench.lost(), strict=True))
        assert found == report.position_steps
        assert all(n >= abs(p) for n, p in zip(
            report.travelled_steps, report.position_steps, strict=True))  # fmt: skip


def test_a_long_way_round() -> None:
    bench = Workbench()
    there = [line(n, -n // 3, 7) for n in range(-500, 500, 37) if n]
    back = [line(*(-s for s in block.steps)) for block in there]
    report = bench.run(*there, *back)
    assert report.position_steps == (0, 0, 0)
    assert bench.carriages() == (0, 0, 0)
    assert report.travelled_steps[2] == 14 * len(there)


@settings(max_examples=60)
@given(
    pulses=st.sampled_from([4, 16, 20, 32, 100, 500, 1024]),
    story=st.lists(st.tuples(violent, polls_s, violence), max_size=6),
)
def test_fine_steps_add_up_exactly(pulses: int, story: list[tuple[Block, float, str]]) -> None:
    """Of any drive: what the carriages made and what is lost is what the drive's field turned."""
    bench = Workbench("x4step", travel_steps=TRAVEL_STEPS, steps_in_turn=pulses)
    report = play(bench, story)
    for made, lost, counted in zip(
        bench.carriages(), bench.lost(), report.position_steps, strict=True
    ):
        turns, rest = divmod(counted, pulses)
        assert made + lost == 8 * turns + exact_angle(8 * rest / pulses)


@settings(max_examples=40)
@given(pulses=st.sampled_from([4, 16, 20, 32, 100]), moves=st.lists(steps, max_size=5))
def test_fine_steps_within_the_limits_are_followed(
    pulses: int, moves: list[tuple[int, int, int]]
) -> None:
    per_half_step = pulses / 8
    blocks = [
        steady(*move, rate_hz=1000 * per_half_step, jump_hz=1000 * per_half_step) for move in moves
    ]
    bench = Workbench("x4step", steps_in_turn=pulses)
    bench.run(*blocks)
    assert bench.wait().lost() == (0, 0, 0)
