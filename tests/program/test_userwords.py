"""M100 to M199 as somebody wants them: outputs that go off, programs that are carried out."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.config.file import from_table
from fraese.control.state import Status
from fraese.errors import ConfigError, FraeseError, ProgramError
from fraese.gcode.canon import Dwell, Feed, Output
from fraese.gcode.userwords import Call, Word
from fraese.motor.pins import CONTROL_PINS
from fraese.peers import WORDS, Seam
from tests.helpers import merged, mill, plant, program, run_program

AIR = {"outputs": {"own": {"air": {"pin": 16}}}}
BIT = CONTROL_PINS[16].bit


def pulse(call: Call) -> Any:
    yield Output(call.line, "air", True)
    yield Dwell(call.line, call.p or 1)
    yield Output(call.line, "air", False)


def stays_on(call: Call) -> Any:
    yield Output(call.line, "mist", True)


def strays(call: Call) -> Any:
    yield Feed(call.line, (0.0, 0.0, 0.0), 100.0)


def fails(call: Call) -> Any:
    raise ZeroDivisionError("no such luck")


@pytest.fixture(autouse=True)
def rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows of the house, as somebody would add them."""
    found = {"M110": Word(pulse), "M111": Word(strays), "M112": Word(fails), "M113": Word(stays_on)}
    before = type(WORDS).record

    def record(seam: Seam, name: str) -> Any:
        return found[name] if seam is WORDS else before(seam, name)

    monkeypatch.setattr(Seam, "has", lambda seam, name: name in found)
    monkeypatch.setattr(Seam, "record", record)


def is_open(made: Plant) -> bool:
    return bool(mill(made).electronics.pins[1] & BIT)


def when(made: Plant, it_is_so: Callable[[], bool]) -> None:
    """Cancel then."""

    def look() -> None:
        if it_is_so():
            made.controller.cancel()

    made.controller.set_break_key(look)


def seen(made: Plant) -> list[tuple[bool, float]]:
    """Whether the valve is open, and when that changes, s."""
    found: list[tuple[bool, float]] = []

    def look() -> None:
        if not found or found[-1][0] is not is_open(made):
            found.append((is_open(made), made.clock.now_ns() / 1e9))

    made.controller.set_show_pos(look)
    return found


def test_an_output_is_pulsed(tmp_path: Path) -> None:
    made = plant(**AIR)
    changes = seen(made)
    assert run_program(made, program(tmp_path, "G1 X1 F600\nM110 P1.5\nX2\nM2\n")) is Status.OK
    assert [on for on, _ in changes] == [False, True, False]
    # As often as the run loop looks.
    assert changes[2][1] - changes[1][1] == pytest.approx(1.5, abs=0.25)


@pytest.mark.parametrize(("stays", "open_then"), [(False, False), (True, True)])
def test_an_output_that_was_pulsed_goes_off_with_the_job(
    tmp_path: Path, stays: bool, open_then: bool
) -> None:
    own = {"off_when_cancelled": not stays}
    made = plant(**merged(AIR, {"outputs": {"own": {"air": own}}}))
    when(made, lambda: is_open(made))
    status = run_program(made, program(tmp_path, "M110 P30\nM2\n"))
    assert status is Status.CANCEL
    assert is_open(made) is open_then
    made.close()
    assert not is_open(made)


def test_an_output_that_is_off_at_rest_waits_for_motion(tmp_path: Path) -> None:
    made = plant(**merged(AIR, {"outputs": {"own": {"air": {"off_at_rest": True}}}}))
    assert made.config.outputs.off_at_rest == made.config.outputs.mask("air") != 0
    run_program(made, program(tmp_path, "M110 P0.5\nM2\n"))
    assert not is_open(made)


def test_rows_say_what_names_said_before() -> None:
    outputs = from_table(
        {"outputs": {"spindle": {"pin": 14}, "laser": {"pin": 16}, "own": {"air": {"pin": 17}}}},
        "test",
    ).outputs
    assert outputs.off_after(done=True) == outputs.mask("laser")
    assert outputs.off_after(done=False) == outputs.mask("laser", "spindle", "air")
    assert outputs.off_at_rest == outputs.mask("laser")
    assert [name for name, _ in outputs.configured()] == ["spindle", "laser", "air"]


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"Air": {"pin": 16}}, "outputs are named in small letters"),
        ({"spindle": {"pin": 16}}, "outputs are named in small letters"),
        ({"air": {"pin": 1}}, r"outputs.air.pin 1 is taken already"),
    ],
)
def test_an_output_that_cannot_be_is_a_sentence(table: Any, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        from_table({"outputs": {"own": table}}, "test")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("M110\n", "the output air is to be switched, and there is none"),
        ("M111\n", "M111 may switch outputs, wait and speak; it has made a Feed"),
        ("M112\n", "M112 has failed: ZeroDivisionError: no such luck"),
        ("M101\n", "M101 is a user's own code and has no meaning here"),
    ],
)
def test_what_cannot_be_carried_out_is_found_before_anything_moves(
    tmp_path: Path, text: str, said: str
) -> None:
    made = plant()
    with pytest.raises(ProgramError, match=said):
        run_program(made, program(tmp_path, "G1 X1 F600\n" + text))
    assert made.controller.state().position_steps == (0, 0, 0)


