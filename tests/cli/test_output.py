"""What is said and who reads it changes neither what the machine does nor the exit code."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path

import pytest

pytest.importorskip("pty")

from tests.terminals import Pty

FRAESE = [sys.executable, "-m", "fraese"]
#: Titles, clipboard, C1, directions; a byte that is no UTF-8.
HOSTILE = "\x1b]0;owned\x07\x1b]52;c;aGk=\x1b\\\x9b2J\u202egnp\u2028"
#: What of it commands a terminal.
COMMANDS = (b"\x1b]", b"\x07", b"\xc2\x9b", "\u202e".encode(), "\u2028".encode())
DONE = "(MSG,one)\nG0 X1\n(MSG,two)\nG0 X7\nM2\n"
ALARM = "G0 X7\n#<_a> = [1 / 0]\nM2\n"


def environment(folder: Path) -> dict[str, str]:
    return {
        **os.environ,
        "TERM": "xterm",
        "XDG_CONFIG_HOME": str(folder / "config"),
        "XDG_STATE_HOME": str(folder / "state"),
        "PYTHONPATH": os.environ.get("PYTHONPATH") or str(Path(__file__).parents[2]),
    }


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    (tmp_path / "done.ngc").write_text(DONE)
    (tmp_path / "alarm.ngc").write_text("G0 X700\nM2\n")
    (tmp_path / "stream.ngc").write_text("G0 X7\nG0 X700\nM2\n")
    return tmp_path


def in_shell(folder: Path, words: str) -> subprocess.CompletedProcess[str]:
    """A line as typed in a shell; fraese stands for the program."""
    line = words.replace("fraese", " ".join(FRAESE), 1)
    return subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        env=environment(folder),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def where_mm(folder: Path) -> dict[str, float]:
    place: dict[str, float] = json.loads(in_shell(folder, "fraese where --json").stdout)[
        "position_mm"
    ]
    return place


# --- closed, full, gone --------------------------------------------------------------------------

BROKEN = [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-", ">/dev/full", "2>/dev/full", "| true"]


@pytest.mark.parametrize(("where", "as_json"), [*zip(BROKEN, cycle(["", "--json"]), strict=False)])
def test_broken_output_changes_no_exit_code(shop: Path, where: str, as_json: str) -> None:
    exits = {"done": 0, "alarm": 2, "stream --stream": 1}
    for words, code in exits.items():
        name, _, options = words.partition(" ")
        line = f"fraese run {name}.ngc {options} {as_json} {where}; exit ${{PIPESTATUS[0]}}"
        done = in_shell(shop, line)
        assert done.returncode == code, (words, done)
        assert "Traceback" not in done.stderr
    assert where_mm(shop)["x"] == 7


def test_a_result_that_cannot_be_written_is_told_on_the_other_side(shop: Path) -> None:
    done = in_shell(shop, "fraese run done.ngc >/dev/full")
    assert done.returncode == 0
    assert "the result cannot be written: No space left on device." in done.stderr


@pytest.mark.parametrize("words", ["gcode done.ngc", "config schema", "check done.ngc"])
def test_what_is_asked_for_as_output_and_cannot_be_written_is_said(shop: Path, words: str) -> None:
    done = in_shell(shop, f"fraese {words} >/dev/full")
    assert done.returncode == 1
    assert done.stderr == ("fraese: Standard output cannot be written: No space left on device.\n")


def test_a_closed_error_output_is_no_file_of_the_machine(shop: Path) -> None:
    """The next file that is opened would have its number."""
    assert in_shell(shop, "fraese run done.ngc 2>&-").returncode == 0
    done = in_shell(shop, "fraese where")
    assert done.returncode == 0, done
    assert "running at" not in "".join(
        path.read_text(errors="replace") for path in (shop / "state").rglob("*") if path.is_file()
    )


def test_a_file_that_may_not_grow_changes_no_exit_code(shop: Path) -> None:
    """The quota of who is sent SIGXFSZ; Python turns it into an error."""

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    with (shop / "said").open("wb") as said:
        said.write(b"x" * 100)
        said.flush()
        process = subprocess.Popen(
            [*FRAESE, "run", "done.ngc"],
            cwd=shop,
            env=environment(shop),
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.PIPE,
            preexec_fn=limit,
        )
        # Only what comes after the state was read counts.
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (1 << 20, resource.RLIM_INFINITY))
        process.communicate(timeout=60)
    assert process.returncode == 0


def test_letters_that_the_output_does_not_have_are_escapes(shop: Path) -> None:
    (shop / "part.ngc").write_text("(MSG,µ 漢)\nG0 X1\nM2\n")
    done = in_shell(shop, "PYTHONIOENCODING=ascii fraese run part.ngc")
    assert done.returncode == 0, done
    assert "\\xb5" in done.stderr


# --- nobody reads --------------------------------------------------------------------------------


@contextmanager
def command(folder: Path, *words: str) -> Iterator[Pty]:
    pty = Pty([*FRAESE, *words], folder, environment(folder))
    try:
        yield pty
    finally:
        pty.close()


def chatty(folder: Path, moves: int) -> None:
    """Says more than a terminal holds."""
    line = f"(MSG,{'many words ' * 20})\n"
    (folder / "chatty.ngc").write_text(
        "G21 G91\n" + f"{line}G0 X1\n{line}G0 X-1\n" * moves + "M2\n"
    )


@pytest.mark.alone
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_is_heard_while_nobody_reads(shop: Path, number: signal.Signals) -> None:
    chatty(shop, 500)
    with command(shop, "run", "chatty.ngc", "--real-time") as pty:
        pty.read_until(b"many words")
        # Until there is no room for another word.
        time.sleep(3)
        told_s = time.monotonic()
        pty.process.send_signal(number)
        assert pty.end(reading=False, within_s=3) == 130
        assert time.monotonic() - told_s < 3
    assert where_mm(shop)["x"] < 10


@pytest.mark.alone
def test_the_job_goes_on_while_nobody_reads_and_all_is_said_later(shop: Path) -> None:
    chatty(shop, 100)
    with command(shop, "run", "chatty.ngc", "--json") as pty:
        pty.read_until(b"many words")
        # The job is over, and its result waits to be read.
        time.sleep(4)
        assert pty.process.poll() is None
        seen = pty.drawn
        assert pty.end(reading=True) == 0
        seen += pty.drawn
    assert seen.count(b"many words many words") > 1900
    assert b'"status": "done"' in seen


@pytest.mark.alone
def test_a_signal_after_the_job_changes_nothing_about_its_end(shop: Path) -> None:
    chatty(shop, 100)
    with command(shop, "run", "chatty.ngc", "--json") as pty:
        pty.read_until(b"many words")
        time.sleep(4)
        pty.process.send_signal(signal.SIGTERM)
        assert pty.end(reading=False, within_s=3) == 0


# --- what is foreign -----------------------------------------------------------------------------


def hostile_shop(folder: Path) -> dict[str, tuple[str, ...]]:
    """Commands that say something foreign, by what it is."""
    (folder / "msg.ngc").write_text(f"(MSG,{HOSTILE})\nG0 X1\nM2\n")
    (folder / "print.ngc").write_text(f"(PRINT,{HOSTILE})\nG0 X1\nM2\n")
    (folder / "debug.ngc").write_text(f"(DEBUG,{HOSTILE})\nG0 X1\nM2\n")
    (folder / "abort.ngc").write_text(f"(ABORT,{HOSTILE})\nG0 X1\nM2\n")
    (folder / "word.ngc").write_text(f"G0 X1\n{HOSTILE}\nM2\n")
    (folder / "sub.ngc").write_text(f"o<{HOSTILE}> call\nM2\n")
    (folder / "point.txt").write_text(f"1 2 3\n{HOSTILE}\n")
    named = folder / f"{HOSTILE.replace('/', '')}.ngc"
    named.write_text("G0 X900\nM2\n")
    odd = os.fsencode(folder) + b"/\xff\x1b[2J.ngc"
    with open(odd, "wb") as file:
        file.write(b"G0 X900\nM2\n")
    (folder / "config.toml").write_text('[port]\nkind = "' + "\\u001b]0;owned\\u0007" + '"\n')
    (folder / "key.toml").write_text('"\\u001b]0;owned\\u0007" = 1\n')
    return {
        "MSG": ("run", "msg.ngc"),
        "PRINT": ("run", "print.ngc"),
        "DEBUG": ("run", "debug.ngc"),
        "ABORT": ("run", "abort.ngc"),
        "a word": ("run", "word.ngc"),
        "a word looked through": ("check", "word.ngc"),
        "a subroutine": ("run", "sub.ngc"),
        "a point": ("run", "point.txt"),
        "a file": ("run", named.name),
        "a file looked through": ("check", named.name),
        "a file that is not there": ("run", HOSTILE.replace("/", "")),
        "an odd file": ("run", os.fsdecode(odd)),
        "a value": ("where", "--config", "config.toml"),
        "a key": ("config", "check", "--config", "key.toml"),
        "a configuration": ("where", "--config", HOSTILE.replace("/", "")),
        "an option": ("where", f"--{HOSTILE}"),
        "a command": (HOSTILE,),
        "axis words": ("move", HOSTILE),
        "a waveform": ("trace", HOSTILE.replace("/", "")),
    }


def test_nothing_foreign_commands_a_terminal(shop: Path) -> None:
    for what, words in hostile_shop(shop).items():
        with command(shop, *words) as pty:
            pty.end(reading=True)
            assert pty.drawn, what
            for raw in COMMANDS:
                assert raw not in pty.drawn, (what, pty.drawn)
            assert b"Traceback" not in pty.drawn, (what, pty.drawn)


def test_the_log_is_plain_too(shop: Path) -> None:
    hostile_shop(shop)
    (shop / "fraese.toml").write_text("[log]\nenabled = true\nfile = 'the.log'\n")
    for name in ("msg", "abort", "word"):
        in_shell(shop, f"fraese run {name}.ngc")
    log = (shop / "the.log").read_bytes()
    assert log
    for raw in (*COMMANDS, b"\x1b"):
        assert raw not in log
