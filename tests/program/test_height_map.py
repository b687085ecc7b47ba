"""A warped plate on the simulated mill: probed, and milled as if it were flat."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, solids
from fraese.assembly.solids import _top
from fraese.config.solid import SimulatedSolid
from fraese.control.jobs import line_of, move_of
from fraese.control.state import Status
from fraese.errors import LimitError, ProgramError, StateError, UsageError
from fraese.heightmap.bend import TOLERANCE_MM
from fraese.heightmap.heights import HeightMap
from fraese.heightmap.mapfile import PartMap, encoded
from fraese.program.check import check_program
from fraese.program.context import ProgramContext
from fraese.program.grid import Grid
from fraese.program.kept import KeptPrograms
from fraese.program.mapfiles import MapFile
from fraese.program.mapped import take_map
from fraese.program.mapping import Feeling, Mapping, empty_map
from fraese.program.program import Program, open_program
from fraese.program.resumption import Resumption
from fraese.program.source import ProgramSource
from fraese.program.taken import take_program
from fraese.program.translate import Translation
from tests.helpers import after_slices, carriages, homed, merged, program, record, run_program

TOP_MM = -30.0
BOARD: dict[str, Any] = {"x_mm": [40, 120], "y_mm": [30, 100], "top_mm": TOP_MM}
WARP = [0.0, 0.6, -0.5, 0.4]
WARPS = (WARP, [0.3, 0.3, 0.3, 0.3], [-0.7, 0.8, 0.1, -0.8])
OWN_PROBE = {"probe": {"pin": 12}}
#: Of the built-in machine.
HALF_STEP_MM = 0.005
GRID = Grid((0.0, 0.0), (60.0, 50.0), 25.0)
PART = (
    "G21 G90 F900\nG0 Z2\nG0 X5 Y5\nG1 Z-0.2\nG1 X50 Y40\nG2 X50 Y20 I0 J-10\nG1 X5 Y5\n"
    "G2 X25 Y5 I10 J0\nG0 Z2\nM2\n"
)


def board(*corners: float) -> SimulatedSolid:
    return SimulatedSolid.model_validate({**BOARD, "corners_mm": list(corners)})


def table(*corners: float, **others: Any) -> Plant:
    """A referenced mill, its tool above the work zero of a warped board."""
    solids = {"board": {**BOARD, "corners_mm": list(corners)}}
    made = homed(**merged(OWN_PROBE, {"simulation": {"solids": solids}}, others))
    made.controller.move_to({"x": 50.0, "y": 40.0, "z": TOP_MM + 3}, machine_coordinates=True)
    assert made.controller.run() is Status.OK
    made.controller.set_zero("xy")
    return made


def probing(made: Plant, keep: Callable[[PartMap], None] = lambda part: None) -> Mapping:
    one = Mapping(made.controller, empty_map(made.controller, GRID), Feeling(), keep)
    one.start()
    return one


def probed(made: Plant) -> HeightMap:
    one = probing(made)
    assert made.controller.run() is Status.OK, made.controller.state().message
    return one.part.whole()


def zero_on_work(made: Plant, surface: SimulatedSolid) -> None:
    """Z0 on the work at X0 Y0, as touching off there would set it."""
    height_mm = made.controller.state().position_mm[2] - _top(surface, 50.0, 40.0)
    made.controller.set_zero("z", height_mm)


def chosen(folder: Path, heights: HeightMap, name: str = "board.map") -> Path:
    part = PartMap(
        heights.x_mm, heights.y_mm, heights.heights_mm, heights.reference_mm, heights.system,
        heights.origin_mm,
    )  # fmt: skip
    path = folder / name
    path.write_text(encoded(part), "utf-8")
    return path


def with_map(part: Program, heights: HeightMap, folder: Path) -> Program:
    part.heights = take_map(chosen(folder, heights))
    return part


def flat_machine() -> Plant:
    """A referenced mill with X0 Y0 Z0 in the middle of its room."""
    made = homed(**OWN_PROBE)
    made.controller.move_to({"x": 50.0, "y": 40.0, "z": -20.0}, machine_coordinates=True)
    assert made.controller.run() is Status.OK
    made.controller.set_zero("xyz")
    return made


# --- probing -------------------------------------------------------------------------------------


@pytest.mark.parametrize("corners", WARPS)
def test_every_point_is_as_high_as_the_board(corners: list[float]) -> None:
    made, surface = table(*corners), board(*corners)
    heights = probed(made)
    zero = _top(surface, 50, 40)
    for y, row in zip(heights.y_mm, heights.heights_mm, strict=True):
        for x, height in zip(heights.x_mm, row, strict=True):
            assert height == pytest.approx(_top(surface, 50 + x, 40 + y) - zero, abs=0.011)
    assert heights.reference_mm == (0, 0)
    assert heights.origin_mm == (50, 40)
    assert made.controller.state().position_mm[2] == TOP_MM + 3


def test_an_end_switch_as_probe_does_as_well() -> None:
    solids = {"board": {**BOARD, "corners_mm": WARP}}
    made = homed(simulation={"solids": solids})
    made.controller.move_to({"x": 50.0, "y": 40.0, "z": TOP_MM + 3}, machine_coordinates=True)
    assert made.controller.run() is Status.OK
    made.controller.set_zero("xy")
    assert probed(made).highest_mm > 0.2


def test_what_is_cut_short_is_kept_and_gone_on_with(tmp_path: Path) -> None:
    made, file = table(*WARP), MapFile(tmp_path / "board.map")
    file.begin(empty_map(made.controller, GRID))
    one = probing(made, file.keep)
    after_slices(made.controller, 100, made.controller.cancel)
    assert made.controller.run() is Status.CANCEL
    file.close()
    made.controller.set_break_key(lambda: None)
    assert 0 < one.part.missing < one.part.points
    with pytest.raises(ProgramError, match=r"not probed to its end: \d+ of 12 points are missing"):
        take_map(file.path)
    found = take_map_part(file.path)
    assert found == one.part
    made.controller.move_to({"z": TOP_MM + 3}, machine_coordinates=True)
    assert made.controller.run() is Status.OK
    rest = Mapping(made.controller, found, Feeling(), file.keep)
    rest.start()
    assert made.controller.run() is Status.OK
    file.close()
    whole = take_map(file.path).heights
    assert whole == rest.part.whole()
    again = probed(table(*WARP))
    for row, other in zip(whole.heights_mm, again.heights_mm, strict=True):
        assert row == pytest.approx(other, abs=0.011)


def take_map_part(path: Path) -> PartMap:
    from fraese.program.content import take
    from fraese.program.mapped import part_of

    content = take(path)
    assert content is not None
    return part_of(content)


def test_another_zero_is_refused_when_it_goes_on() -> None:
    made = table(*WARP)
    part = empty_map(made.controller, GRID)
    made.controller.set_zero("x", 5)
    with pytest.raises(StateError, match="The zero of X and Y has moved"):
        Mapping(made.controller, part, Feeling(), lambda part: None).start()


def test_nothing_there_ends_it_with_what_was_found() -> None:
    made = table(*WARP)
    far = Grid((0.0, 0.0), (100.0, 50.0), 25.0)
    one = Mapping(made.controller, empty_map(made.controller, far), Feeling(), lambda part: None)
    one.start()
    assert made.controller.run() is Status.ERROR
    assert "point 4 of 15, at work X 75.000 Y 0.000: nothing was touched down to X 125.000" in (
        made.controller.state().message
    )
    assert one.part.missing == 12


def test_a_rise_that_is_too_steep_is_told_by_its_point() -> None:
    made = table(-5.0, 35.0, -5.0, 35.0)
    one = probing(made)
    assert made.controller.run() is Status.ERROR
    said = made.controller.state().message
    assert "point 2 of 12: the probe touches before it is moved down" in said
    assert one.part.points - one.part.missing == 1


@pytest.mark.parametrize(
    ("grid", "said"),
    [
        (Grid((0, 0), (0, 10), 5), "goes from X0 to X0"),
        (Grid((0, 0), (10, 10), 0), "that is above 0"),
        (Grid((0, 0), (1000, 1000), 0.5), "more than 100000 points"),
    ],
)
def test_no_grid_is_refused(grid: Grid, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        grid.lines()


def test_points_outside_the_travel_are_refused() -> None:
    made = table(*WARP)
    grid = Grid((0.0, 0.0), (600.0, 50.0), 50.0)
    one = Mapping(made.controller, empty_map(made.controller, grid), Feeling(), lambda part: None)
    with pytest.raises(LimitError, match="outside the travel"):
        one.start()


def test_points_are_no_further_apart_than_wanted() -> None:
    x_mm, y_mm = Grid((95, 0), (0, 7), 10).lines()
    assert x_mm == tuple(9.5 * n for n in range(11))
    assert y_mm == (0, 7)


# --- milling -------------------------------------------------------------------------------------


@pytest.mark.parametrize("corners", WARPS)
def test_the_depth_in_the_board_is_the_same_all_along(corners: list[float], tmp_path: Path) -> None:
    """Wherever the tool is while it cuts, it is 0.2 mm deep in the warped board."""
    made, surface = table(*corners), board(*corners)
    heights = probed(made)
    zero_on_work(made, surface)
    sampled: list[tuple[float, ...]] = []

    def sample() -> None:
        state = made.controller.state()
        if state.job is not None and 5 <= state.job.line <= 8 and state.carriages_mm:
            sampled.append(state.carriages_mm)

    part = with_map(program(tmp_path, PART), heights, tmp_path)
    facts = part.check(made.controller)
    made.controller.set_break_key(sample)
    part.start(made.controller, facts)
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert len(sampled) > 50
    # What the probe and Z0 are off by a step, the tool by a half; and the map between its points.
    within_mm = 4 * HALF_STEP_MM + TOLERANCE_MM
    for x, y, z in sampled:
        assert z - _top(surface, x, y) == pytest.approx(-0.2, abs=within_mm)
    spread = [z - _top(surface, x, y) for x, y, z in sampled]
    assert max(spread) - min(spread) <= within_mm
    assert not any(made.controller.state().lost_steps)


#: Of the curved board: mm of height at a mm from its ridge, to the square.
CURVE = 0.0008


def _curved(_solid: SimulatedSolid, x: float, y: float) -> float:
    return TOP_MM + 0.3 - CURVE * ((x - 78) ** 2 + (y - 66) ** 2)


@pytest.mark.parametrize("every_mm", [25.0, 12.5])
def test_in_a_board_that_is_curved_between_the_points_it_is_off_by_the_chord(
    every_mm: float, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What a map cannot know is how the board bulges between its points: the sag of a chord."""
    monkeypatch.setattr(solids, "_top", _curved)
    made = table(0, 0, 0, 0)
    grid = Grid((0.0, 0.0), (60.0, 50.0), every_mm)
    one = Mapping(made.controller, empty_map(made.controller, grid), Feeling(), lambda part: None)
    one.start()
    assert made.controller.run() is Status.OK, made.controller.state().message
    heights = one.part.whole()
    made.controller.set_zero("z", TOP_MM + 3 - _curved(board(0, 0, 0, 0), 50, 40))
    depths: list[float] = []

    def sample() -> None:
        state = made.controller.state()
        if state.job is not None and 5 <= state.job.line <= 8 and state.carriages_mm:
            x, y, z = state.carriages_mm
            depths.append(_curved(board(0, 0, 0, 0), x, y) - z)

    part = with_map(program(tmp_path, PART), heights, tmp_path)
    made.controller.set_break_key(sample)
    part.start(made.controller, part.check(made.controller))
    assert made.controller.run() is Status.OK, made.controller.state().message
    cell_x, cell_y = heights.x_mm[1], heights.y_mm[1]
    sag_mm = CURVE * (cell_x**2 + cell_y**2) / 4
    within_mm = 4 * HALF_STEP_MM + TOLERANCE_MM
    assert min(depths) > 0.2 - within_mm
    # In the middle of a cell it is nearly all of that.
    assert 0.2 + 0.7 * sag_mm < max(depths) < 0.2 + sag_mm + within_mm


