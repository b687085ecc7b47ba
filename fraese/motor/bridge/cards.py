"""What a card is, as the device wants to be told: tables and one fixed payload.

Rule 1: facts only, of any card; the two kinds that there are differ in ``kind``, no code does.
"""

import struct
from dataclasses import dataclass
from math import log
from typing import Final

from fraese.blocks import CYCLES_PER_S
from fraese.motor.bridge.constants import (
    CARD_LENGTH,
    CARD_PHASES,
    KIND_CARD,
    KIND_POWER,
    KIND_TABLE,
    MOTORS_MAX,
    POWER_HIGH,
    TABLE_DRIVE,
    TABLE_HOLD,
    TABLE_MAX,
    TABLE_MIN,
)
from fraese.motor.seams import HALF_Q16

_FORMAT: Final = struct.Struct("<7B4BB8B2B4B2BHHHLBBBHH")


#: Data bits of clock and direction where every motor is in the socket of its number.
CLOCK_LINES: Final = (0x03, 0x0C, 0x30, 0xC0)


@dataclass(frozen=True, slots=True)
class Line:
    """Bits of the control register, and their value when the line is on."""

    mask: int = 0
    on: int = 0


@dataclass(frozen=True, slots=True)
class Lamp:
    """Pulses that set the power of what hangs on an output (a laser).

    Attributes:
        rate: a key of ``PULSE_RATES_HZ``.
        high: the pin is high while they are on.
    """

    rate: int
    high: bool = True


#: Pulses a second, by their number on the line: 16 MHz over 256 counts and a divisor.
PULSE_RATES_HZ: Final = {
    rate: CYCLES_PER_S / 256 / divisor
    for rate, divisor in enumerate((1, 8, 32, 64, 128, 256, 1024), start=1)
}


def nearest_rate(pulses_hz: float) -> int:
    """Number of the rate that is nearest, in proportion."""
    return min(PULSE_RATES_HZ, key=lambda rate: abs(log(PULSE_RATES_HZ[rate] / pulses_hz)))


@dataclass(frozen=True, slots=True)
class CardFacts:
    """A card for the device; the fields are those of the protocol's CARD.

    Attributes:
        kind: ``CARD_PHASES`` or ``CARD_CLOCKS``.
        motors: 1 to 4.
        table: drive table, low six bits of the data byte; empty with clock and direction.
        hold: hold table of the same length, or empty: no holding current.
        control_rest: control register at rest.
        strobe: control bits of the strobe.
        clock_rest: data bits that are 1 when clocks rest.
        forward_high: direction lines are 1 for positive steps.
        active, boost: lines that show that motors run, and that they are in a ramp.
        outputs: free outputs, in the order of their bits.
        safe: outputs that are off at standstill.
        enable: outputs that carry the drives' enable.
        motor_bits: data bits of every motor: 6 and 7 of a phase card, else clock and direction.
        off: low six bits without current.
        pulse_cycles, setup_cycles, beat_cycles, settle_cycles: times in cycles.
        switch_mask, switch_value: contact, as the status register reads.
        readings: that make or end a contact.
        silence_ms: longest silence of the host; 0: no limit.
        duty_q16: share of its interval for which a clock is away from rest, 1/65536.
        lamp: pulses of a power; its output is none of ``outputs`` that has a line; None: none.
    """

    kind: int
    motors: int
    table: bytes = b""
    hold: bytes = b""
    control_rest: int = 0
    strobe: int = 0
    clock_rest: int = 0
    forward_high: bool = True
    active: Line = Line()
    boost: Line = Line()
    outputs: tuple[Line, ...] = ()
    safe: int = 0
    enable: int = 0
    motor_bits: tuple[int, ...] = (0x00, 0x40, 0x80, 0xC0)
    off: int = 0x1B
    pulse_cycles: int = 0
    setup_cycles: int = 0
    beat_cycles: int = 0
    settle_cycles: int = 0
    switch_mask: int = 0x80
    switch_value: int = 0
    readings: int = 3
    silence_ms: int = 0
    duty_q16: int = HALF_Q16
    lamp: Lamp | None = None


def card_payload(facts: CardFacts) -> bytes:
    """The payload of CARD.

    Raises:
        ValueError: if a table has a length that the device does not take.
    """
    length = len(facts.table)
    if facts.kind == CARD_PHASES and not TABLE_MIN <= length <= TABLE_MAX:
        raise ValueError(f"a phase table of {length} entries; {TABLE_MIN} to {TABLE_MAX}")
    outputs = [n for line in facts.outputs for n in (line.mask, line.on)]
    bits = facts.motor_bits + (0,) * MOTORS_MAX
    payload = _FORMAT.pack(
        facts.kind, facts.motors, length, facts.control_rest, facts.strobe, facts.clock_rest,
        facts.forward_high,
        facts.active.mask, facts.active.on, facts.boost.mask, facts.boost.on,
        len(facts.outputs), *(outputs + [0] * 8)[:8],
        facts.safe, facts.enable, *bits[:MOTORS_MAX], facts.off, bool(facts.hold),
        facts.pulse_cycles, facts.setup_cycles, facts.beat_cycles, facts.settle_cycles,
        facts.switch_mask, facts.switch_value, facts.readings, facts.silence_ms,
        facts.duty_q16,
    )  # fmt: skip
    assert len(payload) == CARD_LENGTH
    return payload


def card_commands(facts: CardFacts) -> list[tuple[int, bytes]]:
    """Kind and payload of the commands that upload a card, in order."""
    tables = ((TABLE_DRIVE, facts.table), (TABLE_HOLD, facts.hold))
    commands = [(KIND_TABLE, bytes((which,)) + table) for which, table in tables if table]
    commands.append((KIND_CARD, card_payload(facts)))
    if facts.lamp is not None:
        how = facts.lamp.rate | (POWER_HIGH if facts.lamp.high else 0)
        commands.append((KIND_POWER, bytes((how,))))
    return commands
