"""The program as its own process: signals, pipes, and two commands on one machine."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fraese.assembly import assemble
from fraese.cli.output import note
from fraese.cli.session import Session
from fraese.control.state import Status
from tests.helpers import configured, kept, program

FRAESE = [sys.executable, "-m", "fraese"]


def environment(folder: Path) -> dict[str, str]:
    return {
        **os.environ,
        "XDG_CONFIG_HOME": str(folder / "config"),
        "XDG_STATE_HOME": str(folder / "user-state"),
        "PYTHONPATH": str(Path(__file__).parents[2]),
    }


def fraese(folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*FRAESE, *map(str, words), "--state", str(folder / "state")],
        capture_output=True,
        text=True,
        timeout=30,
        cwd=folder,
        env=environment(folder),
        stdin=subprocess.DEVNULL,
        check=False,
    )


def begun(folder: Path, *words: object) -> "subprocess.Popen[str]":
    """A command in the background; returns when the machine moves."""
    process = subprocess.Popen(
        [*FRAESE, *map(str, words), "--state", str(folder / "state")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        env=environment(folder),
        stdin=subprocess.DEVNULL,
    )
    until = time.monotonic() + 15
    while not kept(folder / "state").get("motion"):
        assert time.monotonic() < until
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    return process


def test_two_commands_on_one_machine(tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text("G0 X5\nM2\n")
    assert fraese(tmp_path, "home").returncode == 0
    done = fraese(tmp_path, "run", "part.ngc", "--json")
    assert done.returncode == 0
    values = json.loads(done.stdout.splitlines()[-1])
    assert values["status"] == "done"
    assert values["position_mm"] == {"x": 5, "y": 0, "z": 0}
    wrong = fraese(tmp_path, "run", "nothing.ngc")
    assert wrong.returncode == 2
    assert wrong.stderr == "fraese: nothing.ngc: there is no such file.\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_brakes_keeps_the_state_and_ends_with_130(
    tmp_path: Path, number: signal.Signals
) -> None:
    process = begun(tmp_path, "move", "X100", "--feed", "300", "--real-time", "--json")
    process.send_signal(number)
    out, err = process.communicate(timeout=15)
    assert process.returncode == 130
    values = json.loads(out.splitlines()[-1])
    assert values["status"] == "cancelled"
    assert "Traceback" not in err
    where = json.loads(fraese(tmp_path, "where", "--json").stdout)
    assert where["position_steps"] == values["position_steps"]
    assert where["position_mm"]["x"] < 20


def test_after_a_kill_the_reference_is_not_believed(tmp_path: Path) -> None:
    assert fraese(tmp_path, "home").returncode == 0
    process = begun(tmp_path, "move", "X100", "--feed", "300", "--real-time")
    process.kill()
    process.communicate(timeout=15)
    where = fraese(tmp_path, "where", "--json")
    assert "reference it again" in where.stderr
    assert json.loads(where.stdout)["referenced"] == {"x": False, "y": False, "z": False}


def _wait_until_it_hears(process: subprocess.Popen[str]) -> None:
    """Until the program hears signals; then it looks its file through, on a busy machine too."""
    folder = Path(f"/proc/{process.pid}/fd")
    until_s = time.monotonic() + 60
    while time.monotonic() < until_s:
        assert process.poll() is None
        with contextlib.suppress(FileNotFoundError):
            if any(str(link.readlink()).startswith("socket:") for link in folder.iterdir()):
                return
        time.sleep(0.02)
    process.kill()
    raise AssertionError("it never listened")


def test_a_signal_while_a_file_is_looked_through(tmp_path: Path) -> None:
    (tmp_path / "long.ngc").write_text("G1 F600\n" + "X1\nX2\n" * 300_000)
    process = subprocess.Popen(
        [*FRAESE, "run", "long.ngc", "--state", "state"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env=environment(tmp_path),
    )
    _wait_until_it_hears(process)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert err == "fraese: Cancelled before anything moved.\n"


def test_nobody_reads_the_output(tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text("G1 F600\n" + "X1\nX2\n" * 3000 + "M2\n")
    for command in ("fraese gcode part.ngc | head -1", "fraese config schema | true"):
        script = command.replace("fraese", " ".join(FRAESE), 1)
        done = subprocess.run(
            ["bash", "-c", f"{script}; echo ${{PIPESTATUS[0]}} >&2"],
            capture_output=True,
            text=True,
            timeout=30,
            cwd=tmp_path,
            env=environment(tmp_path),
            check=False,
        )
        assert done.stderr == "0\n"


def test_nobody_reads_the_messages_and_the_job_goes_on(tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text("(MSG,one)\nG0 X1\n(MSG,two)\nG0 X7\nM2\n")
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [*FRAESE, "run", "part.ngc", "--json", "--state", "state"],
        stdout=subprocess.PIPE,
        stderr=write,
        stdin=subprocess.DEVNULL,
        text=True,
        timeout=30,
        cwd=tmp_path,
        env=environment(tmp_path),
        check=False,
    )
    os.close(write)
    assert done.returncode == 0
    assert json.loads(done.stdout)["position_mm"]["x"] == 7


# --- the session itself --------------------------------------------------------------------------


def test_a_program_is_worked_off_and_the_result_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = assemble(configured(), state=tmp_path)
    part = program(tmp_path, "G0 X3\nM2\n")
    code = Session(made, as_json=True).do(lambda controller: part.start(controller))
    assert code == 0
    values = json.loads(capsys.readouterr().out)
    assert set(values) >= {
        "status",
        "position_mm",
        "position_steps",
        "steps",
        "duration_s",
        "blocks",
    }


def test_progress_fits_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    for columns in (1, 7, 40, 300):
        monkeypatch.setenv("COLUMNS", str(columns))
        made = assemble(configured())
        Session(made, as_json=True).do(lambda controller: controller.jog("x", 40))
        shown = capsys.readouterr().err
        assert "\x1b[K" in shown
        for line in shown.replace("\x1b[K", "").split("\r"):
            assert len(line) < max(columns, 2)


def test_a_question_at_a_terminal_waits_for_enter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers = [None, EOFError]

    def pressed() -> str:
        answer = answers.pop(0)
        if answer is not None:
            raise answer
        return ""

    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", pressed)
    made = assemble(configured())
    part = program(tmp_path, "M0\nG0 X3\nM0\nG0 X6\nM2\n")
    code = Session(made, as_json=True).do(lambda controller: part.start(controller))
    assert code == 130
    assert "line 1: go on? [Enter: go on; by hand: jog" in capsys.readouterr().err
    assert made.controller.state().position_mm[0] == 3


def test_at_a_question_somebody_moves_by_hand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = ["jog Z 2", "zero X", "jump", "jog X1 Y1", "zero", "zero z", "move X1 F300", "lift", ""]
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", lambda: typed.pop(0) if typed else "")
    made = assemble(configured())
    part = program(tmp_path, "G0 X3 Z1\nT2 M6\nG0 X6\nM2\n")
    code = Session(made, as_json=True).do(lambda controller: part.start(controller))
    said = capsys.readouterr().err
    assert code == 0
    for sentence in (
        "only the zero of Z can be set now, not that of X",
        '"jump" is none of jog, move, zero and lift',
        "A jog is one axis and a distance",
        "Say which axis is to be zero here",
        "Back to the work: ",
    ):
        assert sentence in said
    # The tool stands 1 mm above what it touched at 3.
    assert made.controller.state().position_mm == (6, 0, 4)


def test_ctrl_c_at_a_question_cancels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> str:
        signal.raise_signal(signal.SIGINT)
        return ""

    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", interrupted)
    made = assemble(configured())
    part = program(tmp_path, "M0\nG0 X3\nM2\n")
    assert Session(made, as_json=True).do(lambda controller: part.start(controller)) == 130
    assert made.controller.state().position_mm[0] == 0
    assert made.controller.status is Status.CANCEL


def test_handlers_are_put_back() -> None:
    before = signal.getsignal(signal.SIGINT)
    made = assemble(configured())
    Session(made, as_json=True).do(lambda controller: controller.jog("x", 1))
    assert signal.getsignal(signal.SIGINT) is before


def test_a_note_to_nobody_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    class Gone:
        def write(self, text: str) -> int:
            raise BrokenPipeError

        def flush(self) -> None:
            raise BrokenPipeError

    monkeypatch.setattr("sys.stderr", Gone())
    note("hello")


def test_after_an_alarm_the_next_command_jogs_away_from_it(tmp_path: Path) -> None:
    """Nothing is referenced, and every command is a process of its own."""
    (tmp_path / "fraese.toml").write_text(
        "".join(f"[axes.{name}]\ntravel_mm = 12\n" for name in "xyz"), "utf-8"
    )
    alarm = fraese(tmp_path, "jog", "y", -11)
    assert alarm.returncode == 1
    assert "End switch ymin closed" in alarm.stderr
    assert "Alarm 10. An axis that was stopped at speed" in alarm.stderr
    refused = fraese(tmp_path, "jog", "y", -1)
    assert refused.returncode == 2
    assert "End switch ymin is closed" in refused.stderr
    away = fraese(tmp_path, "jog", "y", 1, "--json")
    assert away.returncode == 0, away.stderr
    assert json.loads(away.stdout)["steps"]["y"] == 200
    assert fraese(tmp_path, "jog", "x", 1).returncode == 0


def test_an_interrupt_before_the_command_is_there_ends_it_without_a_traceback(
    tmp_path: Path,
) -> None:
    """While Python still reads what the command line needs: the first of it interrupts."""
    (tmp_path / "typer.py").write_text(
        "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(20)\n"
    )
    done = subprocess.run(
        [*FRAESE, "where"],
        capture_output=True,
        text=True,
        timeout=30,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}:{Path(__file__).parents[2]}"},
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")
