"""Firmware and polled core make the same register writes, in the same order, at the same cycles."""

from dataclasses import dataclass
from typing import Any, Final

import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st

from fraese.blocks import Block, Outputs, Piece, dwell
from fraese.motor.bridge import constants as c
from tests.bridge.device import reason_to_skip
from tests.bridge.peers import (
    BEAT_CYCLES,
    PHASES,
    Core,
    Kind,
    clock_kind,
    compare,
    device_for,
    device_writes,
    steady_cycles,
)

_SLOW = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow],
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)  # fmt: skip

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

#: Below this a block is over before the next one can be decoded.
_SHORTEST_BLOCK_CYCLES = 6_000
#: Direction lines turn when their block is taken in hand, in the wait after the fall: not at a
#: cycle, but early enough before the next edge.
_TURN_CYCLES = 3000
#: A start/stop rate that no block exceeds: the throttle stays open.
_ANY_RATE = 255 << 16


@dataclass(frozen=True)
class Range:
    """What blocks a test is given.

    Attributes:
        motors: of the card.
        least_cycles: shortest interval of a plan,
        spread: and how much longer others may be.
        least_ticks: of a piece, if the block has as many.
        dwell_s: shortest and longest wait.
        throttled: start/stop rates are low, so that blocks are entered on a ramp.
    """

    motors: int
    least_cycles: int
    spread: float = 6.0
    throttled: bool = False
    least_ticks: int = 1
    dwell_s: tuple[float, float] = (0.001, 0.03)


