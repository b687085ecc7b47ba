"""Touching off, with and without a plate, and what a tool change asks."""

import pytest

from fraese.errors import ProbeError
from fraese.testing import Unanswered

PLATE = {"x_mm": (50, 80), "y_mm": (40, 60), "top_mm": -20}
TOUCH = "o<touch_off> call [2]\nM2\n"


@pytest.fixture
def above_the_plate(mill):
    mill.home()
    mill.put_plate(**PLATE)
    mill.move(x=60, y=50)
    return mill


def test_the_underside_of_the_plate_is_zero(above_the_plate):
    mill = above_the_plate
    mill.run(TOUCH)
    assert mill.work_mm["z"] - mill.position_mm["z"] == pytest.approx(22, abs=0.02)
    assert mill.carriages_mm["z"] == pytest.approx(-15, abs=0.02)


def test_without_a_plate_it_says_so(above_the_plate):
    mill = above_the_plate
    mill.take_away()
    with pytest.raises(ProbeError):
        mill.run(TOUCH)


def test_a_change_asks_for_the_tool_and_knows_the_new_one(above_the_plate):
    mill = above_the_plate
    done = mill.run("o<change> call [2] [2]\nM2\n", answers=[""])
    assert "tool 2" in done.asked[0]
    assert mill.work_mm["z"] - mill.position_mm["z"] == pytest.approx(22, abs=0.02)


def test_a_change_that_nobody_answers_does_not_wait_for_ever(above_the_plate):
    with pytest.raises(Unanswered, match="tool 2"):
        above_the_plate.run("o<change> call [2] [2]\nM2\n")
