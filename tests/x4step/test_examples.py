"""Every example of the manual: on a simulated port, and with its keys from a real terminal."""

import os
import pty
import runpy
import select
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fraese.x4step import X4ReInit
from fraese.x4step.testing import (
    ACTIVE_PIN,
    BOOST_PIN,
    Lab,
    Lines,
    clock_pin,
    direction_pin,
    simulation,
)

FOLDER = Path(__file__).parents[2] / "examples" / "x4step"
MS = 1_000_000
EXAMPLES = sorted(path.stem for path in FOLDER.glob("e*.py"))


@pytest.fixture
def lab() -> Iterator[Lab]:
    with simulation() as lab:
        yield lab
        # Nothing was left open.
        assert X4ReInit() == 9


def play(lab: Lab, number: int) -> Lines:
    (name,) = (name for name in EXAMPLES if name.startswith(f"e{number:02d}_"))
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    lines = lab.lines()
    assert not any(lines.level(pin) for pin in (1, 3, 5, 7, 9, 14, BOOST_PIN, ACTIVE_PIN))
    return lines


def steps(lines: Lines) -> list[int]:
    return [lines.steps(axis) for axis in (1, 2, 3, 4)]


def motions(lines: Lines) -> int:
    return len(lines.rises(ACTIVE_PIN))


def press(lab: Lab, ms: float, code: int) -> None:
    lab.at_ms(ms, lambda: lab.press(code))


def is_braked(lines: Lines, axis: int, at_ms: float) -> bool:
    """From that moment on it went along a ramp of 50 ms, from 1000 Hz."""
    last_ns = lines.falls(clock_pin(axis))[-1]
    return 30 * MS < last_ns - at_ms * MS < 65 * MS


def test_there_are_all_seventeen() -> None:
    assert [int(name[1:3]) for name in EXAMPLES] == list(range(1, 18))


def test_the_frame_moves_nothing(lab: Lab) -> None:
    assert steps(play(lab, 1)) == [0, 0, 0, 0]
    assert [lpt for lpt, _ in lab.opened] == [1]


def test_there_and_back_with_four_axes(lab: Lab) -> None:
    lines = play(lab, 2)
    assert steps(lines) == [0, 0, 0, 0]
    made = [len(lines.rises(clock_pin(axis))) for axis in (1, 2, 3, 4)]
    assert made == [2000, 1600, 1200, 800]
    assert motions(lines) == 2
    assert [lpt for lpt, _ in lab.opened] == [2]


@pytest.mark.parametrize("number", [3, 4, 9])
def test_until_escape(lab: Lab, number: int) -> None:
    press(lab, 400, 28)
    press(lab, 700, 1)
    lines = play(lab, number)
    assert lines.steps(1) == pytest.approx(700, abs=15)
    assert is_braked(lines, 1, 700)


def test_load(lab: Lab) -> None:
    lines = play(lab, 5)
    assert steps(lines) == [0, 0, 0, 0]
    assert len(lines.rises(clock_pin(1))) == 2000
    assert motions(lines) == 2


def test_start(lab: Lab) -> None:
    lines = play(lab, 6)
    assert steps(lines) == [1000, 0, 0, 0]
    took_ns = lines.falls(clock_pin(1))[-1] - lines.rises(clock_pin(1))[0]
    assert took_ns == pytest.approx(1050 * MS, rel=0.02)


def test_brake(lab: Lab, capsys: pytest.CaptureFixture[str]) -> None:
    lines = play(lab, 7)
    assert is_braked(lines, 1, 300)
    assert capsys.readouterr().out == f"{lines.steps(1)} steps\n"
    assert lines.steps(1) == pytest.approx(300, abs=15)


def test_stop(lab: Lab) -> None:
    lines = play(lab, 8)
    assert lines.falls(clock_pin(1))[-1] < 302 * MS
    assert lines.steps(1) == pytest.approx(275, abs=10)


def test_getsteps(lab: Lab, capsys: pytest.CaptureFixture[str]) -> None:
    press(lab, 300, 1)
    lines = play(lab, 10)
    said = [int(line) for line in capsys.readouterr().out.split()]
    assert said == sorted(said)
    assert len(said) > 300
    assert lines.steps(1) - 2 <= said[-1] <= lines.steps(1)


def test_both_ways(lab: Lab) -> None:
    press(lab, 300, 1)
    press(lab, 900, 1)
    lines = play(lab, 11)
    first, last = (lines.rises(clock_pin(1))[place] for place in (0, -1))
    assert lines.level(direction_pin(1), first)
    assert not lines.level(direction_pin(1), last)
    assert motions(lines) == 2


@pytest.mark.parametrize(("code", "ends"), [(1, True), (28, True), (57, False)])
def test_brakecodes(lab: Lab, code: int, ends: bool) -> None:
    press(lab, 300, code)
    press(lab, 600, 1)
    lines = play(lab, 12)
    assert is_braked(lines, 1, 300 if ends else 600)


