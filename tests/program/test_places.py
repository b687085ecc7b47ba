"""Where something is wrong: file and line of the place, and of the call that led there."""

from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.errors import LimitError, ProgramError
from fraese.program.check import check_program
from fraese.program.context import ProgramContext
from fraese.program.program import open_program
from tests.helpers import homed

SLOT = "o<slot> sub\ng0 z#1\ng0 x1\ng1 x500\no<slot> endsub\n"
FAR = "o<far> sub\ng0 x5000\no<far> endsub\n"
MAIN = "g21 g90\ng0 z-5\no<{}> call [-7]\ng0 x5\nm2\n"


@pytest.fixture
def plant() -> Plant:
    return homed()


def checked(plant: Plant, folder: Path, **texts: str) -> tuple[list[tuple[int, str]], ...]:
    for name, text in texts.items():
        (folder / f"{name}.ngc").write_text(text, "utf-8")
    program = open_program(folder / "main.ngc")
    facts = check_program(program.taken, ProgramContext.of(plant.controller))
    return tuple(
        [(each.line, each.message) for each in found]
        for found in (facts.errors, facts.outside, facts.notes)
    )


def test_an_error_in_a_file_of_its_own(plant: Plant, tmp_path: Path) -> None:
    errors, _, _ = checked(plant, tmp_path, main=MAIN.format("slot"), slot=SLOT)
    ((line, said),) = errors
    assert line == 3
    assert said.startswith("slot.ngc, line 4: G1 needs a feed")
    program = open_program(tmp_path / "main.ngc")
    with pytest.raises(ProgramError, match=r"main\.ngc, line 3: slot\.ngc, line 4: G1 needs"):
        program.check(plant.controller)


def test_a_target_outside_in_a_file_of_its_own(plant: Plant, tmp_path: Path) -> None:
    _, outside, _ = checked(plant, tmp_path, main=MAIN.format("far"), far=FAR)
    ((line, said),) = outside
    assert line == 3
    assert said.startswith("far.ngc, line 2: X 5000")
    program = open_program(tmp_path / "main.ngc")
    with pytest.raises(LimitError, match=r"main\.ngc, line 3: far\.ngc, line 2: X 5000"):
        program.check(plant.controller)


def test_calls_within_calls(plant: Plant, tmp_path: Path) -> None:
    outer = "o<outer> sub\n\no<slot> call [-7]\no<outer> endsub\n"
    errors, _, _ = checked(plant, tmp_path, main=MAIN.format("outer"), outer=outer, slot=SLOT)
    ((line, said),) = errors
    assert line == 3
    assert said.startswith("slot.ngc, line 4 (called in outer.ngc, line 3): G1 needs a feed")


def test_in_the_same_file_the_line_is_that_of_the_place(plant: Plant, tmp_path: Path) -> None:
    errors, _, _ = checked(plant, tmp_path, main=SLOT + MAIN.format("slot"))
    ((line, said),) = errors
    assert line == 4
    assert said == "G1 needs a feed: give an F word above 0 first (called in line 8)"


def test_a_file_that_is_wrong_before_it_runs(plant: Plant, tmp_path: Path) -> None:
    errors, _, _ = checked(plant, tmp_path, main=MAIN.format("slot"), slot="o<slot> sub\ng0 x1\n")
    ((line, said),) = errors
    assert line == 3
    assert said.startswith("slot.ngc, line 1: o<slot> sub has no endsub")


@pytest.mark.parametrize(
    ("text", "loop"),
    [
        ("g21\no7 while [1]\n#1=1\no7 endwhile\n", "the loop o<7> that begins in line 2"),
        ("g0 x1\no1 do\no2 repeat [5]\n#1=2\no2 endrepeat\no1 while [1]\n", "o<1> .* in line 2"),
        ("o1 repeat [2]\no2 while [1]\no2 endwhile\no1 endrepeat\n", "o<2> that begins in line 2"),
        (
            "o9 sub\n#1=1\no9 endsub\no1 while [1]\no9 call\no1 endwhile\n",
            "the loop o<1> that begins in line 4",
        ),
    ],
)
def test_a_loop_without_end_is_named(plant: Plant, tmp_path: Path, text: str, loop: str) -> None:
    (tmp_path / "main.ngc").write_text(text, "utf-8")
    with pytest.raises(ProgramError, match=f"{loop} never ends"):
        open_program(tmp_path / "main.ngc").check(plant.controller)


def test_a_feed_below_the_slowest_step_is_said_once(plant: Plant, tmp_path: Path) -> None:
    _, _, notes = checked(plant, tmp_path, main="g1 x1 f9\nx2 f.2\nx3 f.1\nm2\n")
    ((line, said),) = notes
    assert line == 2
    assert (
        said == "F0.2 is slower than the slowest step, one in 1.05 s: it is driven at 0.286 mm/min"
    )


def test_what_is_passed_over_is_noted(plant: Plant, tmp_path: Path) -> None:
    _, _, notes = checked(plant, tmp_path, main="g0 x1 a0\nx2 a0\nm2\n")
    assert notes == [(1, "A0 is passed over: this machine has no axis A")]
