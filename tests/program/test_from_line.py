"""Begun in the middle: one replay that knows calls, files and repeats, and what it cannot know."""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.state import Status
from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.program.context import ProgramContext
from fraese.program.numbers import Numbers
from fraese.program.program import open_program
from fraese.program.runfromline import Beginning, Place
from fraese.program.source import ProgramSource
from tests.helpers import homed, program, run_program
from tests.program.test_probing import standing_at, touching

SUBS_AT_TOP = """o100 sub
g0 x#1 y#2
g1 z-1 f100
g1 x[#1+5]
g0 z5
o100 endsub
g21 g90
g0 z5
o100 call [10] [10]
o100 call [20] [10]
o100 call [30] [10]
o100 call [40] [10]
g0 x0 y0
m2
"""
M98 = """%
O0001
G21 G90 G94
G0 Z5
G0 X10 Y10
M98 P100
G0 X20 Y10
M98 P100 L2
G0 X30 Y10
M98 P100
G0 X0 Y0
M30
O100
G91 G1 Z-6 F100
X5
G0 Z6
X-5
G90
M99
%
"""
POCKET = (
    "(in a file of its own)\n"
    + ";\n" * 8
    + """o<pocket> sub
g0 z5
g0 x#1 y#2
g1 z-1 f100
g1 x[#1+5]
g0 z5
o<pocket> endsub
"""
)
FILE = """g21 g90
o<pocket> call [10] [10]
o<pocket> call [30] [10]
o<pocket> call [50] [10]
g0 z5
g0 x0 y0
g1 x5 f300
g1 y5
m2
"""


@pytest.fixture
def made() -> Plant:
    made = homed()
    standing_at(made, 20, 20, -20)
    made.controller.set_zero("xyz")
    return made


def _cut(made: Plant, folder: Path, text: str, from_line: int) -> list[tuple[float, float]]:
    """Where the tool went in below the work, work coordinates."""
    holes: list[tuple[float, float]] = []

    def look() -> None:
        x, y, z = made.controller.state().work_mm
        if z < -0.9:
            holes.append((round(x / 5) * 5, round(y)))

    made.controller.set_show_pos(look)
    made.controller.set_break_key(made.controller.answer)
    status = run_program(made, program(folder, text), from_line=from_line)
    assert status is Status.OK, made.controller.state().message
    return list(dict.fromkeys(holes))


def test_calls_of_subs_at_the_top_belong_to_the_lines_that_call(
    made: Plant, tmp_path: Path
) -> None:
    assert _cut(made, tmp_path, SUBS_AT_TOP, 11) == [(30, 10), (35, 10), (40, 10), (45, 10)]


def test_a_line_within_a_sub_is_come_to_when_the_sub_runs(made: Plant, tmp_path: Path) -> None:
    whole = _cut(made, tmp_path, SUBS_AT_TOP, 7)
    assert _cut(made, tmp_path, SUBS_AT_TOP, 4) == whole
    way = program(tmp_path, SUBS_AT_TOP).way_from(made.controller, 4)
    assert "from line 4, called in line 9:" in way[0]
    assert any("X 10.000 Y 10.000 Z -1.000" in line for line in way)


def test_subprograms_behind_the_end_are_not_later_lines(made: Plant, tmp_path: Path) -> None:
    assert _cut(made, tmp_path, M98, 11) == []
    assert made.controller.state().work_mm[:2] == (0, 0)
    assert {x for x, _ in _cut(made, tmp_path, M98, 9)} == {30, 35}
    assert {x for x, _ in _cut(made, tmp_path, M98, 7)} == {20, 25, 30, 35}


def test_lines_of_other_files_are_not_lines_of_this_one(made: Plant, tmp_path: Path) -> None:
    (tmp_path / "pocket.ngc").write_text(POCKET)
    assert _cut(made, tmp_path, FILE, 7) == []
    assert made.controller.state().work_mm[:2] == (5, 5)
    assert {x for x, _ in _cut(made, tmp_path, FILE, 4)} == {50, 55}


