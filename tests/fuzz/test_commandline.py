"""The command line: an exit code and a sentence; what is refused has not moved."""

import json
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from typer.testing import CliRunner, Result

from fraese.cli import app
from tests.fuzz.lengths import fuzzed, soon

_COMMANDS = st.sampled_from(
    [
        "move",
        "jog",
        "zero",
        "where",
        "home",
        "run",
        "check",
        "gcode",
        "frame",
        "config",
        "trace",
        "ports",
        "doctor",
        "alarms",
        "schema",
    ]
)
_WORDS = st.one_of(
    st.sampled_from(
        [
            "X1",
            "X-1",
            "Y2,5",
            "Z-1",
            "X1e9",
            "XX",
            "x=1",
            "F100",
            "F1e-320",
            "-1",
            "0",
            "1e-320",
            "nan",
            "inf",
            "part.ngc",
            "list.csv",
            "part.toml",
            "pipe",
            ".",
            "..",
            "/dev/null",
            "--json",
            "--feed",
            "--relative",
            "--machine",
            "--from-line",
            "--yes",
            "--stream",
            "--fresh",
            "--measure",
            "--config",
            "--help",
            "check",
            "--",
            "-",
            "=",
            "''",
            "é",
            "🙂",
            "�",
            "\u202e",
            "\x1b[2J",
        ]
    ),
    st.sampled_from(["9" * 5000, "a" * 5000, "[" * 5000, "X" + "9" * 5000]),
    st.text(st.characters(exclude_characters="\0"), max_size=12),
)


def _run(words: list[str]) -> Result:
    with soon():
        result = CliRunner().invoke(app, words)
    assert result.exception is None or isinstance(result.exception, SystemExit), (words, result)
    assert "error in the program itself" not in result.output, (words, result.output)
    assert "Traceback" not in result.output
    return result


def test_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("CONFIG", "STATE"):
        monkeypatch.setenv(f"XDG_{name}_HOME", str(tmp_path / name))
    (tmp_path / "part.ngc").write_text("G21 G90 G1 X1 F600\nM2\n")
    (tmp_path / "list.csv").write_text("1;2;-1;600\n")
    (tmp_path / "part.toml").write_text("[axes.x]\npitch_mm = 4\n")
    state = str(tmp_path / "state")

    def stands() -> object:
        return json.loads(_run(["where", "--json", "--state", state]).stdout)["position_steps"]

    @fuzzed(60)
    @given(_COMMANDS, st.lists(_WORDS, max_size=4))
    @example("move", ["X1", "--feed", "1e-320"])
    @example("run", ["a" * 5000])
    def check(command: str, words: list[str]) -> None:
        before = stands()
        result = _run([command, *words, "--state", state])
        assert result.exit_code in (0, 1, 2, 130), (words, result.output)
        if result.exit_code == 2:
            assert stands() == before

    check()