def test_a_map_with_the_mark_of_an_editor_is_one(tmp_path: Path) -> None:
    path = chosen(tmp_path, LEVEL)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert take_map(path).heights.heights_mm == LEVEL.heights_mm


LEVEL = HeightMap((0, 30, 60), (0, 50), ((0.25, 0.25, 0.25), (0.25, 0.25, 0.25)))


def test_a_level_map_makes_the_register_writes_of_the_program_shifted(tmp_path: Path) -> None:
    shifted = PART.replace("Z2", "Z2.25").replace("Z-0.2", "Z0.05")
    writes = []
    for text, heights in ((PART, LEVEL), (shifted, None)):
        made = flat_machine()
        part = program(tmp_path, text)
        if heights is not None:
            with_map(part, heights, tmp_path)
        noted = record(made)
        assert run_program(made, part) is Status.OK
        writes.append(noted.writes())
    assert writes[0] == writes[1]
    assert len(writes[0]) > 1000


TWISTED = HeightMap(
    (0, 20, 40, 60), (0, 25, 50), ((0, 0.1, 0, 0.3), (0.4, 0, 0.2, 0), (0, 0.1, 0, 0.2))
)


def test_what_was_commanded_was_made(tmp_path: Path) -> None:
    made = flat_machine()
    before = carriages(made)
    assert run_program(made, with_map(program(tmp_path, PART), TWISTED, tmp_path)) is Status.OK
    state = made.controller.state()
    assert state.carriages_mm == pytest.approx(state.position_mm, abs=1e-9)
    assert state.work_mm == pytest.approx((25, 5, 2 + TWISTED.at(25, 5)), abs=HALF_STEP_MM)
    assert not any(state.lost_steps)
    assert carriages(made) != before


