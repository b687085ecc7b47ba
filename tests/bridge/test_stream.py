"""Long runs over the line: nothing is lost or late, whatever the host and the line do."""

import random
from itertools import pairwise

import numpy as np
import pytest

from fraese.blocks import Block, Piece
from fraese.motor.bridge import constants as c
from tests.bridge.device import MS, Device, reason_to_skip
from tests.bridge.peers import PHASES, device_for, device_writes
from tests.bridge.streaming import Stream

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

TABLE = PHASES.facts.table


def curve(blocks: int, interval: int, ticks: int, seed: int = 1) -> list[Block]:
    """A curve at constant feed in blocks of equal length; it ends at rest."""
    chance = random.Random(seed)
    made = [
        Block(
            (ticks, chance.randint(-ticks, ticks), chance.randint(-ticks, ticks)),
            (Piece(ticks, interval * 256 + chance.randint(0, 255)),),
            accel_q=(100 + chance.randint(0, 99)) << 12,
            jump_rate_q8=(129 + chance.randint(0, 99)) << 16,
            weight=5,
            ends_at_rest=False,
        )
        for _ in range(blocks)
    ]
    return [*made[:-1], made[-1]._replace(ends_at_rest=True)]


def steps_made(device: Device) -> tuple[int, ...]:
    """Signed steps of every motor, from the bytes latched: each one place on in its table."""
    made = [0, 0, 0]
    at = [0, 0, 0]
    for write in device_writes(device)[9:]:
        if write.register == 0:
            motor = write.value >> 6
            index = TABLE.index(write.value & 0x3F)
            change = (index - at[motor] + 4) % 8 - 4
            assert abs(change) == 1, "a byte that is no neighbour of the one before"
            made[motor] += change
            at[motor] = index
    return tuple(made)


def test_host_stands_still_for_200_ms() -> None:
    blocks = curve(260, 3200, 20)
    device = device_for(PHASES)
    stream = Stream(device, blocks)
    stream.fill()
    device.start()
    for _ in range(3):
        stream.run(120 * MS)
        stream.run(200 * MS, sending=False)
    stream.finish()
    status = device.ask()
    assert (status.ended, status.late_ticks, status.dry_queues) == (c.ENDED_TARGET, 0, 0)
    assert stream.restarts == 0
    leader = [w.cycle for w in device_writes(device) if w.register == 0 and w.value >> 6 == 0]
    assert {b - a for a, b in pairwise(leader[1:])} <= {3200, 3201}


def test_motion_held_in_the_queue() -> None:
    """Blocks of 4 ms: a quarter of a second."""
    blocks = curve(120, 3200, 20)
    device = device_for(PHASES)
    stream = Stream(device, blocks)
    stream.fill()
    held = device.ask().last
    assert held * 4 >= 250
    device.start()
    stream.finish()


def test_blocks_shorter_than_their_decoding() -> None:
    """The queue waits for each of them, and goes on at once: never for a turn of the timer."""
    blocks = [
        Block((1, 1, 1), (Piece(1, interval * 256),), 1000, 255 << 16, 1, ends_at_rest=False)
        for interval in range(2000, 6000, 50)
    ]
    device = device_for(PHASES)
    device.push([*blocks[:-1], blocks[-1]._replace(ends_at_rest=True)])
    device.start()
    assert device.stand_still().ended == c.ENDED_TARGET
    leader = [w.cycle for w in device_writes(device) if w.register == 0 and w.value >> 6 == 0]
    assert max(b - a for a, b in pairwise(leader[1:])) < 20_000


def test_damaged_frames_never_move_a_motor() -> None:
    blocks = curve(1500, 2600, 24, seed=3)
    device = device_for(PHASES)
    stream = Stream(device, blocks, damage_every=40)
    stream.fill()
    device.start()
    stream.finish()
    status = device.ask()
    assert (status.ended, status.late_ticks, status.dry_queues) == (c.ENDED_TARGET, 0, 0)
    assert stream.resent > 5
    wanted = tuple(int(n) for n in np.sum([b.steps for b in blocks], axis=0))
    assert steps_made(device) == wanted
    assert status.place.serial == status.last == len(blocks)
    assert device.stack_free() > 40
