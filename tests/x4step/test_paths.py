"""Time laws and blocks of paths: exact lengths, mirrored ramps, steps at one rate on every path."""

import math
from itertools import islice

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import CYCLES_PER_S, Block, Piece
from fraese.motor.blockqueue import require_sound
from fraese.x4step.paths import (
    ENDLESS_TICKS,
    MOST_PIECES,
    MOST_TICKS,
    acceleration_hz_s,
    endless,
    path,
    ramp_ticks,
    time_law,
)

MOST = 16_777_216
rates = st.integers(10, 20_000)
Asked = tuple[int, int]


@st.composite
def rate_and_ramp(draw: st.DrawFn) -> Asked:
    freq = draw(rates)
    return freq, draw(st.integers(0, min(1000, freq)))


def intervals(law: list[Piece]) -> list[int]:
    """Cycles of every tick."""
    return [piece.interval_q8 + k * piece.add_q8 >> 8 for piece in law for k in range(piece.ticks)]


def level_run(cycles: list[int]) -> int:
    """Steps in a row at the highest rate."""
    fastest = min(cycles)
    return cycles.count(fastest)


@given(rate_and_ramp(), st.integers(1, 3000))
def test_a_law_is_exact_mirrored_and_never_too_fast(asked: Asked, ticks: int) -> None:
    freq, ramp = asked
    cycles = intervals(time_law(ticks, freq, ramp))
    assert len(cycles) == ticks
    assert cycles == cycles[::-1]
    assert min(cycles) >= CYCLES_PER_S // freq
    half = cycles[: (ticks + 1) // 2]
    assert half == sorted(half, reverse=True)
    assert level_run(cycles) >= min(4, ticks)


@given(rate_and_ramp(), st.integers(-6, 6))
def test_where_the_rate_is_just_reached_there_are_steps_at_one_rate(
    asked: Asked, more: int
) -> None:
    freq, ramp = asked
    ticks = max(1, freq * ramp // 1000 + more)
    law = time_law(ticks, freq, ramp)
    assert sum(piece.ticks for piece in law) == ticks
    level = min(law, key=lambda piece: piece.interval_q8)
    assert level.ticks >= min(4, ticks)
    assert level.add_q8 == 0


@pytest.mark.parametrize(
    ("freq", "ramp"), [(1000, 50), (1000, 1000), (2000, 50), (10_000, 500), (20_000, 1000)]
)
def test_a_ramp_takes_its_time_and_the_level_rate_is_the_one_asked_for(
    freq: int, ramp: int
) -> None:
    whole = ramp_ticks(freq, ramp)
    cycles = intervals(time_law(2 * whole + 100, freq, ramp))
    up = cycles[:whole]
    assert sum(up) / CYCLES_PER_S == pytest.approx(ramp / 1000, rel=0.02)
    assert cycles[whole] == math.ceil(CYCLES_PER_S * 256 / freq) >> 8
    assert cycles[whole : whole + 100] == [cycles[whole]] * 100
    first_hz = CYCLES_PER_S / cycles[0]
    assert first_hz == pytest.approx(math.sqrt(acceleration_hz_s(freq, ramp) / 2), rel=0.01)


@pytest.mark.parametrize(
    ("ticks", "freq", "ramp"),
    [(1, 1000, 50), (2, 1000, 50), (3, 1000, 50), (4, 1000, 50), (1000, 500, 0), (5, 10, 10),
     (1, 20_000, 0), (100, 10, 10)],
)  # fmt: skip
def test_without_room_or_time_for_a_ramp_all_steps_are_at_one_rate(
    ticks: int, freq: int, ramp: int
) -> None:
    (piece,) = time_law(ticks, freq, ramp)
    assert (piece.ticks, piece.add_q8) == (ticks, 0)


def test_a_short_path_is_slower_than_the_rate() -> None:
    cycles = intervals(time_law(30, 1000, 50))
    assert CYCLES_PER_S / min(cycles) == pytest.approx(math.sqrt(2 * 20_000 * 13), rel=0.01)


@given(
    rate_and_ramp(),
    st.tuples(*[st.integers(-MOST, MOST)] * 4).filter(any),
)
def test_a_path_of_any_length_fits_every_driver(asked: Asked, steps: tuple[int, ...]) -> None:
    blocks = list(path(steps, *asked))
    assert tuple(map(sum, zip(*(block.steps for block in blocks), strict=True))) == steps
    for block in blocks:
        require_sound(block, 4)
        assert block.ticks() <= MOST_TICKS
        assert len(block.pieces) <= MOST_PIECES
    assert [block.ends_at_rest for block in blocks] == [False] * (len(blocks) - 1) + [True]


def test_the_longest_path_without_a_ramp_is_nine_blocks() -> None:
    assert len(list(path((MOST, -MOST, 1, 0), 20_000, 0))) == 9


def test_a_cut_lies_on_the_line() -> None:
    steps = (MOST, MOST // 3, -MOST // 7, 5)
    at = [0, 0, 0, 0]
    for block in path(steps, 20_000, 1000):
        at = [a + b for a, b in zip(at, block.steps, strict=True)]
        for total, made in zip(steps, at, strict=True):
            assert abs(made - total * at[0] / MOST) <= 1


def law_of(blocks: list[Block]) -> list[Piece]:
    return [piece for block in blocks for piece in block.pieces]


def test_a_law_that_is_cut_is_the_same_law() -> None:
    law = time_law(60_000, 20_000, 1000)
    assert len(law) > 2 * MOST_PIECES
    blocks = list(path((60_000, 0, 0, 0), 20_000, 1000))
    assert intervals(law_of(blocks)) == intervals(law)
    entries = [block.pieces[0].interval_q8 for block in blocks]
    assert len(entries) == len(blocks) > 2


@pytest.mark.parametrize(("motor", "sign"), [(0, 1), (3, -1)])
def test_an_endless_path_goes_on_beyond_the_longest_one(motor: int, sign: int) -> None:
    blocks = list(islice(endless(motor, sign, 20_000, 1000), 40))
    made = [sum(block.steps[axis] for block in blocks) for axis in range(4)]
    assert sign * made[motor] > MOST
    assert made[:motor] + made[motor + 1 :] == [0, 0, 0]
    assert not any(block.ends_at_rest for block in blocks)
    assert blocks[-1].ticks() == ENDLESS_TICKS
    for block in blocks:
        require_sound(block, 4)


@given(rate_and_ramp())
def test_brake_and_jump_fit_the_rate(asked: Asked) -> None:
    freq, ramp = asked
    block = next(path((1000, 0, 0, 0), freq, ramp))
    jump_hz = block.jump_rate_q8 / 256
    entry_hz = CYCLES_PER_S * 256 / block.pieces[0].interval_q8
    assert jump_hz >= entry_hz * (1 - 1e-6) or jump_hz >= freq
    assert (
        block.jump_rate_q8
        >> max(0, block.jump_rate_q8.bit_length() - 8)
        << max(0, block.jump_rate_q8.bit_length() - 8)
        == block.jump_rate_q8
    )
    if not ramp:
        assert jump_hz >= freq
