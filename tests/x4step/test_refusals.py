"""Every limit and every code of the manual, at the limit and one beyond; nothing moves for it."""

from collections.abc import Callable, Iterator
from itertools import repeat
from typing import Any

import numpy as np
import pytest

from fraese.x4step import (
    X4Brake,
    X4BrakeCodes,
    X4ClearTimer,
    X4GetIn,
    X4GetState,
    X4GetSteps,
    X4GetTimer,
    X4Init,
    X4LastBrakeCode,
    X4Load,
    X4MoveNeg,
    X4MovePos,
    X4ReInit,
    X4SetOut,
    X4Start,
    X4Step,
    X4Stop,
)
from fraese.x4step.codes import X4Failure
from fraese.x4step.testing import Lab, clock_pin, simulation

MOST = 16_777_216
PATH = (1000, 0, 0, 0)


@pytest.fixture
def lab() -> Iterator[Lab]:
    with simulation() as lab:
        yield lab
        X4Stop()
        X4ReInit()


@pytest.fixture
def ready(lab: Lab) -> Lab:
    assert X4Init(2) == 0
    return lab


def nothing_moved(lab: Lab) -> bool:
    lines = lab.lines()
    return not X4GetState() and not any(lines.rises(clock_pin(axis)) for axis in (1, 2, 3, 4))


#: freq, ramp, and the answers of X4Load and X4MovePos alike.
RATES = [
    (10, 0, 0), (9, 0, 3), (0, 0, 3), (-1, 0, 3), (-32768, 0, 3),
    (20_000, 0, 0), (20_001, 0, 2), (32_767, 0, 2),
    (20_000, 1000, 0), (20_000, 1001, 4), (20_000, 32_767, 4), (1000, 1000, 0), (1000, 1001, 4),
    (20_000, -1, 8), (1000, -32_768, 8),
    (1000, 100, 0), (100, 90, 0), (100, 100, 0), (100, 101, 5), (10, 10, 0), (10, 11, 5),
    (10, 50, 5), (999, 1000, 5), (999, 999, 0),
    # Several at once: as the printed lists go.
    (20_001, 1001, 2), (5, 50, 3), (5, 1001, 3), (500, 1500, 4), (9, -1, 3), (20_001, -1, 2),
]  # fmt: skip


@pytest.mark.parametrize(("freq", "ramp", "code"), RATES)
def test_rate_and_ramp_of_a_load(ready: Lab, freq: int, ramp: int, code: int) -> None:
    assert X4Load(*PATH, freq, ramp) == code
    assert nothing_moved(ready)
    assert X4Start() == (11 if code else 0)


@pytest.mark.parametrize("move", [X4MovePos, X4MoveNeg])
@pytest.mark.parametrize(("freq", "ramp", "code"), RATES)
def test_rate_and_ramp_of_an_endless_move(
    ready: Lab, move: Callable[[int, int, int], int], freq: int, ramp: int, code: int
) -> None:
    assert move(1, freq, ramp) == code
    assert X4GetState() == (0 if code else 1)
    assert not code or nothing_moved(ready)


@pytest.mark.parametrize("axis", [0, 1, 2, 3])
@pytest.mark.parametrize(
    ("steps", "code"),
    [(MOST, 0), (-MOST, 0), (MOST + 1, 13), (-MOST - 1, 13), (2**31 - 1, 13), (-(2**31), 13),
     (1, 0), (-1, 0), (0, 1)],
)  # fmt: skip
def test_steps_of_every_axis(ready: Lab, axis: int, steps: int, code: int) -> None:
    way = [0, 0, 0, 0]
    way[axis] = steps
    assert X4Load(way[0], way[1], way[2], way[3], 1000, 50) == code
    assert nothing_moved(ready)
    assert X4Start() == (11 if code else 0)


@pytest.mark.parametrize(
    ("way", "freq", "ramp", "code"),
    [((0, 0, 0, 0), 9, 0, 3), ((0, 0, 0, 0), 1000, 1001, 4), ((MOST + 1, 0, 0, 0), 20_001, 0, 2),
     ((MOST + 1, 0, 0, 0), 100, 101, 5), ((MOST, MOST, MOST, MOST), 1000, 0, 0)],
)  # fmt: skip
def test_what_is_said_of_a_load_with_several_faults(
    ready: Lab, way: tuple[int, int, int, int], freq: int, ramp: int, code: int
) -> None:
    assert X4Load(*way, freq, ramp) == code