def test_m49_is_in_force_behind_the_place(made: Plant, tmp_path: Path) -> None:
    text = "G21 G90 F120\nM49\nG1 X5\nG1 X10\nG1 X30\nM2\n"
    made.controller.handling.feed = 0.5
    began_s = made.clock.now_ns() / 1e9
    _cut(made, tmp_path, text, 5)
    # Down with half of F120 takes 20 s, then 20 mm with all of it 10 s.
    assert made.clock.now_ns() / 1e9 - began_s < 35


@pytest.mark.parametrize(
    ("line", "told"),
    [(4, "arc, feed 120 mm/min to X"), (5, "wait 2 s"), (6, "a stop"), (7, "probe, feed 120")],
)
def test_what_comes_first_is_told_in_words(tmp_path: Path, line: int, told: str) -> None:
    text = "G21 G90 F120\nM49\nG1 X5\nG2 X15 I5 J0\nG4 P2\nM0\nG38.3 X16\nM2\n"
    # Nothing lifts its tool, so nothing goes down either: the program's own move is next.
    flat = assemble(Config.model_validate({"axes": {"names": ["x", "y"]}})).controller
    _, *legs, _ = program(tmp_path, text).way_from(flat, line)
    assert legs[-2] == "  overrides off"
    assert legs[-1].startswith("  " + told)


def test_a_way_that_goes_nowhere_is_not_told(made: Plant, tmp_path: Path) -> None:
    text = "G21 G90 F120 G53 G0 Z0\nG0 X5\nG1 X9\nG1 X12\nM2\n"
    made.controller.move_to({"z": 20})
    made.controller.run()
    _, *legs, _ = program(tmp_path, text).way_from(made.controller, 4)
    assert len(legs) == 1
    assert legs[0].startswith("  rapid to X ")
    rapids = program(tmp_path, "G21 G90\nG0 X5\nG0 X9\nM2\n").way_from(made.controller, 3)
    assert "with feed none yet, tool 0" in rapids[-1]


def test_a_tool_that_is_in_is_not_asked_for_again(made: Plant, tmp_path: Path) -> None:
    text = "G21 G90 F900\nT3 M6\nG1 X5\nG1 X10\nM2\n"
    part = program(tmp_path, text)
    assert "  tool 3" in part.way_from(made.controller, 4)
    _cut(made, tmp_path, text, 1)
    assert "  tool 3" not in part.way_from(made.controller, 4)


PROBE = """G21 G90 G94
G0 X10 Y10
G38.2 Z-30 F60
G10 L20 P1 Z1.5
G0 Z5
G0 X0 Y0
G1 Z-1 F100
G1 X20
G1 Y20
G0 Z5
M2
"""


@pytest.mark.parametrize(
    ("text", "from_line", "said"),
    [
        (PROBE, 8, "line 3: what the probe found is not known"),
        (PROBE.replace("G38.2 Z-30 F60", "G0 Z-5"), 8, "line 4: G10 L20 depends on where"),
        ("G21 G90\nG0 X5\nG92 X0\nG0 X3\nG1 X9 F300\nM2\n", 5, "line 3: G92 depends"),
        ("G21 G90\nG0 X5\nG28.1\nG0 X3\nG1 X9 F300\nM2\n", 5, "line 3: G28.1 depends"),
        ("G21 G90\nG0 X5\nG10 L10 P1 Z0\nG0 X3\nG1 X9 F300\nM2\n", 5, "line 3: G10 L10 depends"),
        ("G21 G91\nG0 X5\nG0 X3\nG1 X9 F300\nM2\n", 4, "line 2: X goes by G91"),
        ("G21 G91\nG81 X5 Z-1 R-1 F90\nG80\nG0 X3\nG1 X9 F300\nM2\n", 5, "line 2: X goes by G91"),
    ],
)
def test_what_depends_on_another_place_is_refused(
    made: Plant, tmp_path: Path, text: str, from_line: int, said: str
) -> None:
    part = program(tmp_path, text)
    with pytest.raises(ProgramError, match=said):
        part.way_from(made.controller, from_line)
    made.controller.set_break_key(made.controller.answer)
    before = made.controller.position.position_steps, made.controller.position.frame
    assert run_program(made, part, from_line=from_line) is Status.ERROR
    assert said.split(":")[1] in made.controller.state().message
    assert before == (
        made.controller.position.position_steps,
        made.controller.position.frame,
    )


