"""The bridge tried out: nothing moves unless it is asked for.

Rule 1: a check is a name, whether it went well, and what was seen; the first one that cannot even
        be tried ends the list.
Rule 2: blocks that are only stored never move anything: a run begins with START.
"""

import json
import statistics
from collections.abc import Iterator
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from fraese.assembly import tracing
from fraese.assembly.drivers import planned_driver
from fraese.blocks import CYCLES_PER_S, Q8, Block, Piece, accel_q_from_hz_s, rate_q8_from_hz
from fraese.cli.bridgeplace import Place
from fraese.cli.output import note, say
from fraese.config import Config
from fraese.errors import PortError
from fraese.kinds.card import card_kind
from fraese.motor.bridge.codec import frame
from fraese.motor.bridge.constants import KIND_PING
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.trial import round_trips_s
from fraese.motor.clock import MonotonicClock
from fraese.motor.pins import STATUS_PINS, levels
from fraese.motor.seams import Card, IdleLevel, StepDriver
from fraese.motor.waveform import Waveform
from fraese.phrases import phrase, shown, spoken

_DAMAGED_FRAMES: Final = 16
#: A slower answer than this means that something is wrong with the line.
_SLOW_S: Final = 0.05
_BLOCK_S: Final = 0.004


class Check(NamedTuple):
    """One thing that was tried."""

    name: str
    ok: bool
    seen: str


def tried(place: Place, move_steps: int, trace: Path | None, *, as_json: bool) -> int:
    """Try it out, and say what was seen; the exit code.

    Args:
        place: where it is.
        move_steps: so far each motor is moved there and back.
        trace: waveform of these moves; None: none.
        as_json: all of it as one array, at the end.

    Raises:
        FraeseError: it cannot even be tried.
    """
    checks = []
    for check in _checks(place, move_steps, trace):
        checks.append(check)
        if not as_json:
            mark = spoken("ok") if check.ok else spoken("failed")
            say(f"{mark:6}  {shown(check.name)}: {shown(check.seen)}")
    if as_json:
        say(json.dumps([check._asdict() for check in checks]))
    return 0 if all(check.ok for check in checks) else PortError.exit_code


def _checks(place: Place, move_steps: int, trace: Path | None) -> Iterator[Check]:
    wanted = tracing.wanted(place.config, trace)
    waveform = wanted.begin() if wanted else None
    kind, clock = card_kind(place.config), MonotonicClock()
    card = kind.make(place.config)
    facts = kind.facts(card, place.config.card.kind)
    with (
        tracing.closed_on_failure(waveform),
        closing(
            BridgeDriver(place.line, card, clock, name=place.device, baud=place.baud, facts=facts)
        ) as driver,
    ):
        hello = driver.session.hello
        yield Check(
            phrase("greeting"),
            True,
            phrase(
                "{board}, firmware {firmware}.{firmware_2}",
                board=hello.board,
                firmware=hello.firmware[0],
                firmware_2=hello.firmware[1],
            ),
        )
        for check in (_answers, _damage, _inputs, partial(_queue, motors=card.motors)):
            yield check(driver)
        if waveform:
            yield from _traced_moves(driver, card, place.config, move_steps, waveform)
        elif move_steps:
            yield from _moves(driver, place.config, move_steps)


def _answers(driver: BridgeDriver) -> Check:
    trips_s = round_trips_s(driver.session)
    median_s, slowest_s = statistics.median(trips_s), max(trips_s)
    seen = phrase(
        "median {median_s:.1f} ms, slowest {slowest_s:.1f} ms",
        median_s=median_s * 1000,
        slowest_s=slowest_s * 1000,
    )
    return Check(phrase("answers"), slowest_s < _SLOW_S, seen)


