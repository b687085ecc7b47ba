"""Phase currents of the SMC800/SMC1500: tables, codes and levels.

The data byte, as the card reads it (seed, field):

      7    6  |  5    4    3  |  2    1    0
    +----+----+----+----+----+----+----+----+
    |  motor  | dir|  code B | dir|  code A |       dir 1 = negative current
    +----+----+----+----+----+----+----+----+       code 00 = 100 %, 11 = 0 %

Rule 1: the bytes of a table are what is sent. No level map ever changes them.
Rule 2: what a code means in per cent comes from one map, and only two things use it: what is
        printed, and which code is chosen for a wanted holding current.
Rule 3: a new table is one new row in ``PHASE_TABLES``.
Rule 4: a table is one electrical turn: every entry turns the field the same way, and the last one
        leads back to the first. Its length is all that says how far one step goes.
"""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Final, NamedTuple

from fraese.phrases import phrase

#: Both phases without current; OR-ed with the motor bits (seed: MOTZERO).
MOTZERO: Final = 0x1B

#: Half-step drive table, one entry per half-step (seed: MOTRUN), byte for byte.
MOTRUN: Final = bytes.fromhex("03 09 38 29 27 2D 1C 0D")

#: The tables that can be named in the configuration. The field's half-step tables run in the
#: same direction as the seed's from four places further on.
PHASE_TABLES: Final[Mapping[str, bytes]] = {
    "motrun": MOTRUN,
    "field-60": bytes.fromhex("2F 2D 1D 0D 0B 09 39 29"),
    "field-20": bytes.fromhex("37 36 1E 16 13 12 3A 32"),
    "full-step": bytes.fromhex("09 29 2D 0D"),
}

#: Per cent of the maximum current for each of the four codes. The two maps contradict each other
#: in the middle. Three programs of the field and the fixed levels of the driver chips say that
#: 01 is 60 %, and only so does the seed's own table give an even torque: it uses code 01 where
#: both phases are on. The seed's comment says the opposite.
LEVEL_MAPS: Final[Mapping[str, tuple[int, int, int, int]]] = {
    "field": (100, 60, 20, 0),
    "seed": (100, 20, 60, 0),
}

#: Half-steps in one electrical turn; a motor makes four full steps in it.
TURN_STEPS: Final = 8
FULL_STEPS_A_TURN: Final = 4
#: What motors are made with: 1.8 and 0.9 degrees a full step.
FULL_STEPS_PER_REV: Final = (200, 400)

#: How steps of these parts of a full step are called.
_STEP_WORDS: Final[Mapping[Fraction, str]] = {
    Fraction(1): phrase("full step"),
    Fraction(2): phrase("half-step"),
    Fraction(4): phrase("quarter-step"),
}
#: What an entry may turn the field by, in parts of the mean: four levels make no finer angles.
_EVEN: Final = (0.5, 1.5)
_SHORTEST_TABLE: Final = 3

#: Angles are whole parts of a half-step, so that they add up without rounding.
_ANGLE_PARTS: Final = 1 << 20
_CODE_OFF: Final = 0b11
_MOTOR_SHIFT: Final = 6


def motor_bits(socket: int) -> int:
    """The two high bits that name a motor's socket: X 0x00, Y 0x40, Z 0x80."""
    return socket << _MOTOR_SHIFT


class Currents(NamedTuple):
    """Signed currents of both phases, in per cent of the maximum."""

    a_percent: int
    b_percent: int


def currents_of(byte: int, levels: tuple[int, int, int, int]) -> Currents:
    """Decode the six low bits of a data byte."""

    def one(bits: int) -> int:
        level = levels[bits & 0b11]
        return -level if bits & 0b100 else level

    return Currents(a_percent=one(byte & 0b111), b_percent=one(byte >> 3 & 0b111))


def field_angle(byte: int, levels: tuple[int, int, int, int]) -> float | None:
    """Where the stator field points, in half-steps of one electrical turn: 0 <= angle < 8.

    Rises with the index of ``MOTRUN``, whose first entry is angle 0. None without current.
    """
    a_percent, b_percent = currents_of(byte, levels)
    if not a_percent and not b_percent:
        return None
    return exact_angle(math.atan2(a_percent, b_percent) * 4 / math.pi) % TURN_STEPS


def exact_angle(angle: float) -> float:
    """The nearest angle of which sums and differences are exact."""
    return round(angle * _ANGLE_PARTS) / _ANGLE_PARTS


def sense_of_table(table: bytes, levels: tuple[int, int, int, int]) -> int:
    """Which way a table without fault turns the field: 1 as ``MOTRUN`` does, -1 against it."""
    first, second = (field_angle(byte, levels) or 0.0 for byte in table[:2])
    return 1 if _short_way(second - first) > 0 else -1