@pytest.mark.parametrize("lpt", [0, 5, -1, 255, 32_767])
def test_a_number_that_is_no_port(lab: Lab, lpt: int) -> None:
    assert X4Init(lpt) == 8
    assert lab.opened == []
    assert X4Load(*PATH, 1000, 50) == 9


@pytest.mark.parametrize("lpt", [1, 2, 3, 4])
def test_every_port_is_there_without_a_configuration(lab: Lab, lpt: int) -> None:
    assert X4Init(lpt) == 0
    assert [number for number, _ in lab.opened] == [lpt]


@pytest.mark.parametrize("axis", [0, 5, -1, 255])
def test_an_axis_that_is_none(ready: Lab, axis: int) -> None:
    assert X4MovePos(axis, 1000, 50) == 8
    assert X4MoveNeg(axis, 1000, 50) == 8
    assert X4GetSteps(axis) == 0
    assert nothing_moved(ready)


@pytest.mark.parametrize("signal", [0, 5, -1, 255])
def test_a_signal_that_is_none(ready: Lab, signal: int) -> None:
    before = len(ready.recorder().accesses)
    assert X4SetOut(signal) == 8
    assert ready.recorder().writes() == ready.recorder().writes()[:before]
    assert not ready.lines().level(1)
    assert not ready.lines().level(14)


def test_before_init(lab: Lab) -> None:
    assert X4Load(*PATH, 1000, 50) == 9
    assert X4MovePos(1, 1000, 50) == 9
    assert X4MoveNeg(1, 1000, 50) == 9
    assert X4ReInit() == 9
    assert X4BrakeCodes(b"\x1c\x00") == 9
    assert X4SetOut(1) == 9
    # Their lists have no 9.
    assert X4Start() == 11
    assert X4Brake() == 7
    assert X4Stop() == 7
    X4ClearTimer()
    assert [X4GetState(), X4GetSteps(1), X4GetTimer(), X4GetIn(), X4LastBrakeCode()] == [0] * 5
    assert lab.opened == []


def test_before_init_comes_before_everything_else(lab: Lab) -> None:
    assert X4Load(0, 0, 0, 0, 0, -1) == 9
    assert X4MovePos(9, 0, -1) == 9
    assert X4SetOut(9) == 9


def test_at_standstill_there_is_nothing_to_brake(ready: Lab) -> None:
    assert X4Brake() == 7
    assert X4Stop() == 7
    assert X4Start() == 11
    assert X4Load(*PATH, 1000, 50) == 0
    assert X4Brake() == 7
    assert X4Stop() == 7
    assert nothing_moved(ready)


def test_a_second_load_is_refused_whatever_it_says_and_the_first_is_driven(ready: Lab) -> None:
    assert X4Load(7, 0, 0, 0, 1000, 50) == 0
    assert X4Load(*PATH, 1000, 50) == 12
    assert X4Load(0, 0, 0, 0, 0, -1) == 12
    assert X4MovePos(1, 1000, 50) == 12
    assert X4MoveNeg(9, 0, 50) == 12
    assert nothing_moved(ready)
    assert X4Start() == 0
    while X4GetState():
        pass
    assert ready.lines().steps(1) == 7


@pytest.mark.parametrize("endless", [False, True])
def test_while_axes_move(ready: Lab, endless: bool) -> None:
    if endless:
        assert X4MovePos(2, 1000, 50) == 0
    else:
        assert X4Load(0, 1000, 0, 0, 1000, 50) == 0
        assert X4Start() == 0
    assert X4GetState() > 0
    assert X4Start() == 10
    assert X4MovePos(1, 1000, 50) == 10
    assert X4MoveNeg(9, 0, 50) == 10
    assert X4Init(2) == 10
    # Loading is allowed, and then: 10 before 12, and before 11.
    assert X4Load(0, 0, 0, 0, 1000, 50) == 1
    assert X4Load(*PATH, 1000, 50) == 0
    assert X4Load(*PATH, 1000, 50) == 12
    assert X4Start() == 10
    assert X4MovePos(1, 1000, 50) == 10
    assert X4Brake() == 0
    assert X4Brake() == 0
    assert X4Stop() == 0
    while X4GetState():
        pass
    assert X4Load(*PATH, 1000, 50) == 12
    assert X4Start() == 0


