"""Probing cycles on the simulated mill, against solid things of known size on the shared input."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.errors import LimitError, ProgramError, StateError, UsageError
from fraese.program.probing import CYCLES, cycles_for, probe
from fraese.program.typed import run_text
from tests.helpers import carriages, homed, mill, program, run_program

RADIUS = 1.5
Solid = Callable[[float, float, float], bool]


def touching(made: Plant, is_solid: Solid) -> None:
    """The shared input closes where the tool touches; mm in machine coordinates."""
    port, controller = mill(made), made.controller
    read = port.read_status
    # What a carriage counts from the lower switch on, at machine zero.
    at_zero = [
        at - steps
        for at, steps in zip(carriages(made), controller.position.position_steps, strict=True)
    ]

    def read_status() -> int:
        at = [(now - zero) / 200 for now, zero in zip(carriages(made), at_zero, strict=True)]
        return read() & ~0x80 if is_solid(*at) else read()

    port.read_status = read_status  # type: ignore[method-assign]


def standing_at(made: Plant, x: float, y: float, z: float) -> None:
    for target in ({"x": x, "y": y}, {"z": z}):
        made.controller.move_to(target, machine_coordinates=True)
        assert made.controller.run() is Status.OK, made.controller.state().message


def done(made: Plant, name: str, **values: float) -> tuple[float, ...]:
    """Where the work zero lies after the cycle, machine coordinates."""
    probe(made.controller, name, values)
    assert made.controller.run() is Status.OK, made.controller.state().message
    return made.controller.state().offset_mm


def block(x: float, y: float, z: float) -> bool:
    """From X 50 to 80, Y 40 to 60, below Z -10; the tool's radius added."""
    return 50 - RADIUS <= x <= 80 + RADIUS and 40 - RADIUS <= y <= 60 + RADIUS and z <= -10


def test_down_on_a_plate() -> None:
    made = homed()
    touching(made, block)
    standing_at(made, 60, 50, -2)
    assert done(made, "down on work or plate", thickness=4)[2] == pytest.approx(-14, abs=0.02)
    assert made.controller.state().work_mm[2] == pytest.approx(6, abs=0.02)


@pytest.mark.parametrize(
    ("name", "at", "axis", "edge"),
    [
        ("edge X+", (40, 50), 0, 50),
        ("edge X−", (90, 50), 0, 80),
        ("edge Y+", (60, 30), 1, 40),
        ("edge Y−", (60, 70), 1, 60),
    ],
)
def test_an_edge(name: str, at: tuple[float, float], axis: int, edge: float) -> None:
    made = homed()
    touching(made, block)
    standing_at(made, *at, -12)
    before = made.controller.state().offset_mm
    after = done(made, name, diameter=2 * RADIUS)
    assert after[axis] == pytest.approx(edge, abs=0.02)
    assert all(after[n] == before[n] for n in range(3) if n != axis)


@pytest.mark.parametrize(
    ("name", "at", "corner"),
    [
        ("corner X+ Y+", (44, 34), (50, 40)),
        ("corner X− Y+", (86, 34), (80, 40)),
        ("corner X+ Y−", (44, 66), (50, 60)),
        ("corner X− Y−", (86, 66), (80, 60)),
    ],
)
def test_a_corner(name: str, at: tuple[float, float], corner: tuple[float, float]) -> None:
    made = homed()
    touching(made, block)
    standing_at(made, *at, -12)
    assert done(made, name, diameter=2 * RADIUS, width=12)[:2] == pytest.approx(corner, abs=0.02)


def test_the_centre_of_a_hole() -> None:
    made = homed()
    standing_at(made, 57, 45, -5)
    touching(made, lambda x, y, _: not (51.5 < x < 68.5 and 31.5 < y < 52.5))
    centre = done(made, "centre of a hole", diameter=2 * RADIUS)
    assert centre[:2] == pytest.approx((60, 42), abs=0.02)


def test_the_centre_of_a_boss() -> None:
    made = homed()
    touching(made, block)
    standing_at(made, 63, 52, -8)
    centre = done(made, "centre of a boss", diameter=2 * RADIUS, width=32, depth=4)
    assert centre[:2] == pytest.approx((65, 50), abs=0.02)
    assert made.controller.state().position_mm[2] == pytest.approx(-8)