@st.composite
def _laws(draw: st.DrawFn, ticks: int, given: Range) -> tuple[Piece, ...]:
    """Pieces for so many ticks, none faster than the range says."""
    least_q8 = max(given.least_cycles, _SHORTEST_BLOCK_CYCLES // ticks) * 256
    most_q8 = int(least_q8 * given.spread)
    pieces: list[Piece] = []
    while ticks:
        least = min(ticks, given.least_ticks)
        count = draw(st.integers(least, ticks)) if len(pieces) < 4 else ticks
        first_q8 = draw(st.integers(least_q8, most_q8))
        adds = st.integers((least_q8 - first_q8) // count + 1, (most_q8 - first_q8) // count)
        pieces.append(Piece(count, first_q8, draw(adds) if draw(st.booleans()) else 0))
        ticks -= count
    return tuple(pieces)


@st.composite
def moves(draw: st.DrawFn, given: Range) -> Block:
    """A block that moves at least one motor."""
    most = draw(st.sampled_from([1, 3, 40, 120]))
    steps = tuple(draw(st.integers(-most, most)) for _ in range(given.motors))
    if not any(steps):
        steps = (1, *steps[1:])
    ticks = max(map(abs, steps))
    mask = draw(st.sampled_from([0, 0, 0, 1, 2, 3]))
    jump_q8 = draw(st.integers(16, 255)) << draw(st.integers(8, 12))
    return Block(
        steps=steps,
        pieces=draw(_laws(ticks, given)),
        accel_q=draw(st.integers(1, 255)) << draw(st.integers(4, 10)),
        jump_rate_q8=jump_q8 if given.throttled else _ANY_RATE,
        weight=draw(st.integers(1, 100)),
        ends_at_rest=draw(st.booleans()),
        outputs=Outputs(mask, draw(st.integers(0, 3))) if mask else None,
    )


def _seconds(given: Range) -> st.SearchStrategy[float]:
    """A wait none of whose ticks, of 10 ms and a rest, is a short one."""
    shortest_s = given.dwell_s[0]
    return st.floats(*given.dwell_s).filter(lambda s: s % 0.01 >= shortest_s)


@st.composite
def queues(draw: st.DrawFn, given: Range) -> list[Block]:
    """Blocks that fit into the ring together, dwells among them; the last one ends at rest."""
    waits = st.builds(dwell, st.just(given.motors), _seconds(given))
    blocks = draw(st.lists(st.one_of(moves(given), moves(given), waits), min_size=1, max_size=8))
    return [*blocks[:-1], blocks[-1]._replace(ends_at_rest=True)]


def play_both(kind: Kind, blocks: list[Block], exact: bool = True) -> None:
    """The same queue on core and firmware.

    Args:
        kind: the card.
        blocks: the queue.
        exact: every beat at its cycle; else only the same writes in the same order.
    """
    core = Core(kind)
    core.push(blocks)
    core.play()
    device = device_for(kind)
    device.push(blocks, core.dry)
    device.start()
    status = device.stand_still()
    assert status.ended == c.ENDED_TARGET
    if exact:
        assert status.late_ticks == 0
        writes, clocks = device_writes(device), kind.facts.kind == c.CARD_CLOCKS
        compare(core.writes(), writes, slack_cycles=_TURN_CYCLES if clocks else BEAT_CYCLES)
        if clocks:
            assert min(steady_cycles(writes), default=_TURN_CYCLES) >= kind.facts.setup_cycles
    else:
        wanted = [w[1:] for w in core.writes()]
        assert [w[1:] for w in device_writes(device)] == wanted
        assert status.late_ticks <= sum(len(block.pieces) for block in blocks)


EXACT_PHASES = Range(3, 4_500)
EXACT_THROTTLED = Range(3, 12_000, throttled=True)
FAST_PHASES = Range(3, 1_300, least_ticks=8)
#: What is chosen after a fall must be ready half an interval later.
EXACT_CLOCKS = Range(4, 9_000)
THROTTLED_CLOCKS = Range(4, 24_000, throttled=True)
#: Waits in which the inputs are read.
LONG_CLOCKS = Range(4, 250_000)
#: The pause before a short pulse leaves all the time that there is; before a long one, none.
DUTIES = (0x30 / (0x30 + 2 * 0x0310), 0.2, 0.5)


def short(steps: tuple[int, ...], interval_q8: int, accel_q: int, **more: Any) -> Block:
    """A block of one tick, whose limits are others than those before it."""
    return Block(steps, (Piece(1, interval_q8, 0),), accel_q, _ANY_RATE, weight=1, **more)


#: What is to be read in a tick is as long as it can be.
SHORT: Final = [
    short((1, 1, 1), 1_536_002 + 257 * n, 4112 * (n + 1), ends_at_rest=n == 7) for n in range(8)
]
#: The block that begins after a dwell, with outputs, takes long in the interrupt too.
AFTER_DWELL: Final = [
    dwell(3, 0.0078125),
    short((1, 1, 1), 1_536_000, 16, ends_at_rest=False, outputs=Outputs(1, 1)),
    Block((1, 1, 2), (Piece(2, 1_152_000, 1),), 32, _ANY_RATE, weight=1, ends_at_rest=False),
    Block((0, 1, 2), (Piece(2, 1_152_000, 0),), 16, _ANY_RATE, weight=1),
]


@_SLOW
@given(blocks=queues(EXACT_PHASES))
@example(blocks=SHORT)
@example(blocks=AFTER_DWELL)
def test_phase_card_to_the_cycle(blocks: list[Block]) -> None:
    play_both(PHASES, blocks)


@_SLOW
@given(blocks=queues(EXACT_THROTTLED))
def test_phase_card_entered_on_ramps(blocks: list[Block]) -> None:
    play_both(PHASES, blocks)


@_SLOW
@given(blocks=queues(FAST_PHASES))
def test_phase_card_at_high_rates(blocks: list[Block]) -> None:
    """The first tick of a piece may come late, and is counted then; nothing else changes."""
    play_both(PHASES, blocks, exact=False)


@_SLOW
@given(blocks=queues(EXACT_CLOCKS))
def test_paper_drives(blocks: list[Block]) -> None:
    play_both(clock_kind("paper"), blocks)


@_SLOW
@given(blocks=queues(EXACT_CLOCKS))
def test_x4step_drives(blocks: list[Block]) -> None:
    play_both(clock_kind("x4step"), blocks)


@_SLOW
@given(blocks=queues(EXACT_CLOCKS))
def test_drives_in_other_sockets(blocks: list[Block]) -> None:
    play_both(clock_kind("x4step", sockets=(2, 0, 3, 1)), blocks)


@_SLOW
@given(blocks=queues(THROTTLED_CLOCKS))
def test_x4step_drives_entered_on_ramps(blocks: list[Block]) -> None:
    play_both(clock_kind("x4step"), blocks)


@settings(_SLOW, max_examples=8)
@given(blocks=queues(LONG_CLOCKS))
def test_x4step_drives_at_low_rates(blocks: list[Block]) -> None:
    play_both(clock_kind("x4step"), blocks)


@_SLOW
@given(blocks=queues(EXACT_CLOCKS), duty=st.sampled_from(DUTIES))
def test_any_duty(blocks: list[Block], duty: float) -> None:
    play_both(clock_kind("paper", duty), blocks)
