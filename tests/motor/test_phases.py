"""Tables and codes of the phase-current card."""

import pytest

from fraese.motor.phases import (
    LEVEL_MAPS,
    MOTRUN,
    MOTZERO,
    PHASE_TABLES,
    currents_of,
    field_angle,
    holding_table,
    motor_bits,
)

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