@pytest.mark.parametrize(("key", "code", "sign"), [("+", 13, 1), ("-", 12, -1)])
def test_release(lab: Lab, key: str, code: int, sign: int) -> None:
    lab.type(key)
    press(lab, 200, code)
    lab.at_ms(400, lambda: lab.release(code))
    lines = play(lab, 13)
    assert is_braked(lines, 1, 400)
    assert sign * lines.steps(1) == pytest.approx(400, abs=15)


def test_another_key_moves_nothing(lab: Lab) -> None:
    lab.type("x")
    assert steps(play(lab, 13)) == [0, 0, 0, 0]


@pytest.mark.parametrize(("code", "said"), [(1, "ESC has braked\n"), (28, "ENTER has braked\n")])
def test_lastbrakecode(lab: Lab, code: int, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    press(lab, 300, code)
    play(lab, 14)
    assert capsys.readouterr().out == said


def test_timer(lab: Lab) -> None:
    lines = play(lab, 15)
    assert lines.steps(1) == pytest.approx(500, abs=10)
    assert is_braked(lines, 1, 500)


def test_getin_with_the_pin_at_rest_ends_at_once(lab: Lab) -> None:
    assert play(lab, 16).steps(1) <= 2


def test_getin() -> None:
    with simulation(pins={15: False}) as lab:
        lab.at_ms(400, lambda: lab.set_pin(15, True))
        lines = play(lab, 16)
    assert is_braked(lines, 1, 400)


def test_setout(lab: Lab) -> None:
    press(lab, 300, 1)
    lines = play(lab, 17)
    (on,), (off,) = lines.rises(1), lines.falls(1)
    assert on <= lines.rises(ACTIVE_PIN)[0]
    assert off >= lines.falls(ACTIVE_PIN)[0]
    assert not lines.rises(14)


# --- in a terminal --------------------------------------------------------------------------


def in_terminal(number: int, keys: list[tuple[float, bytes]]) -> tuple[int, str]:
    """Run an example at a terminal, type at those times; exit code, and what was on the screen."""
    (name,) = (name for name in EXAMPLES if name.startswith(f"e{number:02d}_"))
    child, screen = pty.fork()
    if child == 0:
        os.environ["PYTHONPATH"] = str(FOLDER.parents[1])
        os.environ["XDG_CONFIG_HOME"] = "/nowhere"
        code = "print('ready', flush=True); import runpy, fraese.x4step; print('go', flush=True);"
        code += f"runpy.run_path({str(FOLDER / name) + '.py'!r}, run_name='__main__')"
        os.execv(sys.executable, [sys.executable, "-c", code])
    seen = ""
    while "go" not in seen:
        seen += os.read(screen, 1024).decode()
    for pause_s, data in keys:
        time.sleep(pause_s)
        os.write(screen, data)
    until_s = time.monotonic() + 20
    try:
        while select.select([screen], [], [], until_s - time.monotonic())[0]:
            chunk = os.read(screen, 65536)
            if not chunk:
                break
            seen += chunk.decode()
    except OSError:
        pass
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), seen.replace("\r\n", "\n")


@pytest.mark.alone
@pytest.mark.parametrize("number", [3, 4, 9, 10, 12, 14, 17])
def test_escape_at_a_terminal_ends_it_and_other_keys_do_not(number: int) -> None:
    code, seen = in_terminal(number, [(1.0, b"abc\x1b[D"), (0.3, b"\x1b")])
    assert code == 0, seen
    assert "abc" not in seen
    assert ("ESC has braked" in seen) == (number == 14)


@pytest.mark.alone
@pytest.mark.parametrize("number", [12, 14])
def test_enter_at_a_terminal(number: int) -> None:
    code, seen = in_terminal(number, [(1.0, b"\r")])
    assert code == 0, seen
    assert ("ENTER has braked" in seen) == (number == 14)


@pytest.mark.alone
def test_a_key_that_is_held_and_let_go_at_a_terminal() -> None:
    began_s = time.monotonic()
    code, seen = in_terminal(13, [(0.8, b"+"), (0.3, b"+"), (0.03, b"+"), (0.03, b"+")])
    assert code == 0, seen
    assert time.monotonic() - began_s < 15


@pytest.mark.alone
@pytest.mark.parametrize("number", [1, 2, 5, 6, 7, 8, 15, 16])
def test_the_others_end_by_themselves(number: int) -> None:
    code, seen = in_terminal(number, [])
    assert code == 0, seen


def test_a_wrong_time_is_no_time() -> None:
    with simulation("paced") as lab:
        action: Callable[[], object] = list
        lab.at_ms(1, action)
        with pytest.raises(TypeError):
            runpy.run_path(str(FOLDER / "e01_frame.py"), run_name="__main__")
