"""The machine that tests of others get: what it does, what it sees, and that it always ends."""

import subprocess
import sys
from pathlib import Path

import pytest

from fraese.control.state import Status
from fraese.errors import Cancelled, HomingError, LimitError, ProbeError, ProgramError, SwitchAlarm
from fraese.testing import Mill, NeverCame, TookTooLong, Unanswered
from fraese.testing.failures import NoSuchName

MACHINES = Path(__file__).parents[2] / "examples" / "machines"
SQUARE = "G21 G90\nG1 X20 F1200\nG1 Y20\nG1 X0\nG1 Y0\nM2\n"
ASKING = "G21 G90\nG1 X5 F1200\nT2 M6\nG1 X10\nM0 (look at it)\nG1 X15\nM2\n"
FOR_EVER = "o1 while [1]\nG1 X5 F600\nG1 X0\no1 endwhile\nM2\n"


def test_commands_are_done_when_they_come_back(mill: Mill) -> None:
    mill.home()
    assert mill.state.referenced == (True, True, True)
    mill.move(x=12.5, y=3, feed=600)
    mill.move(x=-2.5, relative=True)
    mill.zero("x")
    mill.jog("x", 1)
    assert mill.position_mm == {"x": 11, "y": 3, "z": 0}
    assert mill.work_mm == {"x": 1, "y": 3, "z": 0}
    assert mill.carriages_mm == pytest.approx(mill.position_mm, abs=0.01)
    mill.move(x=5, machine=True)
    assert mill.position_mm["x"] == 5


def test_a_program_says_what_came_of_it(mill: Mill, tmp_path: Path) -> None:
    file = tmp_path / "square.ngc"
    file.write_text(SQUARE)
    of_text, of_file = mill.run(SQUARE), mill.run(file)
    assert of_text.duration_s == pytest.approx(of_file.duration_s, abs=0.2)
    assert 7 < of_text.duration_s < 9
    assert (of_text.asked, of_text.lost_steps) == ((), {"x": 0, "y": 0, "z": 0})
    assert of_text.blocks > 4


def test_what_is_refused_is_raised_and_nothing_has_moved(mill: Mill) -> None:
    mill.home()
    with pytest.raises(LimitError):
        mill.move(x=1000)
    with pytest.raises(ProgramError, match="line 2"):
        mill.run("G1 X5 F100\nG1 Q!\n")
    with pytest.raises(NoSuchName, match="'u' is none of x, y, z"):
        mill.move(u=3)
    with pytest.raises(NoSuchName, match="'q' is none"):
        mill.home("q")
    with pytest.raises(NoSuchName, match="'xmid' is none of xmin, xmax"):
        mill.press("xmid")
    assert mill.position_mm == {"x": 0, "y": 0, "z": 0}


# --- questions -----------------------------------------------------------------------------------


def test_a_question_that_nobody_answers_ends_the_run(mill: Mill) -> None:
    with pytest.raises(Unanswered, match="put in tool 2") as raised:
        mill.run(ASKING)
    assert "tool 2" in raised.value.question
    assert mill.position_mm["x"] == 5
    mill.move(x=0)


def test_answers_come_in_turn_and_may_move_by_hand(mill: Mill) -> None:
    done = mill.run(ASKING, answers=["jog Z 2", "zero Z", "", ""])
    assert [("tool 2" in asked, "look at it" in asked) for asked in done.asked] == [
        (True, False),
        (False, True),
    ]
    assert mill.position_mm["x"] == 15
    assert mill.work_mm["z"] != mill.position_mm["z"]


def test_somebody_may_answer_who_looks_at_the_machine(mill: Mill) -> None:
    seen: list[float] = []

    def answer(question: str) -> str:
        seen.append(mill.carriages_mm["x"] - mill_began)
        return ""

    mill_began = mill.carriages_mm["x"]
    mill.run(ASKING, answers=answer)
    assert seen == pytest.approx([5, 10], abs=0.01)