@pytest.mark.parametrize(
    ("codes", "code"),
    [(bytes(range(2, 22)), 0), (bytes(range(2, 23)), 8), ([*range(2, 22), 0, 99, 98], 0),
     ((28, 57), 0), (bytearray(b"\x1c\x00"), 0), ([], 0), (b"\x00", 0), ([255, 128, 1], 0),
     ([256], 8), ([-300], 8), ("\x1c\x9c\0", 0)],
)  # fmt: skip
def test_brake_codes(ready: Lab, codes: list[int] | str, code: int) -> None:
    assert X4BrakeCodes(codes) == code


def test_after_reinit_nothing_is_left(ready: Lab) -> None:
    assert X4Load(*PATH, 1000, 50) == 0
    X4BrakeCodes([28])
    assert X4ReInit() == 0
    assert X4ReInit() == 9
    assert X4Start() == 11
    assert X4Init(2) == 0
    assert X4GetTimer() == 0
    assert X4Start() == 11
    assert X4MovePos(1, 1000, 50) == 0
    ready.press(28)
    for _ in range(500):
        X4GetState()
    assert X4GetState() > 0


def test_the_class_raises_what_the_functions_answer(lab: Lab) -> None:
    with pytest.raises(X4Failure, match=r"X4ErrParamFail \(8\)"):
        X4Step(5)
    with X4Step(3) as motors:
        with pytest.raises(X4Failure, match=r"X4ErrRampFreq \(5\)") as refused:
            motors.load((1, 2), 100, 101)
        assert refused.value.code == 5
        with pytest.raises(X4Failure, match="X4ErrParamFail"):
            motors.load((1, 2, 3, 4, 5), 100, 10)
        with pytest.raises(X4Failure, match="X4ErrNotActive"):
            motors.brake()
        with pytest.raises(TypeError):
            motors.load((1.5,), 1000, 50)  # type: ignore[arg-type]
    with pytest.raises(X4Failure, match="X4ErrInitNotDone"):
        motors.load((1,), 1000, 50)
    with pytest.raises(X4Failure, match="X4ErrNotActive"):
        motors.stop()


def took_s(lab: Lab) -> float:
    """How long the motion took."""
    lines = lab.lines()
    return (lines.falls(17)[0] - lines.rises(17)[0]) / 1e9


@pytest.mark.parametrize("kind", [int, np.int16, np.uint16])
def test_any_kind_of_integer_will_do(lab: Lab, kind: Callable[[int], int]) -> None:
    """Also one that overflows where programs compute with it."""
    assert X4Init(kind(2)) == 0
    assert X4Load(kind(25_000), -7, kind(0), kind(0), kind(20_000), kind(1000)) == 0
    assert X4Start() == 0
    while X4GetState():
        pass
    assert [X4GetSteps(kind(axis)) for axis in (1, 2)] == [25_000, -7]
    assert took_s(lab) == pytest.approx(1.25 + 1, rel=0.01)
    assert X4MovePos(kind(3), kind(1000), kind(50)) == 0
    assert X4Stop() == 0
    assert X4SetOut(kind(3)) == 0
    assert lab.lines().level(14)


@pytest.mark.parametrize("wrong", [1.0, 2.5, "1", b"1", None, [], 1j])
def test_what_is_no_integer_changes_nothing(ready: Lab, wrong: object) -> None:
    """A compiler would have said so."""
    said: list[Callable[[Any], Any]] = [
        X4Init,
        X4SetOut,
        X4GetSteps,
        lambda no: X4Load(no, 0, 0, 0, 1000, 50),
        lambda no: X4Load(1, 0, 0, 0, no, 0),
        lambda no: X4Load(1, 0, 0, 0, 1000, no),
        lambda no: X4MovePos(no, 1000, 50),
        lambda no: X4MoveNeg(1, no, 0),
        lambda no: X4BrakeCodes([28, no]),
    ]
    for call in said:
        with pytest.raises(TypeError):
            call(wrong)
    assert nothing_moved(ready)
    assert X4Start() == 11
    assert [number for number, _ in ready.opened] == [2]
    assert X4Load(*PATH, 1000, 50) == 0


def test_codes_without_an_end_are_too_many(ready: Lab) -> None:
    assert X4BrakeCodes(repeat(28)) == 8
    assert X4BrakeCodes(iter([28, 57])) == 0
