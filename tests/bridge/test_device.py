"""What the firmware does on its own, and what it refuses."""

from dataclasses import replace

import pytest

from fraese.blocks import Block, Piece
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import frame, hello
from fraese.motor.phases import MOTRUN
from tests.bridge.device import MS, SESSION, Device, reason_to_skip
from tests.bridge.peers import (
    PHASES,
    clock_kind,
    device_for,
    device_writes,
    open_inputs,
    steady_cycles,
)

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

LINE = Block((400, 0, 0), (Piece(400, 8000 * 256),), 240 << 4, 128 << 11, ends_at_rest=True)
OFF = [0x1B, 0x5B, 0x9B]


def latched(device: Device) -> list[int]:
    """Data bytes since the card was uploaded."""
    return [w.value for w in device_writes(device) if w.register == 0]


def test_after_reset_no_motor_has_current() -> None:
    device = Device()
    writes = [w for w in device_writes(device) if w.cycle < 20 * MS]
    strobed = [
        writes[i - 1].value
        for i, w in enumerate(writes)
        if w.register == 2 and w.value & 1 and writes[i - 1].register == 0
    ]
    assert strobed == OFF
    assert writes[-1].register == 0
    assert writes[-1].value == 0


def test_hello_says_who_it_is() -> None:
    device = Device()
    assert device.hello is not None
    assert (device.hello.board, device.hello.version) == ("uno", c.PROTOCOL_VERSION)
    assert device.hello.session == SESSION
    assert device.hello.phase_cards
    assert device.hello.clock_cards


def test_a_reset_is_noticed() -> None:
    device = device_for(PHASES)
    device.avr.reset()
    device.run(30 * MS)
    status = device.ask()
    assert status.ack.session == 0
    assert not status.more & c.More.CARD
    device.avr.feed(hello(99))
    device.hello = None
    device.wait(lambda: device.hello is not None)
    assert device.hello is not None
    assert device.hello.session == 99
    assert device.hello.reset_reason & 2


def test_a_silent_host_while_moving() -> None:
    """Brake, motors off, the queue dropped."""
    kind = PHASES._replace(facts=replace(PHASES.facts, silence_ms=50))
    device = device_for(kind)
    device.push([LINE, LINE])
    device.start()
    device.run(600 * MS)
    status = device.ask()
    assert (status.ended, status.ack.epoch) == (c.ENDED_SILENCE, 1)
    assert not status.state & (c.State.MOVING | c.State.ENERGISED)
    assert not status.state & c.State.TORN
    assert latched(device)[-3:] == OFF
    assert 0 < status.place.done < 400
    assert status.last == 2


def test_goodbye_while_moving_switches_off_at_once() -> None:
    device = device_for(PHASES)
    device.push([LINE, LINE])
    device.start()
    device.run(60 * MS)
    assert device.ask().state & c.State.MOVING
    assert device.command(c.KIND_CLOSE) == 0
    device.run(5 * MS)
    assert latched(device)[-3:] == OFF
    written = len(device_writes(device))
    device.run(300 * MS)
    assert len(device_writes(device)) == written
    assert not device.ask().state & (c.State.MOVING | c.State.ENERGISED)


def test_what_is_refused() -> None:
    device = Device()
    assert device.command(c.KIND_START, b"\0") == c.REFUSED_NO_CARD
    assert device.command(0x3F) == c.REFUSED_KIND
    assert device.command(c.KIND_TABLE, b"\0\1") == c.REFUSED_PAYLOAD
    open_inputs(device)
    device.upload(PHASES.facts)
    assert device.command(c.KIND_BLOCKS, b"\7\1") == c.REFUSED_EPOCH
    device.push([LINE])
    device.start()
    device.run(20 * MS)
    assert device.command(c.KIND_FLUSH) == c.REFUSED_MOVING
    assert device.command(c.KIND_IDLE, b"\0") == c.REFUSED_MOVING
    assert device.stand_still().ended == c.ENDED_TARGET


def test_a_block_that_does_not_add_up_stops_the_run() -> None:
    device = device_for(PHASES)
    broken = bytes((7, c.DRY_NONE, 0x41, 0x01, 100, 0x01 | 3 << 2, 99, 0, 40))
    # The answer says so already if the block was read before it went out.
    assert device.command(c.KIND_BLOCKS, b"\0" + broken) in (0, c.REFUSED_BLOCK)
    device.run(20 * MS)
    status = device.ask()
    assert status.ack.refused_code == c.REFUSED_BLOCK
    assert (status.ended, status.ack.epoch, status.ack.free) == (c.ENDED_STOP, 1, device.ring)


def test_frames_out_of_order_do_nothing() -> None:
    device = device_for(PHASES)
    ahead = frame(c.KIND_IDLE, device.sequence + 1, b"\1")
    before = len(device_writes(device))
    device.avr.feed(ahead)
    device.run(10 * MS)
    assert device.ack is not None
    assert device.ack.gap
    assert len(device_writes(device)) == before
    assert c.KIND_ACK in [f.kind for f in device.frames]


def test_idle_and_holding_current() -> None:
    hold = bytes(byte | 0x09 for byte in MOTRUN)
    device = device_for(PHASES._replace(facts=replace(PHASES.facts, hold=hold)))
    assert device.command(c.KIND_PHASES, bytes((1, 2, 3, 0))) == 0
    assert device.command(c.KIND_IDLE, b"\1") == 0
    assert latched(device)[-3:] == [hold[1], 0x40 | hold[2], 0x80 | hold[3]]
    assert device.command(c.KIND_IDLE, b"\0") == 0
    assert latched(device)[-3:] == OFF


def test_a_brake_at_standstill_holds_what_comes_next() -> None:
    device = device_for(PHASES)
    device.push([LINE])
    device.urgent(c.URGENT_BRAKE)
    device.run(5 * MS)
    device.start()
    status = device.ask()
    assert status.state & c.State.HELD
    assert status.brakes == 1
    assert device.command(c.KIND_RESUME) == 0
    assert device.stand_still().ended == c.ENDED_TARGET


@pytest.mark.parametrize("interval", [800, 1200, 2000, 4000, 9000, 30_000])
def test_direction_lines_are_steady_for_their_time_before_the_next_edge(interval: int) -> None:
    """On the pins, from the byte that turns them: not from when that byte was due."""
    kind = clock_kind("x4step")
    device = device_for(kind)
    law = (Piece(20, interval * 256),)
    turns = [(20 * sign, 7 * sign, -20 * sign, 0) for sign in (1, -1) * 6]
    device.push(
        [Block(steps, law, 1000, 255 << 16, weight=1, ends_at_rest=True) for steps in turns]
    )
    device.start()
    device.stand_still()
    steady = steady_cycles(device_writes(device))
    assert len(steady) == 20 * len(turns)
    assert min(steady) >= kind.facts.setup_cycles
