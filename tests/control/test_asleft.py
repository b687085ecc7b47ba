"""After a crash: as left, or reference again."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.control.asleft import left_by_crash, take_as_left
from fraese.control.state import Status
from fraese.errors import StateError
from tests.helpers import STEPDIR, configured, crash, keep, kept


def machine(folder: Path, **sections: Any) -> Plant:
    return assemble(configured(**sections), state=folder)


def jogged(folder: Path, **sections: Any) -> Plant:
    """Referenced, and at X 10; its last record says in motion, and is of the place itself."""
    made = machine(folder, **sections)
    made.controller.home()
    assert made.controller.run() is Status.OK
    made.controller.jog("x", 10)
    assert made.controller.run() is Status.OK
    return made


def crashed_between(folder: Path, below: int, above: int, **sections: Any) -> Plant:
    """After a crash in motion that says so of X."""
    made = jogged(folder, **sections)
    crash(made)
    record = kept(folder)
    at = record["position_steps"]
    record["motion"] = {
        "low_steps": [at[0] - below, *at[1:]],
        "high_steps": [at[0] + above, *at[1:]],
    }
    keep(folder, record)
    return machine(folder, **sections)


@pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
def test_what_was_cut_short_at_its_place_is_taken_when_a_person_says_so(
    tmp_path: Path, card: dict[str, Any]
) -> None:
    crash(jogged(tmp_path, **card))
    again = machine(tmp_path, **card)
    state = again.controller.state()
    assert state.referenced == (False, False, False)
    (note,) = again.notes
    assert "take it as it was left (fraese trust)" in note
    take_as_left(again.controller)
    assert again.controller.state().referenced == (True, True, True)
    assert again.controller.state().position_mm == state.position_mm
    assert left_by_crash(again.controller) is None
    again.close()
    assert machine(tmp_path, **card).notes == ()


@pytest.mark.parametrize(("below", "above", "near"), [(3, 3, True), (4, 0, False), (0, 4, False)])
def test_only_what_the_motors_find_back_to_is_taken(
    tmp_path: Path, below: int, above: int, near: bool
) -> None:
    """Half an electrical turn is four half-steps: from there the field pulls both ways."""
    made = crashed_between(tmp_path, below, above)
    left = left_by_crash(made.controller)
    assert left is not None
    assert left.may_be_taken is near
    if near:
        take_as_left(made.controller)
        assert made.controller.state().referenced == (True, True, True)
        return
    with pytest.raises(StateError, match=r"from less than X 0\.020 Y 0\.020 Z 0\.020 mm"):
        take_as_left(made.controller)
    assert made.controller.state().referenced == (False, False, False)
    assert "reference it again." in left.sentence


def test_of_a_drive_the_shorter_turn_counts(tmp_path: Path) -> None:
    """4000 pulses a turn of 1.8 or 0.9 degrees: 40 or 80 of them are an electrical turn."""
    drive = {**STEPDIR, "axes": {"x": {"steps_per_rev": 4000}}}
    near = crashed_between(tmp_path / "near", 19, 0, **drive)
    far = crashed_between(tmp_path / "far", 20, 0, **drive)
    assert [near.controller.position.finds_back, far.controller.position.finds_back] == [
        True,
        False,
    ]


def test_an_axis_that_lost_its_reference_since_is_not_taken(tmp_path: Path) -> None:
    crash(jogged(tmp_path))
    again = machine(tmp_path)
    again.controller.position.lose_reference([1])
    take_as_left(again.controller)
    assert again.controller.state().referenced == (True, False, True)


def test_a_doubt_of_before_keeps_what_was_referenced_then(tmp_path: Path) -> None:
    crash(jogged(tmp_path))
    again = machine(tmp_path)
    again.controller.jog("x", 1)
    assert again.controller.run() is Status.OK
    crash(again)
    third = machine(tmp_path)
    take_as_left(third.controller)
    assert third.controller.state().referenced == (True, True, True)
    assert third.controller.state().position_mm[0] == 11


def test_abandoned_at_rest_it_is_as_it_was_left_until_somebody_drives_it(tmp_path: Path) -> None:
    jogged(tmp_path).close()
    record = kept(tmp_path)
    assert not record["in_hand"]
    keep(tmp_path, {**record, "in_hand": True})
    again = machine(tmp_path)
    assert again.controller.state().referenced == (True, True, True)
    left = left_by_crash(again.controller)
    assert left is not None
    assert left.may_be_taken
    assert "pushed by X 0.020 Y 0.020 Z 0.020 mm or more, reference it" in left.sentence
    again.close()
    assert machine(tmp_path).notes == ()


def test_without_a_crash_there_is_nothing_to_take(tmp_path: Path) -> None:
    made = machine(tmp_path)
    with pytest.raises(StateError, match="nothing to take"):
        take_as_left(made.controller)


def test_nothing_is_taken_while_it_moves(tmp_path: Path) -> None:
    crash(jogged(tmp_path))
    again = machine(tmp_path)
    again.controller.jog("x", -1)
    assert again.controller.status is Status.RUN
    with pytest.raises(StateError, match="The machine runs"):
        take_as_left(again.controller)
    assert again.controller.position.doubt is not None
