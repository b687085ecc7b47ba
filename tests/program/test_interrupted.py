"""Programs that were interrupted and gone on with: the same moves from the same place."""

import json
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.control.jobs import move_of
from fraese.control.state import Status
from fraese.errors import ProgramError, StateError
from fraese.gcode import canon
from fraese.journal.pages import MOST_BYTES
from fraese.program.context import ProgramContext
from fraese.program.interrupted import Interrupted, JobNote
from fraese.program.program import Program
from fraese.program.translate import Translation
from fraese.program.way import way_of
from fraese.workframe import FIRST_SYSTEM, PERSISTENT, ROTATION, SYSTEM_STRIDE, SYSTEMS
from tests.helpers import (
    STEPDIR,
    after_slices,
    carriages,
    configured,
    homed,
    program,
    run_program,
    touching_at,
)

ROTATIONS = {FIRST_SYSTEM + ROTATION + SYSTEM_STRIDE * n for n in range(len(SYSTEMS))}

LOOPS = """G21 G90 G64 F900
M3 S1000
G0 Z2
O100 SUB
  G91
  G1 X3
  G1 Y2
  G1 X-3
  G1 Y-2
  G90
O100 ENDSUB
G0 X10 Y10
G1 Z-1
O1 REPEAT [8]
  O100 CALL
O1 ENDREPEAT
G92 X0 Y0
G55
G10 L2 P2 X20 Y5
G1 X4 Y4
O2 REPEAT [6]
  O100 CALL
O2 ENDREPEAT
G92.1
G1 X1
M2
"""


def _machine(**keys: Any) -> Plant:
    made = homed(outputs={"spindle": {"pin": 14}}, run={"spin_up_s": 0}, **keys)
    # As left by homing the tool is at the top.
    made.controller.set_zero("z", 20)
    made.controller.set_zero("xy", -5)
    return made


def _left(made: Plant) -> Interrupted:
    """What was kept of the job, as it comes back from a file."""
    kept = made.controller.keep().job
    assert kept is not None
    made.controller.acknowledge()
    # What moves in between is another matter.
    made.controller.jog("z", -0.5)
    assert made.controller.run() is Status.OK
    assert made.controller.keep().job == kept
    return Interrupted.of(json.loads(json.dumps(kept)))


def _played(made: Plant) -> list[int]:
    """Numbers of the moves that are played from now on, each once in a row."""
    seen: list[int] = []

    def look() -> None:
        number = move_of(made.controller._queue.report.tag)
        if number and [number] != seen[-1:]:
            seen.append(number)

    made.controller.set_show_pos(look)
    return seen


def _go_on(made: Plant, part: Program, left: Interrupted, back: int = 0) -> Status:
    made.controller.acknowledge()
    part.start(made.controller, past=left, back=back)
    return made.controller.run()


@pytest.mark.parametrize("seed", range(12))
def test_a_program_ends_as_if_it_had_not_been_interrupted(tmp_path: Path, seed: int) -> None:
    part = program(tmp_path, LOOPS)
    whole = _machine()
    every = _played(whole)
    assert run_program(whole, part) is Status.OK
    assert whole.controller.keep().job is None

    made, chosen = _machine(), random.Random(seed)
    status, tries, left = Status.RUN, 0, None
    while status is not Status.OK:
        slices = chosen.randrange(100, 330) if left else chosen.randrange(2, 200)
        after_slices(made.controller, slices, made.controller.cancel)
        if left is None:
            status = run_program(made, part)
        else:
            seen = _played(made)
            status = _go_on(made, part, left)
            # Nothing before the place is made again, nothing behind it is left out.
            assert left.move <= seen[0]
            assert seen == sorted(set(seen))
            assert seen[-1] <= every[-1]
        if status is Status.CANCEL:
            left = _left(made)
        tries += 1
        assert tries < 60
    assert tries > 1
    assert carriages(made) == carriages(whole)
    assert made.controller.state().work_mm == whole.controller.state().work_mm
    assert made.controller.keep().parameters == whole.controller.keep().parameters


def _interrupted(made: Plant, part: Program, move: int) -> Interrupted:
    """Cancelled while this move is played."""
    controller = made.controller

    def look() -> None:
        if move_of(controller._queue.report.tag) >= move and not controller.cancelling:
            controller.cancel()

    controller.set_break_key(look)
    assert run_program(made, part) is Status.CANCEL
    controller.set_break_key(lambda: None)
    return _left(made)


def test_steps_that_go_on_from_each_other_are_not_made_from_another_place(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G91 F300\nG1 X5\nG1 Y5\nG1 X5\nG1 Y5\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 3)
    assert left.move > 1
    made.controller.acknowledge()
    made.controller.move_to({"x": 100, "y": 100}, machine_coordinates=True)
    made.controller.run()
    assert _go_on(made, part, left) is Status.OK
    assert made.controller.state().position_mm == (10, 10, 0)


def test_a_new_tool_that_was_touched_off_counts(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G90 F300\nG1 Z-1\nG1 X20\nG1 X0\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 2)
    made.controller.acknowledge()
    made.controller.set_zero("z", made.controller.state().work_mm[2] + 2)
    assert _go_on(made, part, left) is Status.OK
    assert made.controller.state().work_mm[2] == pytest.approx(-1)
    assert made.controller.state().position_mm[2] == pytest.approx(-23)


