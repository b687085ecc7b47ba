"""What a look-through tells besides yes and no: outline, timetable, wants, all errors."""

from pathlib import Path

import numpy as np
import pytest

from fraese.errors import LimitError, ProgramError
from fraese.gcode import canon
from fraese.program.check import Facts, check_program
from fraese.program.context import ProgramContext
from fraese.program.outline import OutlineMaker
from fraese.program.telling import Stage
from fraese.program.timetablemaker import TimetableMaker
from fraese.program.wants import Wants
from tests.helpers import homed, program


def looked(folder: Path, text: str) -> Facts:
    part = program(folder, text)
    return check_program(part.taken, ProgramContext.of(homed().controller))


def test_the_outline_is_the_way_of_the_tool(tmp_path: Path) -> None:
    facts = looked(tmp_path, "G21 G90\nG0 X10\nG1 Y5 F300\n(nothing)\nG2 X20 Y5 I5 J0\nM2\n")
    outline = facts.outline
    assert outline is not None
    assert outline.points[:3].tolist() == [[0, 0, 0], [10, 0, 0], [10, 5, 0]]
    assert outline.points[-1].tolist() == [20, 5, 0]
    # Half a circle upwards, on the circle.
    arc = outline.points[3:]
    assert np.hypot(arc[:, 0] - 15, arc[:, 1] - 5) == pytest.approx(5, abs=1e-4)
    assert arc[:, 1].max() == pytest.approx(10, abs=0.05)
    assert outline.rapid[1:4].tolist() == [True, False, False]
    assert sorted(set(outline.lines.tolist())) == [0, 2, 3, 5]
    assert (np.diff(outline.moves) >= 0).all()


def test_an_outline_is_thinned_and_keeps_its_shape() -> None:
    maker = OutlineMaker("xyz", (0.0, 0.0, 0.0), most=2000)
    for number in range(1, 200_001):
        angle = number / 1000
        maker.take(canon.Feed(number, (50 * np.cos(angle), 50 * np.sin(angle), 0.0), 300), number)
    outline = maker.outline()
    assert 500 < len(outline) <= 2000
    radii = np.hypot(outline.points[1:, 0], outline.points[1:, 1])
    assert radii == pytest.approx(50, abs=1e-3)
    assert outline.moves[-1] == 200_000


def test_a_machine_without_z_has_an_outline_too() -> None:
    maker = OutlineMaker("ax", (0.0, 1.0))
    maker.take(canon.Rapid(1, (90.0, 5.0)), 1)
    assert maker.outline().points.tolist() == [[1, 0, 0], [5, 0, 0]]


def test_the_timetable_knows_feeds_from_rapids(tmp_path: Path) -> None:
    facts = looked(tmp_path, "G1 X20 F600\nG0 X0\nG4 P3\nM2\n")
    table = facts.timetable
    assert table is not None
    assert table.total_s == pytest.approx(facts.duration_s)
    share, left_s = table.progress(0, 0.0, feed=1.0, rapid=1.0)
    assert share == 0
    assert left_s == pytest.approx(facts.duration_s)
    fast = table.progress(0, 0.0, feed=2.0, rapid=1.0)[1]
    assert left_s - fast == pytest.approx(1.0, abs=0.1)
    slow = table.progress(0, 0.0, feed=1.0, rapid=0.5)[1]
    assert slow - left_s == pytest.approx(1.2, abs=0.1)
    assert table.progress(2, 0.0, feed=1.0, rapid=1.0)[1] == pytest.approx(4.2, abs=0.1)
    assert table.progress(10**9, 0.0, feed=1.0, rapid=1.0) == (1, 0)


def test_nothing_at_all_has_a_timetable() -> None:
    assert TimetableMaker().timetable().progress(0, 1.0, feed=1.0, rapid=1.0) == (0, 0)


def test_what_a_program_wants_is_told(tmp_path: Path) -> None:
    text = "T2 M6\nS8000 M3\nG1 X5 F300\nM1\nM0\nT1 M6\nS12000 M3\nG38.2 X6\nT2 M6\nM2\n"
    assert looked(tmp_path, text).wants == Wants((2, 1), (8000, 12000), 4, 1, 1)


def test_every_line_that_is_wrong_is_told(tmp_path: Path) -> None:
    text = "G21 F300\nG1 X[1/0]\nG1 X5\nG17 G18\nQ\n(ok)\nG1 X999\nM2\n"
    facts = looked(tmp_path, text)
    assert [error.line for error in facts.errors] == [2, 4, 5]
    assert [outside.line for outside in facts.outside] == [7]
    assert facts.timetable is None
    assert facts.outline is not None
    assert len(facts.outline) == 3
    part = program(tmp_path, text)
    with pytest.raises(ProgramError, match="line 2"):
        part.check(homed().controller)
    assert part.facts is not None
    assert len(part.facts.errors) == 3


def test_behind_a_branch_that_is_wrong_nothing_is_read(tmp_path: Path) -> None:
    text = "Q\no1 if [1/0]\nQ\no1 endif\nM2\n"
    assert [error.line for error in looked(tmp_path, text).errors] == [1, 2]


def test_so_many_errors_are_enough(tmp_path: Path) -> None:
    assert len(looked(tmp_path, "Q\n" * 500).errors) == 50


def test_a_run_ends_at_the_first_line_that_is_wrong(tmp_path: Path) -> None:
    made = homed()
    part = program(tmp_path, "G1 X5 F300\nQ\nG1 X10\nM2\n")
    part.start(made.controller)
    made.controller.run()
    assert "line 2" in made.controller.state().message
    assert made.controller.state().work_mm[0] < 10


def test_it_tells_how_far_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fraese.program.telling._TELL_S", 0.0)
    part = program(tmp_path, "G1 X1 F300\n" + "X2\nX1\n" * 1000 + "M2\n")
    told: list[Stage] = []
    check_program(part.taken, ProgramContext.of(homed().controller), tell=told.append)
    lines = [stage.lines for stage in told]
    assert lines == sorted(lines)
    assert len(lines) == 10
    assert any(stage.outline is not None for stage in told)


def test_a_program_apart_tells_it_too(tmp_path: Path) -> None:
    from fraese.program.program import open_program

    path = tmp_path / "part.ngc"
    path.write_text("G1 X1 F300\nX400\nM2\n")
    part = open_program(path, apart=True)
    with pytest.raises(LimitError):
        part.check(homed().controller)
    assert part.facts is not None
    assert part.facts.outline is not None
    assert part.facts.outline.points.max() == 400
    assert part.stage is None
    part.close()
