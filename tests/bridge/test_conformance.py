"""Firmware and polled core make the same register writes, in the same order, at the same cycles."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fraese.blocks import Block, Outputs, Piece, dwell
from fraese.motor.bridge import constants as c
from tests.bridge.device import reason_to_skip
from tests.bridge.peers import PHASES, Core, Kind, clock_kind, compare, device_for, device_writes

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

#: Below this a block is over before the next one can be decoded.
_SHORTEST_BLOCK_CYCLES = 9_000


@st.composite
def _laws(draw: st.DrawFn, ticks: int, least_cycles: int) -> tuple[Piece, ...]:
    """Pieces for so many ticks, none too fast for the microcontroller."""
    least_cycles = max(least_cycles, _SHORTEST_BLOCK_CYCLES // ticks)
    pieces = []
    while ticks:
        count = draw(st.integers(1, ticks)) if len(pieces) < 4 else ticks
        first = draw(st.integers(least_cycles * 256, least_cycles * 256 * 6))
        least_add = -((first - least_cycles * 256) // count)
        add = draw(st.integers(least_add, 3000)) if draw(st.booleans()) else 0
        pieces.append(Piece(count, first, add))
        ticks -= count
    return tuple(pieces)


@st.composite
def moves(draw: st.DrawFn, motors: int, least_cycles: int) -> Block:
    """A block that moves at least one motor."""
    most = draw(st.sampled_from([1, 3, 40, 200]))
    steps = tuple(draw(st.integers(-most, most)) for _ in range(motors))
    if not any(steps):
        steps = (1,) + steps[1:]
    ticks = max(map(abs, steps))
    mask = draw(st.sampled_from([0, 0, 0, 1, 2, 3]))
    return Block(
        steps=steps,
        pieces=draw(_laws(ticks, least_cycles)),
        accel_q=draw(st.integers(1, 255)) << draw(st.integers(4, 14)),
        jump_rate_q8=draw(st.integers(16, 255)) << draw(st.integers(8, 14)),
        outputs=Outputs(mask, draw(st.integers(0, 3))) if mask else None,
    )


def queues(motors: int, least_cycles: int) -> st.SearchStrategy[list[Block]]:
    """Blocks that fit into the ring together, dwells among them."""
    one = st.one_of(
        moves(motors, least_cycles),
        moves(motors, least_cycles),
        st.builds(dwell, st.just(motors), st.floats(0.001, 0.03)),
    )
    return st.lists(one, min_size=1, max_size=8)


def _play_both(kind: Kind, blocks: list[Block]) -> None:
    core = Core(kind)
    core.push(blocks)
    core.play()
    device = device_for(kind)
    device.push(blocks, core.dry)
    device.start()
    status = device.stand_still()
    assert (status.ended, status.late_ticks) == (c.ENDED_TARGET, 0)
    compare(core.writes(), device_writes(device))


_SLOW = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


@_SLOW
@given(blocks=queues(3, 700))
def test_phase_card(blocks: list[Block]) -> None:
    _play_both(PHASES, blocks)


@_SLOW
@given(blocks=queues(4, 1300))
def test_paper_drives(blocks: list[Block]) -> None:
    _play_both(clock_kind("paper"), blocks)


@_SLOW
@given(blocks=queues(4, 1300))
def test_x4step_drives(blocks: list[Block]) -> None:
    _play_both(clock_kind("x4step"), blocks)