def parts_of_full_step(table: bytes) -> Fraction:
    """How many steps of a table make one full step of the motor: 2 for half-steps."""
    return Fraction(len(table), FULL_STEPS_A_TURN)


def step_word(table: bytes) -> str:
    """What one step of a table is called: half-step, 1/8 step."""
    parts = parts_of_full_step(table)
    return _STEP_WORDS.get(parts, f"{1 / parts} step")


def steps_per_rev(table: bytes, full_steps: int = FULL_STEPS_PER_REV[0]) -> Fraction:
    """Steps of a table in one turn of a motor with so many full steps."""
    return full_steps * parts_of_full_step(table)


def describe_table(table: bytes) -> str:
    """What a table is, for people."""
    full_steps = FULL_STEPS_PER_REV[0]
    return phrase(
        "{count} entries: {step_word}s, {steps_per_rev:g} steps_per_rev for a"
        " {full_steps}-step motor",
        count=len(table),
        step_word=step_word(table),
        steps_per_rev=float(steps_per_rev(table)),
        full_steps=full_steps,
    )


def fault_of_table(table: bytes, levels: tuple[int, int, int, int]) -> str:
    """Why a motor cannot turn by this table, half a sentence; empty if it can.

    Args:
        table: drive table, one electrical turn.
        levels: the level map, one row of ``LEVEL_MAPS``.
    """
    if len(table) < _SHORTEST_TABLE:
        return phrase("{count} entries do not say which way the field turns", count=len(table))
    angles = [field_angle(byte, levels) for byte in table]
    if None in angles:
        return phrase("{entry} gives no current", entry=_entry(table, angles.index(None)))
    known = [angle for angle in angles if angle is not None]
    nexts = known[1:] + known[:1]
    turns = [_short_way(after - before) for before, after in zip(known, nexts, strict=True)]
    return _fault_of_turns(table, turns)


def _fault_of_turns(table: bytes, turns: list[float]) -> str:
    """The same, from what the step behind each entry turns the field by."""
    forward = sum(turn > 0 for turn in turns) * 2 >= len(turns)
    mean = TURN_STEPS / len(turns)
    for number, turn in enumerate(turns):
        step = phrase(
            "the step from {entry} to {entry_2}",
            entry=_entry(table, number),
            entry_2=_entry(table, (number + 1) % len(turns)),
        )
        if not turn:
            return phrase("{step} does not turn the field", step=step)
        if abs(turn) == TURN_STEPS / 2:
            return phrase("{step} is half a turn of the field: either way", step=step)
        if (turn > 0) != forward:
            return phrase("{step} turns the field back", step=step)
    rounds = round(abs(sum(turns)) / TURN_STEPS)
    if rounds != 1:
        return phrase("it turns the field round {rounds} times; a table is one turn", rounds=rounds)
    for number, turn in enumerate(turns):
        if not _EVEN[0] <= abs(turn) / mean <= _EVEN[1]:
            return phrase(
                "the step behind {entry} turns the field by {turn:.0f} degrees; all"
                " should be near {mean:.0f}",
                entry=_entry(table, number),
                turn=abs(turn) * 45,
                mean=mean * 45,
            )
    return ""


def _entry(table: bytes, number: int) -> str:
    return phrase("entry {number} ({table:02X})", number=number + 1, table=table[number])


def _short_way(turn: float) -> float:
    """A difference of two angles, in half-steps: above -4, up to 4."""
    half = TURN_STEPS / 2
    return half - (half - turn) % TURN_STEPS


def holding_table(table: bytes, wanted_percent: int, levels: tuple[int, int, int, int]) -> bytes:
    """The second command table of the seed: the same field directions, less current.

    Every phase that carries current gets the code whose level is nearest to ``wanted_percent``
    of what the drive table gives it; one that carries none stays off. Directions are kept, so a
    motor does not move when it changes to holding.

    Args:
        table: drive table, six bits an entry.
        wanted_percent: holding current, 0 to 100.
        levels: the level map, one row of ``LEVEL_MAPS``.
    """

    def code_for(code: int) -> int:
        if code == _CODE_OFF:
            return code
        wanted = levels[code] * wanted_percent / 100
        return min(range(4), key=lambda other: (abs(levels[other] - wanted), levels[other]))

    def hold(byte: int) -> int:
        a_code, b_code = code_for(byte & 0b11), code_for(byte >> 3 & 0b11)
        return byte & 0b100100 | b_code << 3 | a_code

    return bytes(hold(byte) for byte in table)