def test_a_contact_on_the_way_stops_as_an_end_would() -> None:
    made = homed()
    touching(made, block)
    standing_at(made, 44, 34, -12)
    # The edge is nearer than the way past the corner: the tool runs into it.
    probe(made.controller, "corner X− Y+", {"width": 30})
    assert made.controller.run() is Status.ERROR


def test_a_probe_that_never_touches_changes_no_offset() -> None:
    made = homed()
    standing_at(made, 20, 20, -2)
    before = made.controller.state().offset_mm
    probe(made.controller, "down on work or plate", {"reach": 5})
    assert made.controller.run() is Status.ERROR
    assert "never touched" in made.controller.state().message
    assert made.controller.state().offset_mm == before


def test_a_probe_seeks_as_far_as_the_travel_goes_and_no_further() -> None:
    made = homed()
    standing_at(made, 20, 20, -2)
    probe(made.controller, "edge X−", {"reach": 900.0})
    assert made.controller.run() is Status.ERROR
    assert "never touched" in made.controller.state().message
    assert made.controller.state().position_mm[0] == pytest.approx(0, abs=0.01)


PLATE = "G21 G90\nG38.2 Z-50 F100\nG10 L20 P1 Z0\nG0 Z5\nG1 X10 F300\nG1 Z-10 F100\nG0 Z5\nM2\n"


@pytest.mark.parametrize("begins_mm", [-10, -2])  # its way ends beyond the travel, within it
def test_no_bound_is_known_behind_a_probe_until_it_has_touched(
    tmp_path: Path, begins_mm: float
) -> None:
    made = homed()
    standing_at(made, 20, 20, begins_mm)
    made.controller.set_zero("xyz")
    touching(made, lambda x, y, z: x < 25 and z <= -20)
    part = program(tmp_path, PLATE)
    facts = part.check(made.controller)
    assert facts.ok
    assert not facts.outside
    assert [(note.line, "behind it Z is judged" in note.message) for note in facts.notes] == [
        (2, True)
    ]
    assert run_program(made, part) is Status.OK, made.controller.state().message
    assert made.controller.state().offset_mm[2] == pytest.approx(-20, abs=0.02)
    assert made.controller.state().position_mm[2] == pytest.approx(-15, abs=0.02)


def test_what_is_outside_where_the_probe_touched_is_refused_as_it_comes(tmp_path: Path) -> None:
    made = homed()
    standing_at(made, 20, 20, -10)
    made.controller.set_zero("xyz")
    touching(made, lambda x, y, z: x < 25 and z <= -50)
    assert run_program(made, program(tmp_path, PLATE)) is Status.ERROR
    assert "line 6: Z -60.010 mm is outside" in made.controller.state().message
    assert made.controller.state().position_mm[2] == pytest.approx(-45, abs=0.02)


def test_axes_that_no_probe_has_moved_are_looked_at_behind_it(tmp_path: Path) -> None:
    made = homed()
    with pytest.raises(LimitError, match=r"line 3: X 400\.000"):
        program(tmp_path, "G21 G90\nG38.2 Z-50 F100\nG0 X400\nM2\n").check(made.controller)


def test_what_a_cycle_is_told_is_looked_at() -> None:
    made = homed()
    for values, said in (({"weight": 3.0}, "knows no"), ({"reach": 0.0}, "above 0")):
        with pytest.raises(UsageError, match=said):
            probe(made.controller, "edge X+", values)
    with pytest.raises(UsageError, match="no cycle"):
        probe(made.controller, "edge Q", {})
    assert cycles_for("xy") == tuple(
        name for name in CYCLES if name not in ("down on work or plate", "centre of a boss")
    )


def test_a_typed_line_runs_like_a_program() -> None:
    made = homed()
    controller = made.controller
    run_text(controller, "G91 G1 X5 Y-0 F600\nG10 L20 P2 X0")
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 5
    run_text(controller, "g 55 ")
    assert controller.run() is Status.OK
    assert controller.state().work.system == "G55"
    assert controller.state().work_mm[0] == 0
    with pytest.raises(LimitError, match="line 1"):
        run_text(controller, "G0 X5000")
    with pytest.raises(ProgramError):
        run_text(controller, "G123 X5")
    controller.start("long", iter(()))  # type: ignore[arg-type]
    with pytest.raises(StateError):
        run_text(controller, "G0 X1")
