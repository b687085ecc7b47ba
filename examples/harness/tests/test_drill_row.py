"""Where the holes are, how deep, and that nothing is in the way."""

import pytest

from fraese.errors import LimitError, SwitchAlarm

ROW = "G0 Y40\no<drill_row> call [20] [15] [4] [-25]\nM2\n"


def test_holes_are_as_far_apart_and_as_deep_as_asked(mill):
    mill.home()
    deepest = {}

    def look():
        here = mill.carriages_mm
        if here["z"] < -20:
            deepest[round(here["x"], 1)] = min(here["z"], deepest.get(round(here["x"], 1), 0))

    mill.each(look)
    mill.run(ROW)
    assert sorted(deepest) == [20, 35, 50, 65]
    assert all(-25.01 <= z < -24.5 for z in deepest.values())


def test_no_step_is_lost_and_it_ends_above_the_work(mill):
    mill.home()
    done = mill.run(ROW)
    assert not any(done.lost_steps.values())
    assert mill.carriages_mm["z"] == pytest.approx(mill.position_mm["z"])
    assert done.duration_s < 60


def test_a_row_that_does_not_fit_is_refused_before_anything_moves(mill):
    mill.home()
    with pytest.raises(LimitError, match="X"):
        mill.run("o<drill_row> call [20] [80] [4] [-25]\nM2\n")
    assert mill.position_mm["x"] == 0


def test_a_switch_that_closes_half_way_stops_it(mill):
    mill.home()
    mill.at(2, lambda: mill.press("ymax"))
    with pytest.raises(SwitchAlarm):
        mill.run(ROW)
    mill.release("ymax")
    mill.acknowledge()
    assert 0 < mill.carriages_mm["y"] < 160
