"""The owner's thread, in real time: the caller sleeps, computes, or asks without a pause."""

import time
from bisect import bisect_right
from collections.abc import Iterator

import pytest

from fraese.x4step import (
    X4Brake,
    X4ClearTimer,
    X4GetIn,
    X4GetState,
    X4GetSteps,
    X4GetTimer,
    X4Init,
    X4Load,
    X4MovePos,
    X4ReInit,
    X4SetOut,
    X4Start,
    X4Stop,
)
from fraese.x4step.testing import Lab, clock_pin, simulation

pytestmark = pytest.mark.alone


@pytest.fixture
def lab() -> Iterator[Lab]:
    with simulation("paced") as lab:
        assert X4Init(2) == 0
        yield lab
        X4Stop()
        X4ReInit()


def test_it_moves_the_moment_the_start_returns_and_a_loop_sees_the_end(lab: Lab) -> None:
    begin_s = time.monotonic()
    X4Load(200, 100, 0, 0, 1000, 50)
    assert X4Start() == 0
    assert X4GetState() > 0
    asked = 1
    while X4GetState():
        asked += 1
    took_s = time.monotonic() - begin_s
    assert 0.2 < took_s < 2
    # Whoever asks again and again is made to wait a little.
    assert asked < took_s * 5000
    assert [X4GetSteps(axis) for axis in (1, 2, 3, 4)] == [200, 100, 0, 0]
    assert lab.lines().steps(1) == 200


@pytest.mark.parametrize("busy", [False, True])
def test_steps_go_on_while_the_caller_does_something_else(lab: Lab, busy: bool) -> None:
    X4MovePos(1, 1000, 50)
    X4ClearTimer()
    until_s = time.monotonic() + 0.6
    if busy:
        while time.monotonic() < until_s:
            pass
    else:
        time.sleep(0.6)
    made, ms = X4GetSteps(1), X4GetTimer()
    # In the port's time, which a machine that is busy with something else may hold back.
    assert made == pytest.approx(ms - 25, abs=25)
    assert ms > 100
    lab.press(1)
    time.sleep(0.2)
    while X4GetState():
        pass
    assert lab.lines().steps(1) == X4GetSteps(1)


def test_steps_that_are_told_of_were_made_a_moment_ago(lab: Lab) -> None:
    X4MovePos(1, 5000, 100)
    told, until_s = [], time.monotonic() + 0.5
    while time.monotonic() < until_s:
        steps = X4GetSteps(1)
        told.append((steps, lab.now_ns()))
    X4Stop()
    rises = lab.lines().rises(clock_pin(1))
    assert told == sorted(told)
    for steps, at_ns in told:
        made = bisect_right(rises, at_ns)
        assert steps <= made
        assert steps == made or at_ns - rises[steps] <= 20_000_000
    assert told[-1][0] > 500


def test_inputs_and_signals_while_it_moves(lab: Lab) -> None:
    X4MovePos(1, 10, 0)
    lab.set_pin(15, False)
    until_s = time.monotonic() + 2
    while X4GetIn() & 1 and time.monotonic() < until_s:
        pass
    assert X4GetIn() == 0b11110
    begin_s = time.monotonic()
    assert X4SetOut(1) == 0
    assert time.monotonic() - begin_s < 0.5
    assert lab.lines().level(1)


def test_the_timer_at_standstill(lab: Lab) -> None:
    X4ClearTimer()
    begin_s = time.monotonic()
    time.sleep(0.1)
    measured = X4GetTimer()
    # A machine that is busy with something else may let the owner be late at first.
    assert 50 <= measured <= (time.monotonic() - begin_s) * 1000 + 50


def test_braking_and_the_end(lab: Lab) -> None:
    X4MovePos(3, 2000, 100)
    time.sleep(0.2)
    assert X4Brake() == 0
    assert X4ReInit() == 0
    lines = lab.lines()
    assert not any(lines.level(pin) for pin in (1, 7, 14, 16, 17))
    gaps = [b - a for a, b in zip(lines.rises(7)[-20:], lines.rises(7)[-19:], strict=False)]
    assert gaps[-1] > gaps[0]
    assert clock_pin(3) == 7


def test_an_error_in_the_owner_itself_stops_the_motors(
    lab: Lab, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken() -> list[int]:
        raise RuntimeError("broken")

    X4MovePos(1, 1000, 0)
    time.sleep(0.05)
    monkeypatch.setattr(lab.keys, "codes", broken)
    until_s = time.monotonic() + 10
    while X4GetState():
        assert time.monotonic() < until_s
    assert X4GetSteps(1) == lab.lines().steps(1) > 0
    assert X4Load(5, 0, 0, 0, 1000, 0) == 0
    assert X4Start() == 6
    assert X4GetState() == 0
    said = capsys.readouterr().err.splitlines()
    assert said == [
        "x4step: Stopped by an error in the program itself: RuntimeError('broken').",
        "x4step: Nobody looks after the motors any more, since that error; X4Init begins anew.",
    ]
    assert X4ReInit() == 0
    assert not any(lab.lines().level(pin) for pin in (1, 3, 14, 16, 17))
    monkeypatch.undo()
    assert X4Init(2) == 0
    assert X4Load(5, 0, 0, 0, 1000, 0) == 0
    assert X4Start() == 0