def test_an_offset_that_the_program_sets_is_as_it_says(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G90 F300\nG10 L2 P1 X30 Y0 Z-30\nG1 X20\nG1 X0\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 3)
    context = ProgramContext.of(made.controller)
    assert left.news(context) == []
    made.controller.acknowledge()
    made.controller.set_zero("x", 7)
    (said,) = left.news(ProgramContext.of(made.controller))
    assert "as it says" in said
    assert _go_on(made, part, left) is Status.OK
    assert made.controller.state().position_mm[0] == 30


def test_some_moves_back(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G90 F600\nG1 X5\nG1 X10\nG1 X15\nG1 X20\nG1 X25\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 4)
    assert left.move > 2
    context = ProgramContext.of(made.controller)
    way = way_of(part.begun(context, past=left, back=2))
    assert way.lines("part.ngc")[0] == f"part.ngc from line {left.line - 2}:"
    assert way.text == f"G1 X{5 * (left.line - 3)}"
    # Where the work zero lies elsewhere, the way is told in its numbers too.
    last = way.lines("part.ngc")[-2]
    assert last.endswith("Z 0.000 mm (machine), X 5.000 Y -5.000 Z 20.000 mm (work)")
    seen = _played(made)
    assert _go_on(made, part, left, back=2) is Status.OK
    assert seen[0] == left.move - 2


def test_back_beyond_the_start_begins_where_it_began(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G91 F300\nG1 X5\nG1 X5\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 2)
    assert _go_on(made, part, left, back=99) is Status.OK
    assert made.controller.state().position_mm[0] == 10


def test_without_the_reference_nobody_knows_the_place(tmp_path: Path) -> None:
    part = program(tmp_path, "G21 G90 F600\nG1 X20\nM2\n")
    made = _machine()
    left = _interrupted(made, part, 1)
    made.controller.acknowledge()
    made.controller.position.lose_reference([1])
    stood = carriages(made)
    with pytest.raises(StateError, match="run with axis Y referenced, and now nobody"):
        part.start(made.controller, past=left)
    assert carriages(made) == stood


def test_a_reference_since_has_given_the_place_other_numbers(tmp_path: Path) -> None:
    """Run on a machine without reference, its zero was wherever it stood."""
    part = program(tmp_path, "G21 G90 F600\nG1 X20\nM2\n")
    made = assemble(configured())
    left = _interrupted(made, part, 1)
    made.controller.home()
    assert made.controller.run() is Status.OK
    stood = carriages(made)
    with pytest.raises(StateError, match="axes X Y Z not referenced, and the reference since"):
        part.start(made.controller, past=left)
    assert carriages(made) == stood


@pytest.mark.parametrize(
    "change",
    [{"move": "x"}, {"parameters": {"a": 1}}, {"more": 1}, {"start_steps": [float("nan")]}],
)
def test_what_is_damaged_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    part = program(tmp_path, "G21 G90 F600\nG1 X20\nM2\n")
    left = _interrupted(_machine(), part, 1)
    with pytest.raises(ProgramError, match="is damaged"):
        Interrupted.of({**left.model_dump(), **change})


def test_what_a_probe_found_is_not_asked_again(tmp_path: Path) -> None:
    text = "G21 G90\nG38.2 Z-30 F100\nG92 Z0\nG1 Z5 F600\nG1 X10\nG1 X0\nG1 Z1\nM2\n"
    made = homed()
    touches = touching_at(made, 11_600 - 2000)
    part = program(tmp_path, text)
    left = _interrupted(made, part, 4)
    assert [answer.touched for answer in left.facts().values()] == [True]
    # The plate was taken away; a probe would go to its target and find nothing.
    touches.clear()
    assert _go_on(made, part, left) is Status.OK
    assert made.controller.state().work_mm == pytest.approx((0, 0, 1))
    assert made.controller.state().position_mm[2] == pytest.approx(-9, abs=0.01)


def test_of_many_probes_the_job_is_kept_but_not_gone_on_with(tmp_path: Path) -> None:
    """A record of the state has an end; a program that probes on and on runs all the same."""
    made = assemble(configured(), state=tmp_path / "state")
    probes = "".join(f"G38.3 X{n % 2} F3000\n" for n in range(600))
    part = program(tmp_path, f"G21 G90\n{probes}G1 X5 F60\nM2\n")
    left = _interrupted(made, part, 601)
    made.close()
    assert left.answers is None
    with pytest.raises(StateError, match="probed more than 64 times"):
        left.require_same_machine(ProgramContext.of(made.controller))


def test_the_largest_job_fits_a_record() -> None:
    """Four axes, every parameter that belongs to one, and numbers of all their digits."""
    long = 0.1234567890123456 * 1e3
    axes = configured(**STEPDIR, axes={"names": list("xyza")})
    start = replace(
        ProgramContext.of(assemble(axes).controller),
        parameters={n: long for n in PERSISTENT if (n - 5161) % 20 < 4 or n in ROTATIONS},
    )
    facts = canon.Facts((long,) * 4, touched=True, contact_mm=(long,) * 4, parameters={5223: long})
    heard = Translation(start, None)
    heard.answers = dict.fromkeys(range(1, 65), facts)
    note = JobNote("n" * 255, "f" * 64, start, heard)
    now = {number: -value for number, value in start.parameters.items()}
    state = assemble(axes).controller.keep().model_copy(update={"job": note.at(99 << 32, now)})
    state = state.model_copy(update={"parameters": now, "simulation": ((long,) * 4,) * 4})
    assert len(note.at(99 << 32, now)["answers"]) == 64
    assert len(state.model_dump_json()) < 0.9 * MOST_BYTES
