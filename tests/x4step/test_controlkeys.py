r"""Ctrl-\ and Ctrl-Z where keys are read: the terminal is as before, and nothing is left on."""

import signal
import termios
import textwrap
from pathlib import Path

import pytest

from tests.cli.test_trace_option import Wave
from tests.x4step.kittyterminal import KittyTerminal, Screen, encoded

pytestmark = pytest.mark.alone

MOVING = """
    from fraese.x4step import *
    X4Init(2)
    X4SetOut(SIGNAL1ON)
    X4MovePos(1, 1000, 50)
    print("moving", flush=True)
    while X4GetState():
        pass
    print("code", X4LastBrakeCode(), flush=True)
    X4ReInit()
"""
WAITING = """
    from fraese.x4step import *
    X4Init(2)
    X4SetOut(SIGNAL1ON)
    print("moving", flush=True)
    getch()
"""
#: A shell, as far as it stops and goes on.
SHELL = """
    import os, signal, sys, termios
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    before = termios.tcgetattr(0)
    child = os.fork()
    if not child:
        os.setpgid(0, 0)
        os.tcsetpgrp(0, os.getpid())
        signal.signal(signal.SIGTTOU, signal.SIG_DFL)
        os.execv(sys.executable, [sys.executable, "-c", sys.argv[1]])
    for word in ("stopped", "ended"):
        _, status = os.waitpid(child, os.WUNTRACED)
        same = termios.tcgetattr(0) == before
        code = os.WIFEXITED(status) and os.WEXITSTATUS(status)
        print(word, os.WIFSTOPPED(status), code, same, flush=True)
        os.killpg(child, signal.SIGCONT) if word == "stopped" else None
"""


def started(
    program: str, source: str, knows: bool, monkeypatch: pytest.MonkeyPatch, *arguments: str
) -> Screen:
    """A program in a terminal; keys come from there as said."""
    monkeypatch.setenv("FRAESE_X4STEP_KEYS", source)
    screen = Screen(KittyTerminal(knows))
    screen.start(program, *arguments)
    return screen


SOURCES = [("plain", False), ("auto", False), ("auto", True)]


@pytest.mark.parametrize(("source", "knows"), SOURCES)
@pytest.mark.parametrize("program", [MOVING, WAITING])
def test_ctrl_backslash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, source: str, knows: bool
) -> None:
    monkeypatch.setenv("FRAESE_TRACE", str(tmp_path / "lines.vcd"))
    screen = started(program, source, knows, monkeypatch)
    before = termios.tcgetattr(screen.master)
    screen.until("moving")
    screen.until_flags([31] if knows else [])
    while termios.tcgetattr(screen.master) == before:
        pass
    screen.type(encoded("\\", modifiers=4) if knows else b"\x1c")
    assert screen.end() == 128 + signal.SIGQUIT
    assert screen.left == before
    assert (screen.terminal.flags, screen.terminal.focus) == ([], False)
    wave = Wave(tmp_path / "lines.vcd")
    on = [name for name, changes in wave.changes.items() if changes[-1].value == "1"]
    assert [name for name in on if "input" not in name and "direction" not in name] == []
    assert wave.edges("pin01_signal1", "1")


@pytest.mark.parametrize(("source", "knows"), SOURCES)
def test_ctrl_z_stops_it_in_a_terminal_that_is_as_before(
    monkeypatch: pytest.MonkeyPatch, source: str, knows: bool
) -> None:
    screen = started(SHELL, source, knows, monkeypatch, textwrap.dedent(MOVING))
    screen.until("moving")
    screen.until_flags([31] if knows else [])
    screen.type(encoded("z", modifiers=4) if knows else b"\x1a")
    screen.until("stopped True False True")
    screen.until_flags([31] if knows else [])
    screen.type(encoded("ESC") if knows else b"\x1b")
    screen.until("code 1")
    screen.until("ended False 0 True")
    assert screen.end() == 0
    assert screen.terminal.flags == []
