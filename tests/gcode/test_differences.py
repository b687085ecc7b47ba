"""The deliberate differences from LinuxCNC, as docs/gcode.md lists them: ours."""

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import Dwell, Feed, Rapid
from tests.gcode.run import moves


def test_a_do_loop_behind_a_while_that_was_left_by_break() -> None:
    text = "o1 while [1]|o1 break|o1 endwhile|o2 do|#1=[#1+1]|g0 x#1|o2 while [#1 lt 3]"
    assert [move.to[0] for move in moves(text) if isinstance(move, Rapid)] == [1, 2, 3]


def test_units_changed_within_a_series_of_cycles_leave_its_height_where_it_is() -> None:
    text = "f10 g0 z30|g98 g81 x1 z-1 r1|g20 x2"
    heights = [move.to[2] for move in moves(text) if isinstance(move, Rapid) and move.line == 3]
    assert heights == [30, pytest.approx(25.4), 30]


def test_a_tap_without_p_does_not_wait_for_another_cycle() -> None:
    text = "m4 s9 f9 g0 z5|g82 x1 z-1 r1 p.7|g80|g74 x2 z-1 r1"
    assert [move.duration_s for move in moves(text) if isinstance(move, Dwell)] == [0.7, 0.0]


def test_g94_in_force_keeps_the_feed() -> None:
    assert moves("f90 g94|g94|g1 x1")[0] == Feed(3, (1, 0, 0), 90)


@pytest.mark.parametrize("text", ["#<a>=[#<a>+1]", "#<a>=1 #<b>=#<a>"])
def test_a_name_is_not_used_where_it_is_made(text: str) -> None:
    with pytest.raises(ProgramError, match="#<a> has not been set"):
        moves(text)