def _blocks(made: Plant, path: Path, heights: HeightMap | None) -> list[Any]:
    context = ProgramContext.of(made.controller, heights)
    moves = ProgramSource(take_program(path), context).moves()
    return [each for each in Translation(context, None).blocks(moves) if hasattr(each, "tag")]


def test_blocks_are_of_the_lines_and_moves_of_the_program(tmp_path: Path) -> None:
    made = flat_machine()
    path = program(tmp_path, PART).path
    bent, flat = (_blocks(made, path, heights) for heights in (TWISTED, None))
    assert len(bent) > len(flat)
    for what in (line_of, move_of):
        assert list(dict.fromkeys(what(each.tag) for each in bent)) == list(
            dict.fromkeys(what(each.tag) for each in flat)
        )


@pytest.mark.parametrize("mode", ["G61", "G61.1", "G64", "G64 P0.01"])
def test_the_feed_is_that_of_the_program(tmp_path: Path, mode: str) -> None:
    """Nothing stops or slows where a line is in pieces: only the longer way takes its time."""
    made = flat_machine()
    path = program(tmp_path, f"{mode}\n{PART}").path
    taken = take_program(path)
    bent, flat = (
        check_program(taken, ProgramContext.of(made.controller, heights))
        for heights in (TWISTED, None)
    )
    assert bent.duration_s == pytest.approx(flat.duration_s, rel=0.01)
    assert bent.length_mm == pytest.approx(flat.length_mm, rel=0.01)


