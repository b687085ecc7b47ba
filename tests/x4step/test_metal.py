"""X4Step with its steps made by the step process, in real time."""

import os
import signal
import sys
import time
from itertools import pairwise
from pathlib import Path
from statistics import median

import pytest

from fraese.errors import PortError
from fraese.x4step import X4Failure, X4Step
from fraese.x4step.testing import clock_pin

if sys.platform != "linux":
    pytest.skip("the step process needs Linux", allow_module_level=True)

from tests.x4step.metal import Metal

pytestmark = pytest.mark.alone


@pytest.fixture
def metal(tmp_path: Path) -> Metal:
    return Metal(tmp_path)


def test_a_path_and_the_next_one(metal: Metal) -> None:
    with X4Step(1, metal.around) as motors:
        motors.load((500, -250, 100, 7), 2000, 50)
        motors.start()
        assert motors.moving
        motors.load((-500, 250, -100, -7), 2000, 50)
        motors.wait()
        assert motors.facts.steps == (500, -250, 100, 7)
        motors.start()
        motors.wait()
        assert motors.facts.steps == (-500, 250, -100, -7)
        assert motors.inputs == 31
    lines = metal.lines()
    assert [len(lines.rises(clock_pin(axis))) for axis in (1, 2, 3, 4)] == [1000, 500, 200, 14]
    assert [lines.steps(axis) for axis in (1, 2, 3, 4)] == [0, 0, 0, 0]
    assert not any(lines.level(pin) for pin in (1, 3, 5, 7, 9, 14, 16, 17))


def test_from_the_start_to_the_first_edge_it_takes_little_time(metal: Metal) -> None:
    starts = []
    with X4Step(1, metal.around) as motors:
        for _ in range(30):
            motors.load((10, 0, 0, 0), 2000, 0)
            starts.append(time.monotonic_ns())
            motors.start()
            motors.wait()
    rises = metal.lines().rises(clock_pin(1))
    firsts = [next(at for at in rises if at > start) for start in starts]
    # The first edge itself comes with the interval.
    gaps_ms = [(first - start) / 1e6 - 0.5 for first, start in zip(firsts, starts, strict=True)]
    assert median(gaps_ms) < 6


def test_who_sleeps_longer_than_the_silence_is_not_taken_for_hung(tmp_path: Path) -> None:
    metal = Metal(tmp_path, silent_s=0.8)
    with X4Step(1, metal.around) as motors:
        motors.move_positive(1, 1000, 0)
        time.sleep(1.7)
        made = motors.steps(1)
        time.sleep(0.3)
        assert motors.moving
        assert motors.steps(1) > made
        motors.brake()


@pytest.mark.parametrize("end", ["brake", "stop", "key"])
def test_what_is_counted_was_made_and_nothing_is_left(metal: Metal, end: str) -> None:
    with X4Step(1, metal.around) as motors:
        made = 0
        for _ in range(4):
            motors.move_negative(2, 2000, 20)
            time.sleep(0.08)
            if end == "key":
                metal.keys.press(1)
            else:
                getattr(motors, end)()
            motors.wait()
            assert motors.last_brake_code == (end == "key")
            made += motors.steps(2)
            assert metal.lines().steps(2) == made
            motors.load((0, 0, 3, 0), 1000, 0)
            motors.start()
            motors.wait()
            assert motors.steps(3) == 3


def test_a_signal_while_it_moves(metal: Metal) -> None:
    with X4Step(1, metal.around) as motors:
        motors.move_positive(1, 5000, 0)
        begin_s = time.monotonic()
        motors.set_output(1)
        assert time.monotonic() - begin_s < 1
        assert metal.lines().level(1)
        motors.stop()


def test_a_caller_that_computes_costs_no_step(metal: Metal) -> None:
    with X4Step(1, metal.around) as motors:
        motors.load((4000, 4000, 4000, 4000), 8000, 0)
        motors.start()
        until_s = time.monotonic() + 0.4
        while time.monotonic() < until_s:
            pass
        motors.wait()
        assert motors.facts.steps == (4000, 4000, 4000, 4000)
    gaps = [b - a for a, b in pairwise(metal.lines().rises(clock_pin(1)))]
    assert median(gaps) == pytest.approx(125_000, rel=0.05)


def test_a_dead_step_process_is_told_and_the_next_start_begins_again(
    metal: Metal, capsys: pytest.CaptureFixture[str]
) -> None:
    with X4Step(1, metal.around) as motors:
        motors.move_positive(1, 1000, 0)
        assert metal.driver is not None
        os.kill(metal.driver.pid, signal.SIGKILL)
        motors.wait()
        time.sleep(0.1)
        # Told once, however often it is asked for.
        assert capsys.readouterr().err.count("step process") == 1
        with pytest.raises(X4Failure, match="X4ErrNotActive"):
            motors.brake()
        time.sleep(1.2)
        motors.load((5, 0, 0, 0), 1000, 0)
        for _ in range(50):
            try:
                motors.start()
                break
            except PortError:
                time.sleep(0.1)
        motors.wait()
        assert motors.steps(1) == 5
