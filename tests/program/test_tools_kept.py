"""What a program does to the tool table outlives it, until the configuration says otherwise."""

from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.control.savedstate import SavedState
from fraese.control.state import Status
from fraese.errors import ProgramError
from fraese.tooldata import ToolData, as_parameters, changed_tools
from tests.helpers import homed, program, run_program

TOOLS = {"tools": {"1": {"length_mm": 20.0}, "2": {"length_mm": 25.0}}}


def _length(made: Plant, folder: Path, words: str) -> float:
    part = program(folder, f"G21 G90\n{words}\nM2\n", "use.ngc")
    assert run_program(made, part) is Status.OK, made.controller.state().message
    made.controller.acknowledge()
    return made.controller.state().work.tool_length_mm


def _set(made: Plant, folder: Path, words: str) -> None:
    made.controller.set_break_key(made.controller.answer)
    assert run_program(made, program(folder, f"G21 G90\n{words}\nM2\n", "set.ngc")) is Status.OK


@pytest.mark.parametrize("sections", [{}, TOOLS])
def test_what_g10_l1_sets_is_there_for_the_next_program(
    tmp_path: Path, sections: dict[str, object]
) -> None:
    made = homed(**sections)
    _set(made, tmp_path, "G10 L1 P1 Z12.5 R3")
    assert _length(made, tmp_path, "T1 M6 G43 H1") == 12.5
    again = homed(**sections)
    kept = SavedState.model_validate_json(made.controller.keep().model_dump_json())
    again.controller.take_up(kept)
    again.controller.set_break_key(again.controller.answer)
    assert again.controller.state().work.tool == 1
    assert _length(again, tmp_path, "G49\nG43") == 12.5


def test_a_length_of_nothing_can_be_set_too(tmp_path: Path) -> None:
    made = homed(**TOOLS)
    _set(made, tmp_path, "G10 L1 P1 Z12.5")
    _set(made, tmp_path, "G10 L1 P1 Z0")
    assert _length(made, tmp_path, "G43 H1") == 0


def test_the_configuration_counts_again_once_it_says_something_else(tmp_path: Path) -> None:
    made = homed(**TOOLS)
    _set(made, tmp_path, "G10 L1 P1 Z12.5")
    changed = homed(tools={"1": {"length_mm": 21.0}})
    changed.controller.take_up(made.controller.keep())
    assert _length(changed, tmp_path, "G43 H1") == 21


def test_a_program_that_is_cut_short_before_its_g10_changes_nothing(tmp_path: Path) -> None:
    made = homed(**TOOLS)

    def cancel() -> None:
        if made.controller.question:
            made.controller.cancel()

    made.controller.set_break_key(cancel)
    part = program(tmp_path, "G21 G90\nG1 X5 F900\nM0\nG10 L1 P1 Z12.5\nM2\n")
    assert run_program(made, part) is Status.CANCEL
    made.controller.acknowledge()
    assert _length(made, tmp_path, "G43 H1") == 20


def test_a_tool_as_it_is_kept() -> None:
    tool = ToolData(1.5, 6.0, {"x": 2.0, "w": -1.0})
    was = ToolData(20.0, 3.0)
    kept = as_parameters(7, tool, was)
    (found,) = changed_tools(kept, {7: was}).items()
    assert found[0] == 7
    assert found[1].offset("xyzabcuvw") == tool.offset("xyzabcuvw")
    assert found[1].diameter_mm == 6
    assert changed_tools(kept, {}) == {}


def test_a_program_cannot_fill_the_record_of_the_machine(tmp_path: Path) -> None:
    made = homed()
    many = "\n".join(f"G10 L1 P{n} X1 Y1 Z12.5 R3" for n in range(1, 41))
    _set(made, tmp_path, many)
    assert len(made.controller.keep().model_dump_json()) < 20_000
    with pytest.raises(ProgramError, match="put them into the configuration"):
        program(tmp_path, f"{many}\nG10 L1 P41 Z1\nM2\n").check(made.controller)
