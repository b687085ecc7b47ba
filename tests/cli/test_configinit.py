"""``fraese config init``: whole files of example machines, or of answers."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fraese.cli import app
from fraese.config import machines
from fraese.config.file import load


def run(*words: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["config", "init", *map(str, words)])
    return result.exit_code, result.stdout, result.stderr


def test_an_example_machine_becomes_a_file_that_is_never_overwritten(tmp_path: Path) -> None:
    file = tmp_path / "fraese.toml"
    assert run("smc800-ppdev", "-o", file)[0] == 0
    assert load(file) == machines.config_of("smc800-ppdev")
    before = file.read_bytes()
    code, _, said = run("paper-laser", "-o", file)
    assert code == 2
    assert "overwritten with --force only" in said
    assert file.read_bytes() == before
    assert run("paper-laser", "-o", file, "--force")[0] == 0
    assert load(file) == machines.config_of("paper-laser")


def test_without_a_name_or_a_terminal_the_machines_are_named(tmp_path: Path) -> None:
    code, _, said = run("-o", tmp_path / "fraese.toml")
    assert code == 2
    assert "smc1500-bridge" in said
    assert not list(tmp_path.iterdir())
    code, said, _ = run("--list")
    assert code == 0
    assert [line.split()[0] for line in said.splitlines()] == list(machines.names())


def asked(folder: Path, answers: str) -> int:
    near, far = pty.openpty()
    os.write(near, answers.encode())
    command = [sys.executable, "-m", "fraese", "config", "init"]
    home = Path(__file__).parents[2]
    environment = {**os.environ, "PYTHONPATH": os.environ.get("PYTHONPATH") or str(home)}
    done = subprocess.run(
        command, stdin=far, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=folder,
        env=environment, timeout=60,
    )  # fmt: skip
    os.close(near)
    os.close(far)
    assert b"Traceback" not in done.stdout
    return done.returncode


def test_answers_become_a_file(tmp_path: Path) -> None:
    assert asked(tmp_path, "7\n2\n3\nx, y z a\n") == 0
    config = load(tmp_path / "fraese.toml")
    assert (config.card.kind, config.port.kind) == ("stepdir", "bridge")
    assert config.axes.names == ("x", "y", "z", "a")


@pytest.mark.parametrize("axes", ["x y z a", "q", "x x"])
def test_answers_that_do_not_go_together_leave_no_file(tmp_path: Path, axes: str) -> None:
    assert asked(tmp_path, f"1\n1\n{axes}\n") == 2
    assert not (tmp_path / "fraese.toml").exists()
