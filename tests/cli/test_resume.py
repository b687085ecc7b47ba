"""``fraese resume``: after a signal, a kill, an alarm, with the file as it was started."""

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest

from fraese.assembly import assemble
from fraese.control.state import Status
from tests.cli.test_session import begun, fraese
from tests.helpers import configured, crash, kept

PATIENCE_S = 30

PART = "G21 G90 F900\nG0 Z-1\nO1 REPEAT [3]\nG1 X12\nG1 X2\nO1 ENDREPEAT\nG1 X5 Y4\nM2\n"


def _started(folder: Path) -> "subprocess.Popen[str]":
    (folder / "part.ngc").write_text(PART, "utf-8")
    assert fraese(folder, "home").returncode == 0
    process = begun(folder, "run", "part.ngc", "--real-time")
    # Before its first move nothing is cut short.
    until_s = time.monotonic() + PATIENCE_S
    while not any(kept(folder / "state")["position_steps"]):
        assert time.monotonic() < until_s, "nothing moves"
        time.sleep(0.01)
    return process


def _where(folder: Path) -> dict[str, float]:
    where = json.loads(fraese(folder, "where", "--json").stdout)
    assert where["carriages_mm"] == pytest.approx(where["position_mm"], abs=1e-6)
    found: dict[str, float] = where["position_mm"]
    return found


def test_after_a_signal_it_goes_on_at_once(tmp_path: Path) -> None:
    process = _started(tmp_path)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=15)
    assert "part.ngc was cut short in line" in fraese(tmp_path, "where").stderr
    asked = fraese(tmp_path, "resume")
    assert asked.returncode == 2
    assert "part.ngc from line" in asked.stderr
    assert "without a terminal add --yes" in asked.stderr
    done = fraese(tmp_path, "resume", "--yes")
    assert done.returncode == 0, done.stderr
    assert _where(tmp_path) == {"x": 5, "y": 4, "z": -1}
    again = fraese(tmp_path, "resume", "--yes")
    assert again.returncode == 2
    assert "nothing to go on with" in again.stderr
    assert "cut short" not in fraese(tmp_path, "where").stderr


def test_after_a_kill_the_machine_is_referenced_first(tmp_path: Path) -> None:
    process = _started(tmp_path)
    process.kill()
    process.communicate(timeout=15)
    refused = fraese(tmp_path, "resume", "--yes")
    assert refused.returncode == 2
    assert "reference first (fraese home)" in refused.stderr
    assert fraese(tmp_path, "home").returncode == 0
    assert fraese(tmp_path, "resume", "--yes").returncode == 0
    assert _where(tmp_path) == {"x": 5, "y": 4, "z": -1}


def test_an_edited_or_vanished_file_is_told_of_and_the_started_one_goes_on(tmp_path: Path) -> None:
    process = _started(tmp_path)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=15)
    (tmp_path / "part.ngc").write_text(PART.replace("X5 Y4", "X9 Y9"), "utf-8")
    edited = fraese(tmp_path, "resume")
    assert "has changed on disk" in edited.stderr
    (tmp_path / "part.ngc").unlink()
    done = fraese(tmp_path, "resume", "--yes")
    assert "is gone" in done.stderr
    assert done.returncode == 0
    assert _where(tmp_path) == {"x": 5, "y": 4, "z": -1}


def test_without_the_kept_copy_it_is_refused(tmp_path: Path) -> None:
    process = _started(tmp_path)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=15)
    for path in (tmp_path / "state" / "jobs").iterdir():
        path.unlink()
    before = _where(tmp_path)
    refused = fraese(tmp_path, "resume", "--yes")
    assert refused.returncode == 2
    assert "kept copy" in refused.stderr
    assert _where(tmp_path) == before


def test_what_a_crash_left_near_its_place_is_taken_on_a_persons_word(tmp_path: Path) -> None:
    made = assemble(configured(), state=tmp_path / "state")
    made.controller.home()
    assert made.controller.run() is Status.OK
    crash(made)
    assert "or take it as it was left (fraese trust)" in fraese(tmp_path, "where").stderr
    assert fraese(tmp_path, "trust").returncode == 0
    where = fraese(tmp_path, "where", "--json")
    assert json.loads(where.stdout)["referenced"] == {"x": True, "y": True, "z": True}
    assert "not trusted" not in where.stderr
    again = fraese(tmp_path, "trust")
    assert again.returncode == 2
    assert "nothing to take" in again.stderr
