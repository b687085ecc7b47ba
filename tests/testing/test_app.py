"""The app that tests of others get: keys typed, the screen read, the machine touched."""

from pathlib import Path

import pytest

from fraese.config.file import from_table, load
from fraese.testing import App, DrivenByKeys, HasEnded, NoSuchName, TookTooLong
from fraese.testing.hands import Configuration, configured, written

MACHINES = Path(__file__).parents[2] / "examples" / "machines"
ASKING = "G21 G90\nG1 X5 F1200\nM0 (look at it)\nG1 X10\nM2\n"


@pytest.fixture
def part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "part.ngc"
    file.write_text(ASKING)
    return file


def test_keys_drive_the_machine_and_the_screen_says_so(app: App) -> None:
    app.press("r", "enter")
    assert "Referenced" in app.text
    app.press("right", "right", "up")
    assert app.mill.carriages_mm == pytest.approx({"x": 2, "y": 1, "z": 0}, abs=0.01)
    app.press("m")
    app.type("G0 X30 Z-5")
    app.press("enter")
    assert app.mill.position_mm == {"x": 30, "y": 1, "z": -5}
    assert "30.000" in app.text


def test_a_program_is_opened_and_asks_and_is_answered(app: App, part: Path) -> None:
    app.press("o")
    app.type(part.name)
    app.press("enter")
    assert "Start it with" in app.text
    app.press("s", "enter")
    assert "look at it" in app.question
    assert app.mill.position_mm["x"] == 5
    assert "look at it" in app.text
    app.press("enter")
    assert app.question == ""
    assert app.mill.position_mm["x"] == 10


def test_time_stands_still_where_keys_are_to_be_pressed(app: App) -> None:
    app.press("m")
    app.type("G1 X50 F600")
    # Not referenced it goes at half its rate.
    app.freeze_at(4)
    app.press("enter")
    assert 15 < app.mill.position_mm["x"] < 25
    app.mill.press("xmax")
    app.settled()
    assert "alarm 10" in app.text
    app.mill.release("xmax")
    assert 15 < app.mill.position_mm["x"] < 30


def test_a_stop_key_brakes_in_the_middle_of_a_move(app: App) -> None:
    app.press("m")
    app.type("G1 X50 F600")
    app.freeze_at(2)
    app.press("enter", "escape")
    app.settled()
    assert "Cancelled" in app.text
    assert 5 < app.mill.position_mm["x"] < 15
    assert not any(app.mill.lost_steps.values())


def test_a_job_has_a_limit_of_machine_time(tmp_path: Path) -> None:
    with App(folder=tmp_path, limit_s=5) as app:
        app.press("m")
        app.type("G4 P50")
        with pytest.raises(TookTooLong, match="5 s of machine time"):
            app.press("enter")
        app.press("escape", "right")
        assert app.mill.position_mm["x"] == 1


def test_commands_are_for_keys_that_there_are_and_an_app_that_lives(app: App) -> None:
    with pytest.raises(NoSuchName, match="'rihgt' is none of a character"):
        app.press("rihgt")
    app.press("ctrl+p", "escape", "f6", "f2")
    with pytest.raises(DrivenByKeys, match=r"home\(\)"):
        app.mill.home()
    with pytest.raises(AttributeError):
        _ = app.mill.anything
    app.press("q")
    with pytest.raises(HasEnded):
        app.press("right")


MACRO = {"name": "Park", "key": "f9", "lines": ["G0 X3"], "confirm": False}


def test_keys_and_macros_of_the_configuration_are_there(tmp_path: Path) -> None:
    with App({"keys": {"go_to": "f8"}, "macros": [MACRO]}, folder=tmp_path) as app:
        app.press("f9")
        assert app.mill.position_mm["x"] == 3
        app.press("f8")
        assert "Go to" in app.text


@pytest.mark.parametrize(
    "configuration",
    [
        None,
        {"axes": {"x": {"pitch_mm": 1.5, "gear": "7/5"}}, "tools": {"3": {"length_mm": 12.25}}},
        from_table({"simulation": {"solids": {"plate": {"top_mm": -3}}}}, "test"),
        *sorted(MACHINES.glob("*.toml")),
    ],
)
def test_the_copy_of_a_configuration_says_the_same(
    configuration: Configuration, tmp_path: Path
) -> None:
    file = tmp_path / "fraese.toml"
    file.write_text(written(configuration))
    assert load(file) == configured(configuration)


@pytest.fixture
def app_size() -> tuple[int, int]:
    return 100, 30


@pytest.fixture
def mill_config() -> dict[str, object]:
    return {"axes": {"x": {"travel_mm": 99}}}


def test_it_is_as_large_as_asked_and_keeps_a_picture(app: App, tmp_path: Path) -> None:
    assert len(app.text.split("\n")) == 30
    assert app.mill.state.high_mm[0] < 99
    app.picture(tmp_path / "app.svg")
    assert "<svg" in (tmp_path / "app.svg").read_text("utf-8")