def test_lines_that_are_shorter_than_a_piece_stay_single_moves(tmp_path: Path) -> None:
    made = flat_machine()
    short = "G21 G90 F900\nG0 Z2\n" + "".join(f"G1 X{n / 4} Y{n % 2}\n" for n in range(1, 200))
    taken = take_program(program(tmp_path, short).path)
    bent, flat = (
        check_program(taken, ProgramContext.of(made.controller, heights))
        for heights in (TWISTED, None)
    )
    assert bent.duration_s == pytest.approx(flat.duration_s, rel=0.02)
    assert bent.blocks <= 1.3 * flat.blocks


def test_what_leaves_the_travel_by_the_map_alone_is_refused(tmp_path: Path) -> None:
    made = flat_machine()
    part = program(tmp_path, "G21 G90 F900\nG1 Z19.9\nG1 X10\nG1 X60\nM2\n")
    part.check(made.controller)
    with_map(part, TWISTED, tmp_path)
    with pytest.raises(LimitError, match=r"line 4: Z 0\.200 mm is outside"):
        part.check(made.controller)


def test_a_beam_is_dark_along_bent_rapids(tmp_path: Path) -> None:
    made = homed(**merged(OWN_PROBE, {"outputs": {"laser": {"pin": 14}}}))
    text = "G21 G90 F900\nM3 S1\nG0 X30 Y40\nG1 X0 Y0\nM2\n"
    path = program(tmp_path, text).path
    for block in _blocks(made, path, TWISTED):
        if block.outputs is not None:
            assert line_of(block.tag) in (0, 4, 5)


# --- from a line, and after an interruption ------------------------------------------------------


