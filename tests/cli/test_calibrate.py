"""What is measured is told, for people and for programs, and written only if that is wanted."""

from pathlib import Path
from typing import Any

import pytest

from tests.cli.test_cli import Shop, shop  # noqa: F401 (a fixture)

MILL = """\
# My mill.
[axes.x]
travel_mm = 40   # about
[simulation.axes.x]
travel_mm = 41.5
"""


@pytest.fixture
def mill(shop: Shop) -> Shop:  # noqa: F811
    shop.file(MILL, "fraese.toml")
    return shop


def text(mill: Shop) -> str:
    return Path("fraese.toml").read_text("utf-8")


def found(mill: Shop, *words: object) -> dict[str, Any]:
    values: dict[str, Any] = mill.json("calibrate", *words)["calibration"]
    return values


def test_the_travel_is_written_on_demand_with_comments_kept(mill: Shop) -> None:
    values = found(mill, "travel", "X")
    assert values == {
        "measured_mm": 41.5, "configured_mm": 40.0,
        "proposed": {"axes.x.travel_mm": "41.5"}, "written": None,
    }  # fmt: skip
    assert text(mill) == MILL
    result = mill.run("calibrate", "travel", "X", "--write")
    assert "axes.x.travel_mm: 40 becomes 41.5" in result.stderr
    assert "Written to fraese.toml; it counts from the next start." in result.stderr
    assert text(mill) == MILL.replace("travel_mm = 40 ", "travel_mm = 41.5 ")
    assert "right as it is" in mill.run("calibrate", "travel", "X").stderr


def test_steps_per_mm_in_two_calls(mill: Shop) -> None:
    result = mill.run("calibrate", "steps", "X", "10", "--yes")
    assert "fraese calibrate steps X 10 --measured MM" in result.stderr
    values = found(mill, "steps", "X", "10", "--measured", "-24.99")
    assert values["found_steps_per_mm"] == pytest.approx(80.032, abs=1e-3)
    assert values["proposed"] == {"axes.x.pitch_mm": "5", "axes.x.inverted": "true"}
    exactly = found(mill, "steps", "X", "10", "--measured", "24.99", "--reading", "0.001")
    assert exactly["proposed"] == {"axes.x.pitch_mm": "4.998"}
    for wrong in (["0"], ["10", "--measured", "0"], ["nan"], ["900"]):
        assert mill.run("calibrate", "steps", "X", *wrong).exit_code == 2


def test_backlash_and_the_switch(mill: Shop) -> None:
    mill.file(MILL + "backlash_mm = 0.08\n", "fraese.toml")
    values = found(mill, "backlash", "X", "--times", "2")
    assert values["readings_mm"] == [0.08, 0.08]
    assert values["proposed"] == {"axes.x.backlash_mm": "0.08"}
    assert "--read MM" in mill.run("calibrate", "backlash", "X", "--gauge", "--yes").stderr
    assert found(mill, "backlash", "X", "--read", "0.05")["by"] == "gauge"
    result = mill.run("calibrate", "repeat", "X", "--times", "3", "--end", "max")
    assert "xmax closed 3 times within 0.0000 mm" in result.stderr
    assert "-0.0025 to 0.0025 mm" in result.stderr
    assert found(mill, "repeat", "X", "--times", "2")["readings_mm"] == [0, 0]


def test_a_frequency_test_of_one_stage(mill: Shop) -> None:
    values = found(
        mill, "frequency", "X", "--stage", "start", "--from", 1000, "--to", 2400, "--step", 200
    )
    (stage,) = values["stages"]
    assert stage["stage"] == "start"
    assert (stage["best"], stage["stall"]) == (1400, 1600)
    assert len(stage["tried"]) == 8
    assert "axes.x.start_rate_hz" in values["proposed"]
    for wrong in (["--from", "3"], ["--stage", "stall"]):
        result = mill.run("calibrate", "frequency", "X", *wrong)
        assert (result.exit_code, result.stderr.count("fraese:")) == (2, 1)


def test_what_does_not_go_well_writes_nothing(mill: Shop) -> None:
    mill.file(MILL + "[axes.y]\nend_switches = false\n", "fraese.toml")
    result = mill.run("calibrate", "travel", "Y", "--write")
    assert result.exit_code == 2
    assert "Y has no end switches" in result.stderr
    assert mill.run("calibrate", "travel", "Q").exit_code == 2
    assert mill.run("calibrate", "travel", "XY").exit_code == 2
    mill.file(MILL, "other.toml")
    Path("other.toml").chmod(0o444)
    result = mill.run("--config", "other.toml", "calibrate", "travel", "X", "--write")
    assert "other.toml: is write-protected" in result.stderr
    assert Path("other.toml").read_text() == MILL
    Path("other.toml").chmod(0o644)
    values = mill.json("--config", "other.toml", "calibrate", "travel", "X", "--write")
    assert values["calibration"]["written"] == "other.toml", "said in front, it holds"
