"""The terminal before the app is there: what is typed then, and how it is left."""

import os
import signal
import termios
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pytest.importorskip("pty")

from fraese.cli import app as command_line
from fraese.earlyterminal import PLAIN, VALUED, starts_the_app
from tests.terminals import PATIENCE_S, Pty
from tests.ui.test_bad_terminals import QUIT, RIGHT, app, carriage_steps, environment

XOFF = b"\x13"


def mode(pty: Pty) -> list[object]:
    return termios.tcgetattr(pty.near)


def takes_keys(pty: Pty) -> bool:
    """The terminal keeps none for itself."""
    return not termios.tcgetattr(pty.near)[0] & termios.IXON


@contextmanager
def started(folder: Path, *words: str, **also: str) -> Iterator[tuple[Pty, list[object]]]:
    """The app from the moment in which it has taken the terminal; and how that was before."""
    before = mode_of_a_new_one()
    with app(folder, size=(24, 80), words=words, **also) as pty:
        until_s = time.monotonic() + PATIENCE_S
        while not takes_keys(pty) and time.monotonic() < until_s:
            time.sleep(0.001)
        yield pty, before


def mode_of_a_new_one() -> list[object]:
    near, far = os.openpty()
    try:
        return termios.tcgetattr(near)
    finally:
        os.close(near)
        os.close(far)


def slow(folder: Path) -> dict[str, str]:
    """What the app is made of takes for ever to read."""
    (folder / "typer.py").write_text("import time\ntime.sleep(60)\n")
    return {"PYTHONPATH": f"{folder}:{environment(folder)['PYTHONPATH']}"}


@pytest.mark.alone
def test_quit_before_anything_is_drawn_quits(tmp_path: Path) -> None:
    with started(tmp_path) as (pty, before):
        assert b"\x1b[?1049h" not in pty.drawn
        pty.type(QUIT)
        assert pty.end(reading=True) == 0
        assert mode(pty) == before


@pytest.mark.alone
def test_what_is_typed_before_anything_is_drawn_moves_nothing(tmp_path: Path) -> None:
    """Neither echoed nor done; a terminal that was told to wait does not; half a key is none."""
    with started(tmp_path) as (pty, before):
        pty.type(b"5" + RIGHT + b"g1\r" + XOFF + RIGHT + RIGHT[:2])
        pty.read_until(b"\x1b[?1049h")
        pty.type(RIGHT[2:])
        pty.read_until(b"Hold")
        while pty.read(0.5):
            pass
        pty.type(QUIT)
        assert pty.end(reading=True) == 0
        assert b"^[[C" not in pty.drawn
        assert mode(pty) == before
    # At most the arrow whose end came later, with the first step width.
    assert carriage_steps(tmp_path)[0] <= 200


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGINT])
def test_a_signal_gives_the_terminal_back(tmp_path: Path, number: signal.Signals) -> None:
    with started(tmp_path, **slow(tmp_path)) as (pty, before):
        pty.process.send_signal(number)
        code = pty.end(reading=True)
        assert code == (130 if number == signal.SIGINT else -number)
        assert mode(pty) == before


def test_ctrl_c_ends_it_and_ctrl_z_and_ctrl_backslash_do_not(tmp_path: Path) -> None:
    with started(tmp_path, **slow(tmp_path)) as (pty, before):
        pty.type(b"\x1a\x1c")
        time.sleep(0.3)
        assert pty.process.poll() is None
        assert takes_keys(pty)
        pty.type(b"\x03")
        assert pty.end(reading=True) == 130
        assert mode(pty) == before


@pytest.mark.parametrize(
    ("text", "code"), [("nonsense = 1\n", 2), ('[port]\nkind = "ppdev"\ndevice = "/x/y"\n', None)]
)
def test_a_start_that_is_refused_gives_it_back(tmp_path: Path, text: str, code: int | None) -> None:
    (tmp_path / "fraese.toml").write_text(text)
    with started(tmp_path) as (pty, before):
        ended = pty.end(reading=True)
        assert ended == code if code else ended > 0
        assert mode(pty) == before
        assert b"fraese: " in pty.drawn


@pytest.mark.alone
def test_a_way_out_that_is_blocked_gives_it_back_too(tmp_path: Path) -> None:
    with started(tmp_path) as (pty, before):
        pty.read_until(b"Hold")
        for _ in range(30):
            pty.type(b"v")
            time.sleep(0.05)
        pty.process.send_signal(signal.SIGTERM)
        assert pty.end(reading=False) == 128 + signal.SIGTERM
        assert mode(pty) == before


@pytest.mark.parametrize("words", [(), ("--fresh",), ("--state", "s"), ("--open=a", "--fresh")])
def test_these_words_start_the_app(words: tuple[str, ...]) -> None:
    assert starts_the_app(words)


@pytest.mark.parametrize(
    "words", [("where",), ("--help",), ("--state",), ("--fresh", "run"), ("--state", "s", "jog")]
)
def test_these_do_not_and_leave_the_terminal_alone(words: tuple[str, ...]) -> None:
    assert not starts_the_app(words)


#: Whoever asks for these gets no app.
ENDING = ("--help", "-h", "--version")


def test_all_options_of_the_app_are_known() -> None:
    callback = command_line.registered_callback
    assert callback is not None
    import typer.main

    command = typer.main.get_command(command_line)
    options = {
        name: not getattr(each, "is_flag", False)
        for each in command.params
        for name in each.opts
        if name not in ENDING
    }
    assert options == {**dict.fromkeys(VALUED, True), **dict.fromkeys(PLAIN, False)}


def test_in_the_background_it_is_left_alone(tmp_path: Path) -> None:
    """Who takes it there is stopped by the system."""
    near, far = os.openpty()
    before = termios.tcgetattr(near)
    from fraese.earlyterminal import EarlyTerminal

    taken = EarlyTerminal()
    taken.take(far)
    assert taken.before is None
    assert termios.tcgetattr(near) == before
    for fd in (near, far):
        os.close(fd)