def test_too_few_answers_and_refused_ones_are_told(mill: Mill) -> None:
    with pytest.raises(Unanswered, match="look at it"):
        mill.run(ASKING, answers=[""])
    with pytest.raises(Unanswered, match="'dance' was refused"):
        mill.run(ASKING, answers=["dance"])
    assert len(mill.run(ASKING, yes=True).asked) == 2
    with pytest.raises(Unanswered, match="look at it"):
        mill.run(ASKING, answers="")


# --- every run ends ------------------------------------------------------------------------------


def test_a_run_has_a_limit_of_machine_time(mill: Mill) -> None:
    with pytest.raises(TookTooLong, match=r"takes 8 s: not over after 1 s of machine time"):
        mill.run(SQUARE, limit_s=1)
    assert mill.now_s < 1
    mill.limit_s = 2
    with pytest.raises(TookTooLong, match="not over after 2 s"):
        mill.move(x=100, feed=600)
    assert mill.state.status is Status.CANCEL
    assert mill.now_s < 4


def test_a_hold_that_nobody_ends_and_a_program_without_end_come_to_an_end(
    mill: Mill, monkeypatch: pytest.MonkeyPatch
) -> None:
    mill.at(1, mill.hold)
    with pytest.raises(TookTooLong):
        mill.run(SQUARE, limit_s=60)
    monkeypatch.setattr("fraese.testing.patience.REAL_S", 0.3)
    with pytest.raises(TookTooLong, match="real time"):
        mill.run(FOR_EVER)
    mill.run(SQUARE)


def test_what_is_done_meanwhile_is_done_then(mill: Mill) -> None:
    mill.at(1, mill.hold)
    mill.at(4, mill.resume)
    held = mill.run(SQUARE)
    assert held.duration_s == pytest.approx(mill.run(SQUARE).duration_s + 3, abs=0.4)
    mill.when(lambda: mill.position_mm["y"] > 5, mill.cancel, "Y above 5")
    with pytest.raises(Cancelled):
        mill.run(SQUARE)
    assert 5 < mill.position_mm["y"] < 10
    mill.at(100, mill.hold)
    with pytest.raises(NeverCame, match="100 s"):
        mill.run("G1 X0 Y0 F1200\nM2\n")


# --- hands ---------------------------------------------------------------------------------------


def test_a_switch_that_is_pressed_stops_it_until_it_is_acknowledged(mill: Mill) -> None:
    mill.home()
    mill.at(0.5, lambda: mill.press("xmax"))
    with pytest.raises(SwitchAlarm, match="xmax"):
        mill.move(x=100, feed=600)
    assert mill.pressed == {"xmax"}
    mill.release("xmax")
    assert mill.pressed == frozenset()
    mill.acknowledge()
    mill.jog("x", -1)


def test_a_carriage_that_is_held_loses_steps(mill: Mill) -> None:
    mill.home()
    mill.block("y")
    lost = mill.move(y=5, x=5).lost_steps
    assert lost == {"x": 0, "y": pytest.approx(1000, abs=8), "z": 0}
    assert mill.lost_why == {"x": "", "y": "blocked", "z": ""}
    assert mill.carriages_mm["y"] == pytest.approx(0, abs=0.05)
    mill.block("y", False)
    with pytest.raises(NoSuchName):
        mill.block("w")


def test_without_power_there_is_no_current_and_nothing_moves(mill: Mill) -> None:
    mill.home()
    mill.each(lambda: seen.append(mill.currents["x"].a_percent))
    seen: list[int] = []
    mill.move(x=5)
    assert any(seen)
    mill.at(0.5, mill.cut_power)
    done = mill.move(x=25, feed=600)
    assert done.lost_steps["x"] > 1000
    assert mill.move(x=24).lost_steps["x"] < 0
    assert mill.lost_why["x"] == "without current"
    assert set(mill.currents.values()) == {(0, 0)}
    mill.restore_power()
    # A motor catches its field again where it comes by.
    assert abs(mill.move(x=20).lost_steps["x"]) < 8
    # It does not know what it has lost; a reference run does.
    assert mill.carriages_mm["x"] < mill.position_mm["x"] - 5
    mill.home("x")
    assert mill.carriages_mm["x"] == pytest.approx(mill.position_mm["x"], abs=0.01)


