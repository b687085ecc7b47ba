"""What survives a restart, and what is not believed."""

import json
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.control.state import Status
from fraese.errors import ConfigError, StateError
from fraese.journal import Journal
from tests.helpers import STEPDIR, carriages, configured, crash, keep, kept, look, merged


def machine(folder: Path, **sections: Any) -> Plant:
    return assemble(configured(**sections), state=folder)


def moved(folder: Path, **sections: Any) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Home, move, set a zero, close; position and carriages."""
    made = machine(folder, **sections)
    made.controller.home()
    made.controller.run()
    made.controller.move_to({"x": 12.345, "y": 7, "z": -3.005})
    assert made.controller.run() is Status.OK
    made.controller.set_zero("x", 2)
    made.close()
    return made.controller.state().position_steps, carriages(made)


@pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
@pytest.mark.parametrize("backlash", [0.0, 0.1])
def test_the_next_command_goes_on_where_the_last_one_ended(
    tmp_path: Path, card: dict[str, Any], backlash: float
) -> None:
    sections = merged(
        card, {"axes": {"x": {"backlash_mm": backlash}}, "simulation": {"backlash_mm": backlash}}
    )
    position, at = moved(tmp_path, **sections)
    made = machine(tmp_path, **sections)
    state = made.controller.state()
    assert state.position_steps == position
    assert carriages(made) == at
    assert state.referenced == (True, True, True)
    assert state.work_mm[0] == pytest.approx(2)
    assert made.notes == ()
    made.controller.jog("x", -1)
    assert made.controller.run() is Status.OK
    # The phase index was kept: no rotor jumps when the current comes on.
    assert carriages(made)[0] == at[0] - 200
    assert look(made).lost_steps == (0, 0, 0)


def test_started_fresh_nothing_is_known(tmp_path: Path) -> None:
    moved(tmp_path)
    made = assemble(configured(), state=tmp_path, fresh=True)
    assert made.controller.state().position_steps == (0, 0, 0)
    assert made.controller.state().referenced == (False, False, False)


def test_what_ended_in_the_middle_is_shown_but_not_believed(tmp_path: Path) -> None:
    position, _ = moved(tmp_path)
    made = machine(tmp_path)
    made.recorder.before_motion()
    assert kept(tmp_path)["motion"] is not None
    crash(made)
    again = machine(tmp_path)
    assert again.controller.state().position_steps == position
    assert again.controller.state().referenced == (False, False, False)
    note = again.notes[0]
    assert "reference it again" in note
    assert "between X 12.340 and 12.350, Y" in note
    again.close()
    # The note stays, and so do the bounds, until the machine was referenced.
    assert kept(tmp_path)["motion"] is None
    later = machine(tmp_path)
    assert later.controller.state().referenced == (False, False, False)
    assert later.notes == (note,)
    later.controller.home()
    assert later.controller.run() is Status.OK
    later.close()
    last = machine(tmp_path)
    assert last.controller.state().referenced == (True, True, True)
    assert last.notes == ()


@pytest.mark.parametrize(
    "sections",
    [
        {"axes": {"x": {"pitch_mm": "3"}}},
        {"axes": {"x": {"inverted": True}}},
        {"axes": {"x": {"home_end": "max"}}},
        {"axes": {"z": {"travel_mm": "50"}}},
        {"axes": {"y": {"backlash_mm": "0.1"}}},
        {"homing": {"pull_off_mm": 3}},
        {"card": {"kind": "stepdir"}},
        {"card": {"table": "full-step"}},
    ],
    ids=str,
)
def test_steps_of_another_machine_are_forgotten(tmp_path: Path, sections: dict[str, Any]) -> None:
    moved(tmp_path)
    made = machine(tmp_path, **sections)
    assert "configured otherwise" in made.notes[0]
    assert made.controller.state().position_steps == (0, 0, 0)
    assert made.controller.state().referenced == (False, False, False)


EIGHTHS: dict[str, Any] = {
    "card": {"kind": "stepdir"},
    "axes": {name: {"steps_per_rev": 1600, "max_rate_hz": 8000} for name in "xyz"},
}


def make_older(folder: Path, half_steps_a_pulse: float) -> None:
    """As files were before the simulated mill had facts of its own: pulses, and no word of it."""
    older = kept(folder)
    drives = older["axes"][0].startswith("stepdir")
    older["axes"] = [word.partition(" on ")[0] for word in older["axes"]]
    older["simulation"] = [
        [position / half_steps_a_pulse, lost, 0.0 if drives else angle, slack / half_steps_a_pulse]
        for position, lost, angle, slack in older["simulation"]
    ]
    for name in ("motion", "doubt", "job", "session"):
        del older[name]
    for path in folder.glob("simulation.*"):
        path.unlink()
    (folder / "state.json").write_text(json.dumps(older))


@pytest.mark.parametrize(
    ("sections", "half_steps_a_pulse"), [({}, 1), (STEPDIR, 1), (EIGHTHS, 0.25)]
)
def test_an_older_file_is_taken_up_where_nothing_changed(
    tmp_path: Path, sections: dict[str, Any], half_steps_a_pulse: float
) -> None:
    position, at = moved(tmp_path, **sections)
    make_older(tmp_path, half_steps_a_pulse)
    made = machine(tmp_path, **sections)
    state = made.controller.state()
    assert made.notes == ()
    assert (state.position_steps, state.referenced) == (position, (True, True, True))
    assert state.work_mm[0] == pytest.approx(2)
    assert carriages(made) == at
    made.controller.jog("x", -1)
    assert made.controller.run() is Status.OK
    assert carriages(made)[0] == at[0] - 200
    assert look(made).lost_steps == (0, 0, 0)


@pytest.mark.parametrize("older", [False, True])
def test_of_a_simulated_mill_that_is_another_one_the_offsets_are_kept(
    tmp_path: Path, older: bool
) -> None:
    moved(tmp_path)
    offset_mm = kept(tmp_path)["parameters"]["5221"]
    if older:
        make_older(tmp_path, 1)
    made = machine(tmp_path, simulation={"axes": {"x": {"pitch_mm": "5"}}})
    state = made.controller.state()
    assert "the simulated mill as it was otherwise" in made.notes[0]
    assert "configured otherwise" not in "".join(made.notes)
    assert (state.position_steps, state.referenced) == ((0, 0, 0), (False, False, False))
    assert state.offset_mm[0] == pytest.approx(offset_mm)
    assert offset_mm == pytest.approx(10.345)


def test_feeds_and_rates_may_change_freely(tmp_path: Path) -> None:
    position, _ = moved(tmp_path)
    made = machine(tmp_path, axes={"x": {"max_rate_hz": 3000}}, jog={"feed_mm_min": 100})
    assert made.controller.state().position_steps == position


DAMAGE: list[Any] = [
    b"",
    b"{",
    b"null",
    b"[]",
    b"\xff\xfe\x00",
    b'{"position_steps": [0, 0, 0]}',
]
CHANGES: list[dict[str, Any]] = [
    {"position_steps": [0, 0]},
    {"position_steps": [0.5, 0, 0]},
    {"position_steps": [10**10, 0, 0]},
    {"phases": [1, 2, 3, 4]},
    {"simulation": [[0, 0, 0, 0]] * 4},
    {"simulation": [[0, 0]] * 3},
    {"parameters": {"5220": 42}},
    {"parameters": {"5220": 1.5}},
    {"parameters": {"x": 1}},
    {"moving": "perhaps"},
    {"motion": {"low_steps": [0], "high_steps": [0]}},
    {"more": 1},
]


@pytest.mark.parametrize("damage", [*DAMAGE, *CHANGES], ids=str)
@pytest.mark.parametrize("older", [False, True])
def test_what_makes_no_sense_is_refused_with_a_remedy(
    tmp_path: Path, damage: Any, older: bool
) -> None:
    moved(tmp_path)
    values = kept(tmp_path)
    content = damage if isinstance(damage, bytes) else json.dumps(values | damage).encode()
    path = tmp_path / "simulation.journal"
    if older:
        path.unlink()
        path = tmp_path / "state.json"
        path.write_bytes(content)
    else:
        journal = Journal(path)
        journal.read()
        journal.write(content)
    with pytest.raises(ConfigError, match="--fresh") as caught:
        machine(tmp_path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(ConfigError, match="the state cannot be written"):
        assemble(configured(), state=blocked / "state", fresh=True)
    (tmp_path / "simulation.journal").mkdir()
    with pytest.raises(ConfigError, match="is a folder"):
        machine(tmp_path)


def test_nothing_is_left_beside_the_file(tmp_path: Path) -> None:
    moved(tmp_path)
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["simulation.journal", "simulation.lock"]


def test_a_damaged_last_record_is_no_position(tmp_path: Path) -> None:
    """The one before it is shown and its offsets hold; where the machine stands, nobody knows."""
    moved(tmp_path)
    made = machine(tmp_path)
    made.controller.jog("x", 5)
    assert made.controller.run() is Status.OK
    made.close()
    path = tmp_path / "simulation.journal"
    content = path.read_bytes()
    value = json.dumps(kept(tmp_path)["position_steps"], separators=(",", ":")).encode()
    at = content.index(b'"position_steps":' + value) + len(b'"position_steps":[')
    path.write_bytes(content[:at] + b"9" + content[at + 1 :])
    again = machine(tmp_path)
    state = again.controller.state()
    assert state.referenced == (False, False, False)
    assert state.offset_mm[0] == pytest.approx(10.345)
    assert "the last record of its place was damaged" in again.notes[0]
    again.close()
    assert machine(tmp_path).controller.state().referenced == (False, False, False)


def test_an_older_file_is_believed_by_one_machine_once(tmp_path: Path) -> None:
    """It does not say whose it was; a simulated mill's is told from a real one's."""
    moved(tmp_path)
    make_older(tmp_path, 1)
    metal = configured(port={"kind": "bridge", "device": "/dev/ttyUSB7"})
    assert not any(assemble(metal, state=tmp_path, at_desk=True).controller.state().referenced)
    assert (tmp_path / "state.json").exists()
    desk = assemble(configured(), state=tmp_path, at_desk=True)
    assert all(desk.controller.state().referenced)
    assert (tmp_path / "state.json").exists(), "who only looks writes nothing"
    made = machine(tmp_path)
    assert all(made.controller.state().referenced)
    made.close()
    assert not (tmp_path / "state.json").exists()
    assert (tmp_path / "state.json.old").exists()


def test_a_carriage_left_on_its_switch_is_found_there(tmp_path: Path) -> None:
    sections = {"simulation": {"lag_ms": 60, "bounce_readings": 10}}
    made = machine(tmp_path, **sections)
    made.controller.jog("z", 29.5)
    made.controller.run()
    made.controller.jog("z", 1.5)
    assert made.controller.run() is Status.ERROR
    made.close()
    again = machine(tmp_path, **sections)
    assert again.controller.state().switch_closed
    again.controller.home()
    assert again.controller.run() is Status.OK


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("way", [1, -1])
def test_an_alarm_is_known_to_the_next_command(tmp_path: Path, axis: str, way: int) -> None:
    """Nothing is referenced: only the contact itself tells which end it was."""
    sections = {"axes": {name: {"travel_mm": 12} for name in "xyz"}}
    made = machine(tmp_path, **sections)
    made.controller.jog(axis, 11 * way)
    assert made.controller.run() is Status.ERROR
    end = axis + ("max" if way > 0 else "min")
    assert made.controller.state().ends == (end,)
    made.close()
    # A command that moves nothing passes it on.
    machine(tmp_path, **sections).close()
    made = machine(tmp_path, **sections)
    before = carriages(made)
    assert made.controller.state().ends == (end,)
    with pytest.raises(StateError, match=f"End switch {end} is closed"):
        made.controller.jog(axis, way)
    other = "y" if axis == "x" else "x"
    with pytest.raises(StateError, match="is closed"):
        made.controller.jog(other, 1)
    made.controller.jog(axis, -way)
    assert made.controller.run() is Status.OK
    index = "xyz".index(axis)
    assert carriages(made)[index] == before[index] - 200 * way
    assert made.controller.state().ends == ()


def test_a_contact_that_opened_is_forgotten(tmp_path: Path) -> None:
    sections = {"axes": {name: {"travel_mm": 12} for name in "xyz"}}
    made = machine(tmp_path, **sections)
    made.controller.jog("x", 11)
    assert made.controller.run() is Status.ERROR
    made.close()
    made = machine(tmp_path, **sections)
    made.controller.jog("x", -3)
    assert made.controller.run() is Status.OK
    # A hand at some switch: nobody knows which.
    made.press("ymin", True)
    for _ in range(3):
        made.controller.idle(1.0)
    assert len(made.controller.state().ends) == 6
    made.close()
    made = machine(tmp_path, **sections)
    assert made.controller.state().ends == ()


def test_after_a_crash_a_contact_may_be_any(tmp_path: Path) -> None:
    sections = {"axes": {name: {"travel_mm": 12} for name in "xyz"}}
    made = machine(tmp_path, **sections)
    made.controller.jog("x", 11)
    assert made.controller.run() is Status.ERROR
    made.recorder.before_motion()
    crash(made)
    assert len(machine(tmp_path, **sections).controller.state().ends) == 6


def test_a_contact_that_is_not_where_it_was_known_does_not_hinder_a_reference_run(
    tmp_path: Path,
) -> None:
    """Somebody moved the carriages by hand in between."""
    sections = {"axes": {name: {"travel_mm": 12} for name in "xyz"}}
    made = machine(tmp_path, **sections)
    made.controller.jog("x", 11)
    assert made.controller.run() is Status.ERROR
    made.close()
    values = kept(tmp_path)
    values["simulation"][0][0] = 1200.0
    values["simulation"][1][0] = 0.0
    keep(tmp_path, values)
    made = machine(tmp_path, **sections)
    assert made.controller.state().ends == ("xmax",)
    made.controller.home()
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert made.controller.state().referenced == (True, True, True)