def test_an_absolute_word_says_where_an_axis_is(made: Plant, tmp_path: Path) -> None:
    text = "G21 G91\nG0 X5\nG90 X2 Y3\nG91 G1 X9 F300\nG1 X1\nM2\n"
    _cut(made, tmp_path, text, 5)
    assert made.controller.state().work_mm[:2] == (12, 3)


def test_what_a_line_does_that_is_carried_out_is_not_refused(made: Plant, tmp_path: Path) -> None:
    _cut(made, tmp_path, "G21 G90\nG0 X5 Y5\nG92 X0\nG1 X9 F300\nM2\n", 3)
    assert made.controller.state().work_mm[0] == 9
    assert made.controller.state().position_mm[0] == 34


def test_what_the_run_that_was_cut_short_had_found_counts(made: Plant, tmp_path: Path) -> None:
    touching(made, lambda x, y, z: z <= -28 and 29 < x < 31 and 29 < y < 31)
    part = program(tmp_path, PROBE)
    made.controller.set_break_key(lambda: made.controller.cancel() if _line(made) == 9 else None)
    assert run_program(made, part) is Status.CANCEL
    offset_mm = made.controller.state().offset_mm
    made.controller.set_break_key(lambda: None)
    again = open_program(part.path)
    assert any("Z -1.000" in line for line in again.way_from(made.controller, 8))
    again.start(made.controller, from_line=8)
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert made.controller.state().offset_mm == offset_mm
    assert made.controller.state().work_mm == pytest.approx((20, 20, 5), abs=0.01)


def _line(made: Plant) -> int:
    job = made.controller.state().job
    return job.line if job else 0


#: A line of a program, and how many moves it makes.
LINES = st.sampled_from(
    [("G1 X{n} Y2", 1), ("G0 X{n}", 1), ("o100 call [{n}] [3]", 4), ("M98 P7", 2), ("M98 P7 L2", 4)]
)
SUBS = "o100 sub\ng0 x#1 y#2\ng1 z-1\ng1 x[#1+5]\ng0 z5\no100 endsub\n"


@given(lines=st.lists(LINES, min_size=2, max_size=9), data=st.data())
def test_what_is_made_is_the_end_of_the_whole(
    lines: list[tuple[str, int]], data: st.DataObject
) -> None:
    begins = 6 + 1
    text = "".join(f"{line.format(n=n + 1)}\n" for n, (line, _) in enumerate(lines))
    text = f"{SUBS}G21 G90 F600\n{text}M30\nO7\nG1 Z-2\nG1 Z5\nM99\n"
    first = data.draw(st.integers(0, len(lines) - 1))
    controller = homed().controller
    context = ProgramContext.of(controller)
    with TemporaryDirectory() as folder:
        taken = program(Path(folder), text).taken
        whole = list(ProgramSource(taken, context).moves())
        place = Place(begins + 1 + first)
        begun = Beginning(ProgramSource(taken, context), context, context, place)
        made = list(begun.moves(Numbers()))
    expected = [move for move in whole if isinstance(move, canon.Rapid | canon.Feed)]
    expected = expected[sum(count for _, count in lines[:first]) :]
    moved = [move for move in made if isinstance(move, canon.Rapid | canon.Feed)]
    assert moved[len(moved) - len(expected) :] == expected
    # Up, over and down.
    assert len(moved) - len(expected) == (3 if first else 0)