def test_a_reference_run_without_power_finds_nothing(mill: Mill) -> None:
    mill.cut_power()
    with pytest.raises(HomingError):
        mill.home("x")


def test_a_plate_is_felt_where_it_lies_and_only_there(mill: Mill) -> None:
    probe = "G38.2 Z-40 F300\nM2\n"
    mill.home()
    mill.put_plate(x_mm=(50, 80), y_mm=(40, 60), top_mm=-20)
    mill.move(x=60, y=50)
    mill.run(probe)
    assert mill.carriages_mm["z"] == pytest.approx(-20, abs=0.15)
    mill.jog("z", 15)
    mill.put_plate(x_mm=(50, 80), y_mm=(40, 60), top_mm=-10)
    mill.run(probe)
    assert mill.carriages_mm["z"] == pytest.approx(-10, abs=0.15)
    mill.jog("z", 5)
    mill.take_away()
    with pytest.raises(ProbeError):
        mill.run(probe)
    with pytest.raises(NoSuchName):
        mill.take_away()


def test_lines_are_recorded_as_they_were(mill: Mill) -> None:
    mill.jog("x", 0.1)
    with mill.record() as lines:
        mill.jog("x", 0.5)
    # Half-steps of 0.005 mm, each with a strobe: pin 1 is inverted.
    strobes = [edge for edge in lines.edges(1) if not edge.high]
    assert len(strobes) >= 100
    times_s = [edge.at_s for edge in strobes]
    assert times_s == sorted(times_s)
    assert times_s[0] >= 0
    assert times_s[-1] < mill.now_s
    assert len(lines.writes()) > 2 * len(strobes)
    count = len(lines.accesses)
    mill.jog("x", 0.5)
    assert len(lines.accesses) == count
    with pytest.raises(NoSuchName, match="'18' is none of"):
        lines.edges(18)


def test_the_same_run_makes_the_same_writes() -> None:
    def writes() -> list[tuple[int, int]]:
        with Mill() as mill, mill.record() as lines:
            mill.run(SQUARE)
        return lines.writes()

    assert writes() == writes()


# --- what it is made of --------------------------------------------------------------------------


def test_metal_is_exchanged_and_tables_are_checked(tmp_path: Path) -> None:
    file = tmp_path / "fraese.toml"
    file.write_text('[port]\nkind = "ppdev"\n[axes.x]\ntravel_mm = 120\n')
    with Mill(file) as mill:
        assert mill.config.port.kind == "simulation"
        mill.home("x")
        with pytest.raises(LimitError):
            mill.move(x=130)
    with pytest.raises(Exception, match=r"travel_mmm"):
        Mill({"axes": {"x": {"travel_mmm": 3}}})


def test_its_state_outlives_it(tmp_path: Path) -> None:
    with Mill(state=tmp_path) as mill:
        mill.home()
        mill.move(x=7)
    with Mill(state=tmp_path) as mill:
        assert mill.position_mm["x"] == 7
        assert mill.state.referenced == (True, True, True)


def test_who_does_not_use_it_does_not_pay_for_it() -> None:
    asked = (
        "import sys; import fraese.testing.plugin;"
        " print([name for name in sys.modules if name.startswith('fraese.')"
        " or name in ('numpy', 'pydantic', 'textual')])"
    )
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    # fraese itself settles in which form its modules are imported.
    expected = ["fraese.compiled", "fraese.testing", "fraese.testing.plugin"]
    assert done.stdout.strip() == str(expected)


@pytest.mark.parametrize("file", sorted(MACHINES.glob("*.toml")), ids=lambda file: file.stem)
def test_every_example_machine_can_be_tried(file: Path) -> None:
    with Mill(file) as mill:
        axis = mill.axes[0]
        assert mill.jog(axis, 1).lost_steps == dict.fromkeys(mill.axes, 0)
        assert mill.position_mm[axis] == pytest.approx(1, abs=0.01)
