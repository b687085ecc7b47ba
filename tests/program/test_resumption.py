"""Going on with a program: what command line and app have in common."""

from pathlib import Path

import pytest

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.position import Doubt
from fraese.control.savedstate import IN_MOTION
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.program.kept import KeptPrograms
from fraese.program.program import open_program
from fraese.program.resumption import Resumption
from tests.helpers import after_slices

PART = "G21 G90 F600\nG1 X5\nG1 Y5\nG1 X0\nG1 Y0\nM2\n"


def cut_short(folder: Path) -> tuple[Plant, KeptPrograms]:
    """A machine whose program was stopped in the middle."""
    made, kept = assemble(Config(), state=folder / "state"), KeptPrograms(folder / "state")
    made.controller.home()
    assert made.controller.run() is Status.OK
    (folder / "part.ngc").write_text(PART)
    part = open_program(folder / "part.ngc", kept=kept)
    part.start(made.controller, part.check(made.controller))
    after_slices(made.controller, 6, made.controller.cancel)
    assert made.controller.run() is Status.CANCEL
    made.controller.set_break_key(lambda: None)
    return made, kept


def test_it_ends_where_it_would_have(tmp_path: Path) -> None:
    made, kept = cut_short(tmp_path)
    Resumption.of(made.controller, kept).start(made.controller)
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_mm == (0, 0, 0)


def test_nothing_starts_on_a_machine_that_stands_otherwise_by_now(tmp_path: Path) -> None:
    made, kept = cut_short(tmp_path)
    shown = Resumption.of(made.controller, kept)
    made.controller.jog("z", -1)
    assert made.controller.run() is Status.OK
    there = made.controller.state().position_mm
    with pytest.raises(StateError, match="changed since it was shown how to go on"):
        shown.start(made.controller)
    assert made.controller.status is not Status.RUN
    assert made.controller.state().position_mm == there


def test_nothing_goes_on_where_the_place_is_in_doubt(tmp_path: Path) -> None:
    """Also if all axes were referenced then, and a person has not said what it is worth."""
    made, kept = cut_short(tmp_path)
    made.controller.position.doubt = Doubt(IN_MOTION)
    with pytest.raises(StateError, match="nothing has moved"):
        Resumption.of(made.controller, kept)


def test_whoever_looks_at_a_machine_that_is_driven_is_told_of_no_program_to_go_on_with(
    tmp_path: Path,
) -> None:
    """It may run at this moment."""
    made, _ = cut_short(tmp_path)
    made.controller.idle(2.0)
    looked = assemble(Config(), state=tmp_path / "state", at_desk=True)
    assert "is driven by" in looked.notes[0]
    assert looked.controller.keep().job is None
    made.close()
    again = assemble(Config(), state=tmp_path / "state", at_desk=True)
    assert again.controller.keep().job is not None


def test_a_start_that_is_refused_leaves_what_can_be_gone_on_with(tmp_path: Path) -> None:
    made, kept = cut_short(tmp_path)
    before = made.controller.state().cut_short
    assert before is not None
    assert before.name == "part.ngc"
    (tmp_path / "other.ngc").write_text("G21 G90 F600\nG1 X1\nM2\n")
    for path in ("other.ngc", "part.ngc"):
        other = open_program(tmp_path / path, kept=kept)
        other.start(made.controller, from_line=1000)
        assert made.controller.run() is Status.ERROR
        assert "nothing to run from line 1000" in made.controller.state().message
        made.controller.acknowledge()
        assert made.controller.state().cut_short == before
    Resumption.of(made.controller, kept).start(made.controller)
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_mm == (0, 0, 0)