# --- programs ------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Where programs lie; a name that a shell would take apart."""
    found = tmp_path / "m codes; touch oops $(touch oops)"
    found.mkdir()
    return found


def put(folder: Path, name: str, text: str, mode: int = 0o755) -> Path:
    path = folder / name
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(mode)
    return path


def with_programs(folder: Path) -> Plant:
    return plant(run={"m_code_folder": str(folder)})


def test_a_program_is_carried_out_where_the_motors_stand(tmp_path: Path, folder: Path) -> None:
    put(folder, "M101", 'sleep 0.1; echo "$# $1 $2" >> said\n')
    made = with_programs(folder)
    there: set[tuple[int, ...]] = set()

    def look() -> None:
        job = made.controller.state().job
        if job is not None and job.doing == "M101":
            there.add(made.controller.state().position_steps)

    made.controller.set_show_pos(look)
    text = "G1 X1 F600\nM101 P2 Q-0.5\nX2\nM101\nM2\n"
    checked = program(tmp_path, text)
    checked.check(made.controller)
    assert not (folder / "said").exists()
    assert run_program(made, checked) is Status.OK
    assert (folder / "said").read_text() == "2 2.000000 -0.500000\n2 -1.000000 -1.000000\n"
    assert there == {(200, 0, 0), (400, 0, 0)}
    assert made.controller.state().position_steps == (400, 0, 0)
    assert list(tmp_path.rglob("oops")) == []


def test_what_a_start_in_the_middle_leaves_out_is_told(tmp_path: Path, folder: Path) -> None:
    put(folder, "M101", "echo ran >> ran\n")
    outputs = {"own": {"air": {"pin": 16}, "mist": {"pin": 17}}}
    made = plant(outputs=outputs, run={"m_code_folder": str(folder)})
    text = "G21 G90 F600\nM101\nM113\nM110\nG1 X1\nG1 X2\nM2\n"
    part = program(tmp_path, text)
    way = part.way_from(made.controller, 6)
    assert way[1:3] == [
        "  line 2: M101 is not carried out again",
        "  line 3: the output mist is not switched on again",
    ]
    assert not any("air" in line for line in way)
    assert run_program(made, part, from_line=6) is Status.OK
    assert made.controller.state().position_mm[0] == 2
    assert not (folder / "ran").exists()


def test_without_a_folder_nothing_is_carried_out(tmp_path: Path, folder: Path) -> None:
    put(folder, "M101", "touch said\n")
    made = plant()
    with pytest.raises(ProgramError, match="M101 is a user's own code"):
        run_program(made, program(tmp_path, "M101\n"))
    assert not (folder / "said").exists()


def test_one_that_fails_fails_the_job_with_its_last_line(tmp_path: Path, folder: Path) -> None:
    put(folder, "M101", 'echo busy; printf "no air \\033[31m\\n\\n"; exit 3\n')
    made = with_programs(folder)
    assert run_program(made, program(tmp_path, "G1 X1 F600\nM101\nX2\n")) is Status.ERROR
    assert made.controller.state().message.endswith(r"M101 has ended with 3: no air \x1b[31m")
    assert made.controller.state().position_steps == (200, 0, 0)


def test_one_that_cannot_be_started_is_a_sentence(tmp_path: Path, folder: Path) -> None:
    path = folder / "M101"
    path.write_text("#!/no/such/interpreter\n")
    path.chmod(0o755)
    put(folder, "M102", "exit 0\n", mode=0o644)
    made = with_programs(folder)
    assert run_program(made, program(tmp_path, "M101\n")) is Status.ERROR
    assert "M101 cannot be started: No such file" in made.controller.state().message
    made.controller.acknowledge()
    with pytest.raises(FraeseError, match="M102 may not be executed: chmod"):
        run_program(made, program(tmp_path, "M102\n"))


def test_a_cancel_ends_it_and_what_it_has_started(tmp_path: Path, folder: Path) -> None:
    put(folder, "M101", "sleep 60 & echo $! > child; echo $$ > own; wait\n")
    made = with_programs(folder)
    when(made, lambda: (folder / "own").exists())
    since_s = time.monotonic()
    assert run_program(made, program(tmp_path, "M101\nM2\n")) is Status.CANCEL
    assert time.monotonic() - since_s < 30
    for name in ("own", "child"):
        number = int((folder / name).read_text())
        # It was killed; the system buries it when it has time.
        while _runs(number):
            assert time.monotonic() - since_s < 30, name
            time.sleep(0.01)


def _runs(number: int) -> bool:
    try:
        text = Path(f"/proc/{number}/stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"
