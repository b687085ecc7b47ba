"""Clock lines on the pins: a pulse and its pause are never shorter than the drive needs."""

from itertools import pairwise

import pytest

from fraese.blocks import Block, Piece
from fraese.motor.bridge import constants as c
from fraese.motor.cards.stepdir import STEPDIR_PROFILES
from fraese.motor.seams import DATA
from tests.bridge.device import Device, reason_to_skip
from tests.bridge.peers import clock_kind, device_for, device_writes

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

#: Clock of the first motor in the data byte.
CLOCK = 0b10
#: The two bytes of a change of levels are written so far apart.
WRITING_CYCLES = 4


def block(*pieces: Piece, minor: int = 0) -> Block:
    """The first motor, with another one beside it."""
    ticks = sum(piece.ticks for piece in pieces)
    return Block((ticks, minor, 0, 0), pieces, accel_q=1000, jump_rate_q8=255 << 16)


def levels_cycles(device: Device) -> tuple[list[int], list[int]]:
    """How long the clock was up, each time, and how long down between."""
    data = [w for w in device_writes(device) if w.register == DATA]
    turns = [data[0]]
    for write in data:
        if (write.value ^ turns[-1].value) & CLOCK:
            turns.append(write)
    gaps = [(after.cycle - before.cycle, before.value) for before, after in pairwise(turns[1:])]
    rest = data[0].value & CLOCK
    return [n for n, v in gaps if v & CLOCK != rest], [n for n, v in gaps if v & CLOCK == rest]


@pytest.mark.parametrize("minor", [0, 37])
@pytest.mark.parametrize("share", [1.1, 1.5, 1.9])
def test_above_the_top_rate_of_a_drive(minor: int, share: float) -> None:
    """Slower than planned, but whole: steady, on a ramp, and from a long interval to a short."""
    pulse_cycles = STEPDIR_PROFILES["x4step"].pulse_cycles
    interval = round(share * pulse_cycles)
    device = device_for(clock_kind("x4step"))
    device.push(
        [
            block(Piece(80, interval * 256), minor=minor),
            block(Piece(40, 2 * interval * 256, -6 * interval), minor=-minor),
            block(Piece(1, 20_000 * 256), Piece(80, interval * 256), minor=minor),
        ]
    )
    device.start()
    assert device.stand_still().ended == c.ENDED_TARGET
    up_cycles, down_cycles = levels_cycles(device)
    assert (len(up_cycles), len(down_cycles)) == (201, 200)
    assert min(up_cycles) >= pulse_cycles - WRITING_CYCLES
    assert min(down_cycles) >= pulse_cycles - WRITING_CYCLES
