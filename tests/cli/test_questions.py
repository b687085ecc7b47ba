"""Questions of a program: at a terminal, answered beforehand, and where nobody answers."""

import json
from pathlib import Path

import pytest

from tests.cli.test_session import fraese

PART = """G21 G90
M3 S8000
G0 Z-2
M0 (turn the plate over)
G0 X10
T2 M6 (6 mm, two flutes)
G0 X20
M2
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "part.ngc").write_text(PART)
    assert fraese(tmp_path, "home").returncode == 0
    return tmp_path


def _where(folder: Path) -> dict[str, float]:
    found: dict[str, float] = json.loads(fraese(folder, "where", "--json").stdout)["work_mm"]
    return found


def test_without_a_terminal_the_job_stops_at_its_question(folder: Path) -> None:
    ended = fraese(folder, "run", "part.ngc", "--answer", "", "--json")
    assert ended.returncode == 1
    found = json.loads(ended.stdout)
    assert found["status"] == "unanswered"
    assert "Program stop in line 4 (turn the plate over): go on?" in found["message"]
    assert "Z -2.000 mm (machine)" in found["message"]
    assert "cut short in line 4: fraese resume goes on with it" in found["message"]
    assert _where(folder) == {"x": 0, "y": 0, "z": -2}


def test_it_goes_on_at_the_question_that_nobody_answered(folder: Path) -> None:
    fraese(folder, "run", "part.ngc", "--answer", "")
    gone_on = fraese(folder, "resume", "--yes")
    assert gone_on.returncode == 0, gone_on.stderr
    assert "from line 4" in gone_on.stderr
    assert "go on? [go on]" in gone_on.stderr
    assert "put in tool 2." in gone_on.stderr
    assert _where(folder) == {"x": 20, "y": 0, "z": -2}


def test_stopped_before_its_first_move_it_begins_at_its_question(folder: Path) -> None:
    ended = fraese(folder, "run", "part.ngc")
    assert ended.returncode == 1
    assert "cut short in line 2" in ended.stderr
    assert _where(folder) == {"x": 0, "y": 0, "z": 0}
    assert fraese(folder, "resume", "--yes").returncode == 0


def test_yes_answers_all_of_them_and_says_to_what(folder: Path) -> None:
    done = fraese(folder, "run", "part.ngc", "--yes")
    assert done.returncode == 0, done.stderr
    assert "8000 rev/min: confirm. [go on]" in done.stderr
    assert "line 4 (turn the plate over): go on? [go on]" in done.stderr
    assert "line 6 (6 mm, two flutes): put in tool 2. [go on]" in done.stderr


def test_answers_are_taken_in_turn_and_may_move_by_hand(folder: Path) -> None:
    answers = ("", "", "jog Z 2", "zero Z", "")
    words = [word for line in answers for word in ("--answer", line)]
    done = fraese(folder, "run", "part.ngc", *words, "--yes")
    assert done.returncode == 0, done.stderr
    assert "put in tool 2. [jog Z 2]" in done.stderr
    assert "Back to the work: " in done.stderr


def test_an_answer_that_is_refused_ends_the_job_there(folder: Path) -> None:
    ended = fraese(folder, "run", "part.ngc", "--answer", "", "--answer", "zero X", "--yes")
    assert ended.returncode == 1
    assert "only the zero of Z can be set now" in ended.stderr
    assert "cut short in line 4" in ended.stderr


def test_a_measurement_that_asks_stops_too(folder: Path) -> None:
    ended = fraese(folder, "calibrate", "steps", "X", 20)
    assert ended.returncode == 1
    assert "Nobody has answered" in ended.stderr
    assert fraese(folder, "calibrate", "steps", "X", 20, "--yes").returncode == 0
