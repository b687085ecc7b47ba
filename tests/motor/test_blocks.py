"""Blocks: integers that every player plays alike."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import (
    CYCLES_PER_S,
    RATE_Q8_CYCLES,
    Block,
    Piece,
    accel_q_from_hz_s,
    dwell,
    few_bits,
    first_accumulator,
    leader_of,
    rate_q8_from_hz,
    steps_done,
)
from fraese.motor.cursor import Cursor
from fraese.motor.seams import EVERY_MOTOR

pieces = st.builds(
    lambda ticks, interval_q8, part: Piece(ticks, interval_q8, int(part * interval_q8 / ticks)),
    st.integers(1, 300),
    st.integers(256, 10_000_000),
    st.floats(-0.9, 3.0),
)


def intervals(piece: Piece) -> list[int]:
    return [(piece.interval_q8 + k * piece.add_q8) >> 8 for k in range(piece.ticks)]


class TestPiece:
    @given(pieces)
    def test_mirrored_to_the_cycle(self, piece: Piece) -> None:
        assert intervals(piece.mirrored()) == intervals(piece)[::-1]
        assert piece.mirrored().mirrored() == piece
        assert piece.mirrored().duration_cycles() == piece.duration_cycles()

    @given(pieces)
    def test_duration_is_the_sum_of_what_is_played(self, piece: Piece) -> None:
        assert piece.duration_cycles() == sum(intervals(piece))
        assert piece.last_interval_q8() >> 8 == intervals(piece)[-1]


class TestBresenham:
    @given(ticks=st.integers(1, 2000), data=st.data())
    def test_closed_form_and_running_sum_agree(self, ticks: int, data: st.DataObject) -> None:
        total = data.draw(st.integers(0, ticks))
        accumulator, made = first_accumulator(total, ticks), 0
        for done in range(ticks + 1):
            assert steps_done(total, ticks, done) == made
            accumulator += total
            if accumulator >= ticks:
                accumulator -= ticks
                made += 1

    @given(ticks=st.integers(1, 2000), data=st.data())
    def test_never_more_than_a_step_from_the_line(self, ticks: int, data: st.DataObject) -> None:
        """Half a step, and as much as the leader is behind while its own step is to come."""
        total = data.draw(st.integers(0, ticks))
        for done in range(ticks + 1):
            behind = done * total / ticks - steps_done(total, ticks, done)
            assert -0.5 <= behind <= 1

    @given(st.integers(1, 2000))
    def test_an_equal_axis_steps_with_the_leader(self, ticks: int) -> None:
        assert [steps_done(ticks, ticks, done) for done in range(ticks + 1)] == [*range(ticks + 1)]

    @given(st.lists(st.integers(-300, 300), min_size=1, max_size=4).filter(any))
    def test_cursor_ends_where_the_block_says(self, steps: list[int]) -> None:
        block = Block(tuple(steps), (Piece(max(map(abs, steps)), 256),))
        cursor = Cursor(block)
        assert cursor.steps_at(0) == (0,) * len(steps)
        assert cursor.steps_at(cursor.ticks) == block.steps

    @given(st.lists(st.integers(-9, 9), min_size=2, max_size=4).filter(any))
    def test_within_a_tick_the_leader_is_first(self, steps: list[int]) -> None:
        cursor = Cursor(Block(tuple(steps), (Piece(max(map(abs, steps)), 256),)))
        order = [cursor.leader, *(m for m in range(len(steps)) if m != cursor.leader)]
        for done in range(cursor.ticks):
            cursor.done = done
            before, after = cursor.steps_at(cursor.done), cursor.steps_at(cursor.done + 1)
            cursor.moving = sum(1 << m for m in order if before[m] != after[m])
            assert cursor.steps_within_beat(EVERY_MOTOR) == after
            for place, last in enumerate(order):
                now = cursor.steps_within_beat(last)
                assert all(now[m] == after[m] for m in order[: place + 1])
                assert all(now[m] == before[m] for m in order[place + 1 :])

    @pytest.mark.parametrize(
        ("steps", "leader"), [((1, 2, 3), 2), ((3, -3, 1), 0), ((0, -3, 3), 1), ((0, 0, 0), 0)]
    )
    def test_leader(self, steps: tuple[int, ...], leader: int) -> None:
        assert leader_of(steps) == leader


class TestDwell:
    @given(st.floats(0, 100))
    def test_takes_as_long_as_it_says(self, seconds: float) -> None:
        block = dwell(3, seconds)
        assert block.duration_cycles() == round(seconds * CYCLES_PER_S)
        assert block.steps == (0, 0, 0)
        assert block.ticks() >= 1

    def test_no_negative_time(self) -> None:
        with pytest.raises(ValueError, match="negative"):
            dwell(3, -0.1)


def test_integers_of_rates() -> None:
    assert RATE_Q8_CYCLES < 1 << 32
    assert rate_q8_from_hz(1000) == RATE_Q8_CYCLES // (CYCLES_PER_S // 1000)
    assert accel_q_from_hz_s(0) == 1
    per_ms = accel_q_from_hz_s(50_000) * 16_000 >> 16
    assert per_ms == pytest.approx(rate_q8_from_hz(50), rel=1 / 128)


@given(st.integers(0, 2**40))
def test_a_limit_of_few_bits_is_a_little_lower(value: int) -> None:
    short = few_bits(value)
    assert short <= value < short * (1 + 1 / 127) + 1
    assert len(bin(short).rstrip("0b")) <= 8 + 2
    assert few_bits(short) == short


def test_a_block_knows_its_length() -> None:
    block = Block((5, 2), (Piece(2, 25_600), Piece(3, 51_200, -256)))
    assert block.ticks() == 5
    assert block.duration_cycles() == 200 + 200 + 199 + 198
    assert list(itertools.accumulate(p.ticks for p in block.pieces)) == [2, 5]
