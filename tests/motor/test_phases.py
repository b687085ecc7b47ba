"""Tables and codes of the phase-current card."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.errors import ConfigError
from fraese.kinds.card import card_of
from fraese.motor.phases import (
    LEVEL_MAPS,
    MOTRUN,
    MOTZERO,
    PHASE_TABLES,
    currents_of,
    describe_table,
    fault_of_table,
    field_angle,
    holding_table,
    motor_bits,
    step_word,
    steps_per_rev,
)
from tests.helpers import configured

FIELD, SEED = LEVEL_MAPS["field"], LEVEL_MAPS["seed"]


def test_the_seed_s_bytes() -> None:
    assert list(MOTRUN) == [0x03, 0x09, 0x38, 0x29, 0x27, 0x2D, 0x1C, 0x0D]
    assert MOTZERO == 0x1B
    assert [motor_bits(motor) for motor in range(3)] == [0x00, 0x40, 0x80]


@pytest.mark.parametrize("levels", [FIELD, SEED])
def test_the_field_turns_by_one_half_step_an_index(levels: tuple[int, int, int, int]) -> None:
    assert [field_angle(byte, levels) for byte in MOTRUN] == list(range(8))


@pytest.mark.parametrize(
    ("name", "turn"), [("field-60", 1), ("field-20", 1), ("motrun", 1), ("full-step", 2)]
)
def test_every_table_turns_evenly(name: str, turn: int) -> None:
    angles = [field_angle(byte, FIELD) for byte in PHASE_TABLES[name]]
    assert None not in angles
    known = [angle for angle in angles if angle is not None]
    assert {(b - a) % 8 for a, b in zip(known, known[1:] + known[:1], strict=True)} == {turn}


def test_no_current_has_no_direction() -> None:
    assert field_angle(MOTZERO, FIELD) is None
    assert field_angle(0x3F, FIELD) is None


def test_signs_match_the_bits() -> None:
    assert currents_of(0x38, FIELD) == (100, 0)
    assert currents_of(0x27, FIELD) == (0, -100)
    assert currents_of(0x2D, FIELD) == (-60, -60)
    assert currents_of(0x2D, SEED) == (-20, -20)
    assert currents_of(0xC0 | 0x09, FIELD) == currents_of(0x09, FIELD)


@pytest.mark.parametrize("levels", [FIELD, SEED])
@pytest.mark.parametrize("table", PHASE_TABLES.values(), ids=PHASE_TABLES)
@pytest.mark.parametrize("percent", range(0, 101, 5))
def test_holding_keeps_the_angle(
    table: bytes, percent: int, levels: tuple[int, int, int, int]
) -> None:
    for drive, hold in zip(table, holding_table(table, percent, levels), strict=True):
        assert field_angle(hold, levels) in (field_angle(drive, levels), None)
        full, held = currents_of(drive, levels), currents_of(hold, levels)
        assert all(abs(h) <= max(levels[k] for k in range(4)) for h in held)
        assert all(h == 0 for f, h in zip(full, held, strict=True) if f == 0)


def test_holding_at_full_current_is_the_drive_table_and_at_none_is_off() -> None:
    assert holding_table(MOTRUN, 100, FIELD) == MOTRUN
    assert all(field_angle(byte, FIELD) is None for byte in holding_table(MOTRUN, 0, FIELD))


def test_holding_uses_the_nearest_level() -> None:
    held = holding_table(MOTRUN, 20, FIELD)
    assert currents_of(held[2], FIELD) == (20, 0)
    assert currents_of(held[1], FIELD) == (20, 20)
    held = holding_table(MOTRUN, 60, FIELD)
    assert currents_of(held[2], FIELD) == (60, 0)


# --- tables that are given -----------------------------------------------------------------------

#: Code by level in per cent, with ``field``.
_CODES = {100: 0b00, 60: 0b01, 20: 0b10, 0: 0b11}


def byte_of(a_percent: int, b_percent: int) -> int:
    """The six bits that give these currents."""
    a, b = (_CODES[abs(level)] | 4 * (level < 0) for level in (a_percent, b_percent))
    return b << 3 | a


def four_quadrants(first: list[tuple[int, int]]) -> bytes:
    """A table from the pairs (a, b) of its first quarter."""
    table, pairs = [], first
    for _ in range(4):
        table += [byte_of(a, b) for a, b in pairs]
        pairs = [(b, -a) for a, b in pairs]
    return bytes(table)


QUARTERS = four_quadrants([(0, 100), (20, 60), (100, 100), (60, 20)])
EIGHTHS = four_quadrants(
    [(0, 100), (20, 100), (20, 60), (60, 100), (60, 60), (100, 60), (60, 20), (100, 20)]
)


@pytest.mark.parametrize("levels", [FIELD, SEED], ids=["field", "seed"])
@pytest.mark.parametrize("reversed_sense", [False, True])
@pytest.mark.parametrize("table", PHASE_TABLES.values(), ids=PHASE_TABLES)
def test_every_table_with_a_name_is_without_fault(
    table: bytes, reversed_sense: bool, levels: tuple[int, int, int, int]
) -> None:
    assert fault_of_table(table[::-1] if reversed_sense else table, levels) == ""


@pytest.mark.parametrize("table", [QUARTERS, EIGHTHS, EIGHTHS[::-1], QUARTERS[5:] + QUARTERS[:5]])
def test_so_are_finer_ones_as_fine_as_four_levels_make_them(table: bytes) -> None:
    assert fault_of_table(table, FIELD) == ""


@pytest.mark.parametrize(
    ("table", "fault"),
    [
        (bytes([0x03] * 8), "the step from entry 1 (03) to entry 2 (03) does not turn the field"),
        (MOTRUN + MOTRUN, "it turns the field round 2 times; a table is one turn"),
        (MOTRUN[:7], "the step behind entry 7 (1C) turns the field by 90 degrees; all should be"),
        (MOTRUN[:3] + bytes([MOTZERO]) + MOTRUN[4:], "entry 4 (1B) gives no current"),
        (bytes([MOTRUN[0], MOTRUN[4]]), "2 entries do not say which way the field turns"),
        (MOTRUN[:4] + MOTRUN[:4], "turns the field back"),
        (bytes([*MOTRUN[:2], MOTRUN[3], MOTRUN[2], *MOTRUN[4:]]), "turns the field back"),
        (bytes([MOTRUN[0], MOTRUN[4], *MOTRUN[5:]]), "is half a turn of the field: either way"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.hex(),
)
def test_a_table_by_which_no_motor_turns(table: bytes, fault: str) -> None:
    assert fault in fault_of_table(table, FIELD)
    with pytest.raises(ConfigError, match=r"card\.table \(\d+ entries: .* once round"):
        card_of(configured(card={"table": table.hex(" ")}))


def test_with_the_other_map_of_levels_a_fine_table_runs_to_and_fro() -> None:
    assert "turns the field back" in fault_of_table(EIGHTHS, SEED)
    with pytest.raises(ConfigError, match=r"with card\.levels seed"):
        card_of(configured(card={"table": EIGHTHS.hex(), "levels": "seed"}))


@given(table=st.binary(min_size=1, max_size=32))
def test_a_table_without_fault_turns_one_way_once_round(table: bytes) -> None:
    if fault_of_table(table, FIELD):
        return
    angles = [field_angle(byte, FIELD) or 0.0 for byte in table]
    turns = [(b - a + 4) % 8 - 4 for a, b in zip(angles, angles[1:] + angles[:1], strict=True)]
    assert abs(sum(turns)) == pytest.approx(8)
    assert len({turn > 0 for turn in turns}) == 1


@pytest.mark.parametrize(
    ("table", "word", "per_rev"),
    [
        (PHASE_TABLES["full-step"], "full step", 200),
        (MOTRUN, "half-step", 400),
        (QUARTERS, "quarter-step", 800),
        (EIGHTHS, "1/8 step", 1600),
        (bytes(12), "1/3 step", 600),
        (bytes(5), "4/5 step", 250),
    ],
)
def test_a_table_says_what_it_is(table: bytes, word: str, per_rev: int) -> None:
    assert step_word(table) == word
    assert steps_per_rev(table) == per_rev
    assert steps_per_rev(table, 400) == Fraction(2 * per_rev)
    assert describe_table(table) == (
        f"{len(table)} entries: {word}s, {per_rev} steps_per_rev for a 200-step motor"
    )
