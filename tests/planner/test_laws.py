"""Ramps that are no straight lines: what the look-ahead is told, what is played, what it costs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import assemble
from fraese.blocks import Block
from fraese.config.file import from_table
from fraese.control.state import Status
from fraese.errors import ConfigError
from fraese.motor.bridge.records import Carried, body
from fraese.peers import RAMPS
from fraese.planner.laws import Law, RampKind, SCurve, Shape, Sine, trapezoid_shape
from fraese.planner.lines import plan_line
from fraese.planner.planner import Options, Planner
from fraese.planner.shaped import shaped_law
from tests.planner.motion import Floats, check_limits, duration_s, intervals_s, machine, run, uneven

JERK_S = 0.05
LAWS: dict[str, Law] = {"sine": Sine(), "s-curve": SCurve(JERK_S)}
NAMES = sorted(LAWS)
BUILT_IN = machine()
RATES = st.floats(0, 3000)
ACCELERATIONS = st.floats(2000, 200_000)


def accelerations(block: Block) -> tuple[Floats, Floats]:
    """Moments between ticks, and the acceleration there."""
    times = intervals_s(block)
    between = (times[1:] + times[:-1]) / 2
    return np.cumsum(times)[:-1], np.diff(1 / times) / between


def shaped(law: Law, ticks: int, entry: float, cruise: float, exit_: float) -> Block:
    law_s = shaped_law(law, ticks, entry**2, cruise**2, exit_**2, 2 * 20_000)
    return Block((ticks,), tuple(law_s))


@pytest.mark.parametrize("name", NAMES)
@given(low=RATES, acceleration=ACCELERATIONS, way=st.floats(1, 5000))
def test_how_far_a_ramp_reaches_and_how_long_it_is_agree(
    name: str, low: float, acceleration: float, way: float
) -> None:
    law = LAWS[name]
    high2 = law.reached2(low**2, 2 * acceleration, way)
    assert low**2 < high2 <= (low**2 + 2 * acceleration * way) * (1 + 1e-9)
    assert law.way(low**2, high2, 2 * acceleration) == pytest.approx(way, rel=1e-6)


@pytest.mark.parametrize("shape", [Sine().shape(0, 1, 1, 1), trapezoid_shape(0.2)])
def test_a_shape_is_symmetric_and_its_way_is_its_integral(shape: Shape) -> None:
    shares = np.linspace(0, 1, 2001)
    gained = np.array([shape.gained(share) for share in shares])
    assert gained + gained[::-1] == pytest.approx(np.ones(2001))
    way = np.array([shape.way(share) for share in shares])
    assert np.diff(way) == pytest.approx((gained[1:] + gained[:-1]) / 4000, abs=1e-6)
    assert way[-1] == pytest.approx(0.5)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=40)
@given(
    ticks=st.integers(1, 6000),
    entry=RATES,
    exit_=RATES,
    above=st.floats(0, 8000),
    acceleration=ACCELERATIONS,
)
def test_every_tick_is_made_and_the_peak_is_that_of_the_axes(
    name: str, ticks: int, entry: float, exit_: float, above: float, acceleration: float
) -> None:
    law, twice = LAWS[name], 2 * acceleration
    # The look-ahead asks for no exit that cannot be reached.
    exit2 = min(exit_**2, law.reached2(entry**2, twice, ticks))
    entry2 = min(entry**2, law.reached2(exit2, twice, ticks))
    cruise2 = max(entry2, exit2) + above**2
    pieces = shaped_law(law, ticks, entry2, cruise2, exit2, twice)
    assert sum(piece.ticks for piece in pieces) == ticks
    assert len(pieces) <= 255
    if ticks < 3:
        return
    times = intervals_s(Block((ticks,), tuple(pieces)))
    assert (1 / times).max() <= math.sqrt(cruise2) * 1.001 or cruise2 < twice
    change = np.abs(np.diff(1 / times))
    allowed = acceleration * (times[1:] + times[:-1]) / 2 * 1.15
    # A cycle of rounding; and the first ticks from rest, which take a piece each.
    rounding = 2 / times[1:] ** 2 / 16e6
    slow = 1 / times[1:] < 8 * math.sqrt(acceleration)
    within = slow | (change <= allowed + rounding)
    assert within.all(), (change / allowed).max()


@pytest.mark.parametrize("name", NAMES)
def test_braking_is_the_mirror_image_to_the_cycle(name: str) -> None:
    times = intervals_s(shaped(LAWS[name], 4000, 750, 4000, 750))
    assert list(times) == list(times[::-1])


def test_the_acceleration_of_a_sine_comes_and_goes() -> None:
    moments, change = accelerations(shaped(Sine(), 4000, 750, 4000, 4000))
    ramp_s = moments[change > 500][-1]
    assert ramp_s == pytest.approx(math.pi / 2 * 3250 / 20_000, rel=0.08)
    for share in (0.1, 0.25, 0.5, 0.75, 0.9):
        near = np.abs(moments - share * ramp_s) < 0.05 * ramp_s
        meant = 20_000 * math.sin(math.pi * share)
        assert change[near].mean() == pytest.approx(meant, abs=2000), share


def test_the_jerk_of_an_s_curve_is_limited() -> None:
    """From nothing to the full acceleration in 50 ms, and back, with a stretch between."""
    moments, change = accelerations(shaped(SCurve(JERK_S), 4000, 750, 4000, 4000))
    # Over a tenth of a ramp's time: a piece has the acceleration of its middle.
    window = 0.02
    at = np.arange(window, moments[-1] - window, 0.002)
    means = [change[np.abs(moments - moment) < window / 2].mean() for moment in at]
    jerk = np.abs(np.diff(means)) / 0.002
    runs = np.convolve(jerk, np.ones(10) / 10, "valid")
    assert runs.max() < 1.15 * 20_000 / JERK_S
    assert max(means) == pytest.approx(20_000, rel=0.02)


@pytest.mark.parametrize("name", NAMES)
def test_a_ramp_that_is_too_short_for_it_has_constant_acceleration(name: str) -> None:
    _, change = accelerations(shaped(LAWS[name], 10, 1000, 4000, 1100))
    assert np.abs(change).max() < 20_000 * 0.75


SQUARE = [(30.0, 0.0, 0.0), (30.0, 20.0, 0.0), (0.0, 20.0, 0.0), (0.0, 0.0, 0.0)]
CURVE = [
    (10 * math.cos(k / 20) - 10, 10 * math.sin(k / 20), 0.0)
    for k in range(120)
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("points", [SQUARE, CURVE], ids=["square", "curve"])
def test_a_path_keeps_all_limits(name: str, points: list[tuple[float, float, float]]) -> None:
    for axes in (BUILT_IN, uneven()):
        blocks = run(Planner(replace(axes, ramp=name), (0, 0, 0)), points, 1100)
        check_limits(axes.axes, blocks)
        longer = duration_s(blocks) / duration_s(run(Planner(axes, (0, 0, 0)), points, 1100))
        assert 1 <= longer < 1.15


@pytest.mark.parametrize("name", NAMES)
def test_a_long_line_is_not_cut_within_its_ramps(name: str) -> None:
    """Else the acceleration would go to nothing at every cut, twenty times a second."""
    planner = Planner(replace(BUILT_IN, ramp=name), (0, 0, 0), Options(max_block_s=0.05))
    blocks = run(planner, [(100.0, 0.0, 0.0)], 1100)
    assert len(blocks) > 50
    rising = [block for block in blocks if any(piece.add_q8 < 0 for piece in block.pieces)]
    falling = [block for block in blocks if any(piece.add_q8 > 0 for piece in block.pieces)]
    assert rising == blocks[:1]
    assert falling == blocks[-1:]


@pytest.mark.parametrize("name", NAMES)
def test_a_bridge_can_store_every_block(name: str) -> None:
    blocks = run(Planner(replace(BUILT_IN, ramp=name), (0, 0, 0)), SQUARE, None)
    assert max(len(body(block, Carried())) for block in blocks) < 512


@pytest.mark.parametrize("name", NAMES)
def test_jogs_and_reference_runs_have_it_too(name: str) -> None:
    block = plan_line(replace(BUILT_IN, ramp=name), (1600, 0, 0))
    assert block is not None
    moments, change = accelerations(block)
    early = change[(moments < 0.02)].mean()
    middle = change[np.abs(moments - 0.12) < 0.01].mean()
    assert early < middle / 2


@pytest.mark.parametrize("name", NAMES)
def test_a_machine_that_is_configured_so_loses_no_step(name: str) -> None:
    plant = assemble(from_table({"planner": {"ramp": name}}, "test"))
    plant.controller.home()
    assert plant.controller.run() is Status.OK, plant.controller.state().message
    plant.controller.move_to({"x": 40.0, "y": 25.0})
    assert plant.controller.run() is Status.OK
    assert plant.controller.state().lost_steps == (0, 0, 0)
    plant.close()


def test_every_name_leads_to_a_law_and_another_is_refused() -> None:
    assert RAMPS.names == ("linear", "sine", "s-curve")
    assert all(isinstance(RAMPS.record(name), RampKind) for name in RAMPS.ours)
    with pytest.raises(ConfigError, match="must be 'linear', 'sine' or 's-curve', not cubic"):
        from_table({"planner": {"ramp": "cubic"}}, "test")
