"""``--trace`` and what stands in its file: an edge a step, and the machine where they lead."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import vcd.reader
from typer.testing import CliRunner, Result

from fraese.cli import app

STEP_DIRECTION = '[card]\nkind = "stepdir"\n'


class Change(NamedTuple):
    at_ns: int
    value: str | float


class Wave:
    """A waveform file, read by pyvcd.

    Attributes:
        changes: by name.
    """

    def __init__(self, path: Path) -> None:
        names: dict[str, str] = {}
        self.changes: dict[str, list[Change]] = {}
        at_ns = 0
        with path.open("rb") as file:
            for token in vcd.reader.tokenize(file):
                if token.kind is vcd.reader.TokenKind.VAR:
                    names[token.var.id_code] = token.var.reference
                    self.changes[token.var.reference] = []
                elif token.kind is vcd.reader.TokenKind.CHANGE_TIME:
                    assert token.time_change >= at_ns
                    at_ns = token.time_change
                elif token.kind is vcd.reader.TokenKind.CHANGE_SCALAR:
                    change = token.scalar_change
                    self._add(names[change.id_code], Change(at_ns, change.value))
                elif token.kind is vcd.reader.TokenKind.CHANGE_REAL:
                    real = token.real_change
                    self._add(names[real.id_code], Change(at_ns, real.value))

    def _add(self, name: str, change: Change) -> None:
        line = self.changes[name]
        if not line or line[-1].value != change.value:
            line.append(change)

    def edges(self, name: str, to: str) -> list[int]:
        """When a line became 1 or 0; not its first level."""
        line = self.changes[name]
        known = [n for n, change in enumerate(line) if change.value != "x"][1:]
        return [line[n].at_ns for n in known if line[n].value == to]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "user-state"))
    return tmp_path


def run(*words: object) -> Result:
    result = CliRunner().invoke(app, [*map(str, words)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result
    return result


def answer(*words: object) -> dict[str, Any]:
    result = run(*words, "--json")
    assert result.exit_code == 0, result.output
    found: dict[str, Any] = json.loads(result.stdout.splitlines()[-1])
    return found


def test_edges_of_a_job_are_its_steps_and_lead_to_the_carriages(folder: Path) -> None:
    (folder / "fraese.toml").write_text(STEP_DIRECTION)
    (folder / "part.ngc").write_text("G1 X4 Y1.5 F600\nG2 X6 Y-0.5 I0 J-2\nG0 Z1\nX0 Y0\nM2\n")
    before = answer("where")["carriages_mm"]
    said = answer("run", "part.ngc", "--trace", "job.vcd")
    wave = Wave(folder / "job.vcd")
    for socket, axis in enumerate("xyz"):
        steps = wave.edges(f"pin{3 + 2 * socket:02d}_{axis}_clock", "1")
        assert len(steps) == said["steps"][axis]
        directions = wave.changes[f"pin{2 + 2 * socket:02d}_{axis}_direction"]
        signed = sum(
            1 if [d.value for d in directions if d.at_ns <= at_ns][-1] == "1" else -1
            for at_ns in steps
        )
        moved_mm = said["carriages_mm"][axis] - before[axis]
        assert abs(signed) / 200 == pytest.approx(abs(moved_mm), abs=1e-9)
        assert signed == said["position_steps"][axis]
    assert said["trace"]["duration_s"] == pytest.approx(said["duration_s"], abs=1e-6)
    assert said["trace"]["failure"] == ""


def test_directions_stand_100_us_before_the_first_clock_after_them(folder: Path) -> None:
    (folder / "fraese.toml").write_text(STEP_DIRECTION)
    (folder / "part.ngc").write_text("G0 X1\nX0\nX2 Y1\nX1\nM2\n")
    answer("run", "part.ngc", "--trace", "job.vcd")
    wave = Wave(folder / "job.vcd")
    changed = wave.changes["pin02_x_direction"][2:]
    assert len(changed) >= 3
    clocks = wave.edges("pin03_x_clock", "1")
    for change in changed:
        assert min(at for at in clocks if at >= change.at_ns) - change.at_ns >= 100_000
        assert all(abs(at - change.at_ns) >= 25_000 for at in clocks)


def test_a_phase_card_shows_strobes_and_the_currents_of_the_coils(folder: Path) -> None:
    said = answer("move", "X0.04", "--trace", "job.vcd")
    wave = Wave(folder / "job.vcd")
    assert said["steps"]["x"] == 8
    # Two coils with a sine each, half a turn apart: a whole turn in eight half-steps.
    coils = [[c.value for c in wave.changes[f"x_coil_{coil}"]] for coil in "ab"]
    assert set(coils[0]) == set(coils[1]) == {0.0, 60.0, 100.0, -60.0, -100.0}
    assert wave.changes["x_coil_a"][-1].value == 0
    strobes = wave.edges("pin01_nstrobe", "0")
    # Three motors off, energised, eight half-steps, off again.
    # The first is the line's first level.
    assert len(strobes) + 1 == len(wave.edges("pin01_nstrobe", "1"))
    assert len(strobes) + 1 == 3 + 3 + 8 + 3 + 3


def test_equal_commands_write_equal_waveforms(folder: Path) -> None:
    for name in ("one.vcd", "two.vcd"):
        answer("move", "X2", "Y-1", "--fresh", "--trace", name)
    one, two = (Wave(folder / name) for name in ("one.vcd", "two.vcd"))
    assert one.changes == two.changes


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("move X1", 0),
        ("jog X 1", 0),
        ("home", 0),
        ("run part.ngc", 0),
        ("frame part.ngc", 0),
        ("--trace job.vcd move X1", 0),
        ("bench 2", 0),
    ],
)
def test_every_command_that_moves(folder: Path, words: str, code: int) -> None:
    (folder / "part.ngc").write_text("G0 X1 Y1\nM2\n")
    there = "--trace" in words
    result = CliRunner().invoke(
        app, [*words.split(), *(() if there else ("--trace", "job.vcd"))], input="d50\ng\nq\n"
    )
    assert result.exit_code == code, result.output
    assert len(Wave(folder / "job.vcd").changes) >= 17


def test_a_file_that_cannot_be_written_is_refused_before_anything_moves(folder: Path) -> None:
    (folder / "part.ngc").write_text("G0 X1\n")
    for name, why in {
        "none/job.vcd": "the waveform cannot be written: No such file or directory.",
        ".": "the waveform cannot be written: Is a directory.",
        "/dev/full": "the waveform cannot be written: No space left on device.",
        "part.ngc": "part.ngc is there and is no waveform; it is not overwritten.",
    }.items():
        result = run("move", "X1", "--trace", name)
        assert result.exit_code == 2
        assert why in result.stderr
        assert answer("where")["position_steps"] == {"x": 0, "y": 0, "z": 0}
    assert (folder / "part.ngc").read_text() == "G0 X1\n"


def test_a_waveform_that_is_there_is_overwritten(folder: Path) -> None:
    answer("move", "X3", "--trace", "job.vcd")
    long = (folder / "job.vcd").stat().st_size
    answer("move", "X3.1", "--trace", "job.vcd")
    assert (folder / "job.vcd").stat().st_size < long / 4


def test_a_disk_that_fills_up_ends_the_file_and_not_the_job(folder: Path) -> None:
    """No file may be longer than 100 kB here: the job makes four times as much."""
    limited = 'ulimit -f 200; exec "$0" -m fraese "$@"'
    words = ["jog", "X", "40", "--json", "--trace", "job.vcd"]
    done = subprocess.run(
        ["sh", "-c", limited, sys.executable, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["position_mm"]["x"] == 40
    assert said["trace"]["failure"] == "File too large"
    assert "job.vcd: the waveform ends soon after" in done.stderr
    assert "File too large; the job went on without it." in done.stderr
    # What is there can be read, to the moment that was said or nearly so.
    looked = run("trace", "job.vcd", "--json")
    assert looked.exit_code == 0, looked.output
    assert json.loads(looked.stdout)["to_s"] > 0.1


@pytest.mark.parametrize("words", ["switches", "zero"])
def test_a_command_that_only_opens_the_port_shows_what_it_wrote(folder: Path, words: str) -> None:
    result = run(*words.split(), "--trace", "job.vcd")
    assert "job.vcd" in result.output
    assert "pin11_switches" in Wave(folder / "job.vcd").changes


def test_a_file_in_the_configuration_is_of_the_latest_command(folder: Path) -> None:
    (folder / "fraese.toml").write_text('[port]\nrecord = "mill.vcd"\n' + STEP_DIRECTION)
    for way, steps in (("X1", 200), ("X1.5", 100)):
        said = answer("move", way, "--machine")
        assert said["trace"]["file"] == "mill.vcd"
        assert len(Wave(folder / "mill.vcd").edges("pin03_x_clock", "1")) == steps
    before = (folder / "mill.vcd").read_bytes()
    answer("where")
    assert (folder / "mill.vcd").read_bytes() == before
    answer("move", "X1", "--machine", "--trace", "other.vcd")
    assert (folder / "mill.vcd").read_bytes() == before
    assert len(Wave(folder / "other.vcd").edges("pin03_x_clock", "1")) == 100


def test_a_file_in_the_configuration_that_cannot_be_written_is_a_sentence(folder: Path) -> None:
    (folder / "fraese.toml").write_text('[port]\nrecord = "nowhere/mill.vcd"\n')
    result = run("move", "X1")
    assert result.exit_code == 2
    assert "nowhere/mill.vcd" in result.output
