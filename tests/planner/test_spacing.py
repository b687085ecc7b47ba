"""Steps of axes that follow: none comes sooner than the axis' own rate allows, on any player."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fraese.blocks import CYCLES_PER_S, Block
from fraese.config import Config
from fraese.machine import Machine
from fraese.motor.cursor import Cursor, divisions
from fraese.planner.planner import Planner
from fraese.planner.segments import paced_as
from tests.planner.motion import moving, run

#: Beats that a player may divide a tick into are no shorter; None: it divides none, as on clock and
#: direction.
PLAYERS = (None, 320, 640)


def unlike() -> Machine:
    """X may step three times as fast as Y, and Z is in between."""
    x, y, z = Machine.from_config(Config()).axes
    return Machine(
        (
            replace(x, max_rate_hz=8000.0, steps_per_mm=Fraction(100)),
            replace(y, max_rate_hz=2500.0, steps_per_mm=Fraction(100)),
            replace(z, max_rate_hz=4000.0, steps_per_mm=Fraction(160)),
        )
    )


def closest_cycles(blocks: list[Block], beat_cycles: int | None) -> list[float]:
    """The shortest time between two steps of each motor, cycles."""
    now = 0
    last: list[int | None] = [None] * 3
    closest = [float("inf")] * 3
    for block in blocks:
        cursor = Cursor(block)
        while cursor.done < cursor.ticks and cursor.next_piece():
            interval_q8 = cursor.interval_q8
            for _ in range(cursor.piece_left):
                cycles = interval_q8 >> 8
                exponent = 0 if beat_cycles is None else divisions(cycles, beat_cycles)
                cursor.settle()
                cursor.divide(exponent)
                before = {bit: beat for beat, bits in cursor.beats for bit in bits_of(bits)}
                for motor in range(3):
                    if cursor.moving >> motor & 1:
                        beat = before.get(motor, 1 << exponent)
                        at = now + (cycles * beat >> exponent)
                        was, last[motor] = last[motor], at
                        if was is not None:
                            closest[motor] = min(closest[motor], at - was)
                now += cycles
                cursor.made()
                interval_q8 += cursor.add_q8
    return closest


def bits_of(mask: int) -> list[int]:
    return [motor for motor in range(3) if mask >> motor & 1]


POINTS = st.lists(
    st.tuples(*[st.integers(-4000, 4000).map(lambda n: n / 97)] * 3), min_size=1, max_size=5
)


@settings(deadline=None)
@given(points=POINTS, beat_cycles=st.sampled_from(PLAYERS))
@example(points=[(100.0, 51.0, 0.0)], beat_cycles=None)
@example(points=[(40.0, 39.0, 0.0)], beat_cycles=None)
@example(points=[(40.0, 14.0, 3.0), (80.0, 28.0, 6.1)], beat_cycles=640)
def test_no_step_comes_sooner_than_its_axis_allows(
    points: list[tuple[float, float, float]], beat_cycles: int | None
) -> None:
    axes = unlike()
    blocks = moving(run(Planner(axes, (0, 0, 0)), points, None))
    for axis, cycles in zip(axes.axes, closest_cycles(blocks, beat_cycles), strict=True):
        # A cycle is cut off every interval, and a beat is a whole number of them.
        ticks = 8000 / axis.max_rate_hz
        assert cycles >= CYCLES_PER_S / axis.max_rate_hz * 0.999 - 2 * ticks - 2


@pytest.mark.parametrize(
    ("steps", "ticks", "paced"),
    [(0, 9, 0), (9, 9, 9), (51, 100, 100), (50, 100, 50), (34, 100, 50), (33, 100, 100 / 3)],
)
def test_what_a_followers_closest_steps_count_as(steps: int, ticks: int, paced: float) -> None:
    assert paced_as(steps, ticks) == pytest.approx(paced)