def _damage(driver: BridgeDriver) -> Check:
    """Frames with one wrong bit each: none may count, and all must be noticed."""
    session = driver.session
    before = session.ask()
    sound = frame(KIND_PING, before.ack.next_seq, bytes(4))
    for number in range(_DAMAGED_FRAMES):
        damaged = bytearray(sound)
        # Within kind, number, payload and checksum; a flipped bit makes no reserved byte of these.
        damaged[1 + number % (len(sound) - 2)] ^= 1 << number % 3
        session.line.write(bytes(damaged))
        session.pump(_SLOW_S / 10)
    after = session.ask()
    noticed = (after.line_errors - before.line_errors) & 0xFF
    counted = (after.ack.next_seq - before.ack.next_seq) & 0xFF
    seen = phrase(
        "{damaged_frames} damaged frames sent, {noticed} noticed, {counted} taken",
        damaged_frames=_DAMAGED_FRAMES,
        noticed=noticed,
        counted=counted,
    )
    return Check(phrase("damage"), noticed == _DAMAGED_FRAMES and not counted, seen)


def _inputs(driver: BridgeDriver) -> Check:
    register = driver.poll(0).inputs
    pins = ", ".join(
        f"{pin} {spoken('high') if high else spoken('low')}"
        for pin, high in levels(register, STATUS_PINS).items()
    )
    return Check(
        phrase("inputs"),
        True,
        phrase("register {register:02X}; pins {pins}", register=register, pins=pins),
    )


def _queue(driver: BridgeDriver, motors: int) -> Check:
    """Fill the queue with usual blocks, without starting them, and drop them again."""
    session, number = driver.session, 0
    while driver.push(_contour_block(number, motors)):
        number += 1
    session.pump_until(lambda: session.link.is_quiet)
    stored = session.ask().last
    driver.flush()
    dropped = driver.poll(0)
    seen = phrase(
        "{stored} blocks of {block_s:g} ms stored, {stored_2:.0f} ms",
        stored=stored,
        block_s=_BLOCK_S * 1000,
        stored_2=stored * _BLOCK_S * 1000,
    )
    return Check(phrase("queue"), stored > 0 and not dropped.queued and not dropped.running, seen)


def _contour_block(number: int, motors: int) -> Block:
    """A short line of all axes at a rate that changes: what a contour is made of."""
    ticks = 20 + number % 3
    interval_q8 = round(_BLOCK_S * CYCLES_PER_S / ticks * Q8) + number % 50 * Q8
    return Block(
        steps=(ticks, -(number % 17), number % 5, -(number % 3))[:motors],
        pieces=(Piece(ticks, interval_q8, -(number % 90)),),
        accel_q=accel_q_from_hz_s(40_000),
        jump_rate_q8=rate_q8_from_hz(1000),
        weight=1000,
        ends_at_rest=False,
    )


def _traced_moves(
    driver: BridgeDriver, card: Card, config: Config, steps: int, waveform: Waveform
) -> Iterator[Check]:
    drawn, trace = planned_driver(driver, waveform, card, MonotonicClock())
    try:
        yield from _moves(drawn, config, steps)
    finally:
        trace.close()
        note(waveform.sentence())


def _moves(driver: StepDriver, config: Config, steps: int) -> Iterator[Check]:
    axes = config.axes.table
    for motor, (name, axis) in enumerate(axes.items()):
        rate_hz = axis.start_rate_hz
        before = driver.poll(0).travelled_steps[motor]
        for signed in (steps, -steps):
            ways = tuple(signed if each == motor else 0 for each in range(len(axes)))
            law = (Piece(steps, round(CYCLES_PER_S / rate_hz * Q8)),)
            driver.push(Block(steps=ways, pieces=law, jump_rate_q8=rate_q8_from_hz(rate_hz)))
        while (report := driver.poll(0.1)).running:
            pass
        made = report.travelled_steps[motor] - before
        yield Check(
            phrase("motor {name}", name=name.upper()),
            made == 2 * steps,
            phrase("{made} steps made, {value}", made=made, value=report.ended.value),
        )
    driver.idle(IdleLevel.OFF)