def test_from_a_line_it_is_bent_all_the_same(tmp_path: Path) -> None:
    made = flat_machine()
    part = with_map(program(tmp_path, PART.replace("G0 Z2\nM2", "M2")), TWISTED, tmp_path)
    assert run_program(made, part, from_line=7) is Status.OK
    assert made.controller.state().work_mm == pytest.approx(
        (25, 5, -0.2 + TWISTED.at(25, 5)), abs=HALF_STEP_MM
    )


def _cut_short(folder: Path, heights: HeightMap | None = TWISTED) -> tuple[Plant, KeptPrograms]:
    made, kept = flat_machine(), KeptPrograms(folder / "state")
    (folder / "part.ngc").write_text(PART)
    part = open_program(folder / "part.ngc", kept=kept)
    if heights is not None:
        with_map(part, heights, folder)
    part.start(made.controller, part.check(made.controller))
    after_slices(made.controller, 40, made.controller.cancel)
    assert made.controller.run() is Status.CANCEL
    made.controller.set_break_key(lambda: None)
    return made, kept


def test_it_goes_on_with_the_map_it_was_run_with(tmp_path: Path) -> None:
    made, kept = _cut_short(tmp_path)
    (tmp_path / "board.map").unlink()
    going = Resumption.of(made.controller, kept)
    assert any("board.map is gone from where it was opened" in said for said in going.news())
    sampled: list[tuple[float, ...]] = []

    def sample() -> None:
        state = made.controller.state()
        if state.job is not None and 7 <= state.job.line <= 8:
            sampled.append(state.work_mm)

    made.controller.set_break_key(sample)
    going.start(made.controller)
    assert made.controller.run() is Status.OK
    assert len(sampled) > 10
    for x, y, z in sampled:
        assert z == pytest.approx(-0.2 + TWISTED.at(x, y), abs=HALF_STEP_MM + TOLERANCE_MM + 0.003)


def test_a_changed_map_is_told_and_the_one_of_before_counts(tmp_path: Path) -> None:
    made, kept = _cut_short(tmp_path)
    chosen(tmp_path, LEVEL)
    going = Resumption.of(made.controller, kept)
    assert any("board.map has changed on disk" in said for said in going.news())
    assert going.program.heights is not None
    assert going.program.heights.heights == TWISTED


def test_without_the_copy_of_the_map_nothing_goes_on(tmp_path: Path) -> None:
    made, kept = _cut_short(tmp_path)
    content_hash = take_map(tmp_path / "board.map").content.content_hash
    (tmp_path / "state" / "jobs" / content_hash).unlink()
    with pytest.raises(ProgramError, match=r"board.map: the kept copy of this height map is gone"):
        Resumption.of(made.controller, kept)


def test_the_copy_of_a_map_goes_with_its_program(tmp_path: Path) -> None:
    _, kept = _cut_short(tmp_path)
    map_hash = take_map(tmp_path / "board.map").content.content_hash
    for n in range(5):
        other = tmp_path / f"other{n}.ngc"
        other.write_text(f"G0 X{n}\nM2\n")
        kept.keep(take_program(other))
    assert not (tmp_path / "state" / "jobs" / map_hash).exists()


def test_another_map_is_another_run(tmp_path: Path) -> None:
    """What a probe found on the way counts for the run with this map only."""
    made, kept = _cut_short(tmp_path)
    same = with_map(open_program(tmp_path / "part.ngc", kept=kept), TWISTED, tmp_path)
    now = same.stands(made.controller)
    assert same._run_before(now) is not None
    assert with_map(same, LEVEL, tmp_path)._run_before(now) is None
    same.heights = None
    assert same._run_before(now) is None


def test_a_program_that_probes_is_told_flat_answers(tmp_path: Path) -> None:
    """Touched off anywhere on the board, Z0 lies on it there and everywhere else."""
    made, surface = table(*WARP), board(*WARP)
    heights = probed(made)
    text = (
        "G21 G90 F900\nG0 X40 Y30\nG38.2 Z-50 F60\nG10 L20 P1 Z0\nG0 Z2\nG0 X10 Y40\nG1 Z-0.1\nM2\n"
    )
    assert run_program(made, with_map(program(tmp_path, text), heights, tmp_path)) is Status.OK
    x, y, z = made.controller.state().carriages_mm
    assert z - _top(surface, x, y) == pytest.approx(-0.1, abs=0.03)
