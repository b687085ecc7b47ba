"""Plate, edges, hole and tool setter of the simulated mill, touched by programs."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.assembly.solids import Table
from fraese.config.file import from_table
from fraese.config.solid import SimulatedSolid
from fraese.errors import ConfigError
from fraese.testing import Mill
from tests.helpers import configured, homed, merged
from tests.program.test_probing import done, standing_at

BLOCK = {"x_mm": [50, 80], "y_mm": [40, 60], "top_mm": -10}
SETTER = {"x_mm": [5, 15], "y_mm": [5, 15], "top_mm": -30}


def _made(*others: dict[str, Any], **solids: dict[str, Any]) -> Plant:
    return homed(**merged({"simulation": {"solids": solids}}, *others))


def test_down_on_a_plate() -> None:
    made = _made(work=BLOCK)
    standing_at(made, 60, 50, -2)
    assert done(made, "down on work or plate", thickness=4)[2] == pytest.approx(-14, abs=0.02)


@pytest.mark.parametrize(
    "probe", [{}, {"probe": {"pin": 12}}, {"probe": {"pin": 12, "closed_reads": 1}}]
)
@pytest.mark.parametrize(
    ("name", "at", "axis", "edge"),
    [("edge X+", (40, 50), 0, 50), ("edge Y−", (60, 70), 1, 60)],
)
def test_an_edge_by_a_tool_of_some_width(
    probe: dict[str, Any], name: str, at: tuple[float, float], axis: int, edge: float
) -> None:
    made = _made({"simulation": {"tool_diameter_mm": 3.0}}, probe, work=BLOCK)
    standing_at(made, *at, -12)
    assert done(made, name, diameter=3.0)[axis] == pytest.approx(edge, abs=0.02)


def test_a_hole_in_a_block() -> None:
    hole = {"x_mm": [60, 70], "y_mm": [46, 54], "top_mm": -18, "hole": True}
    made = _made({"simulation": {"tool_diameter_mm": 2.0}}, work=BLOCK, bore=hole)
    standing_at(made, 63, 51, -14)
    centre = done(made, "centre of a hole", diameter=2.0)
    assert centre[:2] == pytest.approx((65, 50), abs=0.02)
    assert done(made, "down on work or plate")[2] == pytest.approx(-18, abs=0.02)


def test_the_length_of_a_tool_on_a_setter() -> None:
    text = "G21 G90 G49\nG38.2 Z-50 F100\nG10 L1 P1 Z[#5063+30]\nG0 Z-1\nT1 M6\nG43\nM2\n"
    with Mill({"simulation": {"tool_length_mm": 12.5, "solids": {"setter": SETTER}}}) as mill:
        mill.home()
        mill.move(x=10, y=10, z=-2)
        mill.run(text, answers="")
        assert mill.state.work.tool_length_mm == pytest.approx(12.5, abs=0.02)


@given(
    x=st.floats(50, 80),
    y=st.floats(40, 60),
    corners=st.tuples(*[st.floats(-2, 2)] * 4),
    by=st.floats(0.01, 1),
)
def test_a_warped_top_lies_between_its_corners(
    x: float, y: float, corners: tuple[float, ...], by: float
) -> None:
    config = configured(simulation={"solids": {"work": {**BLOCK, "corners_mm": list(corners)}}})
    table = Table(config)
    low, high = -10 + min(corners), -10 + max(corners)
    assert table.is_touched(_half_steps(x, y, low - by))
    assert not table.is_touched(_half_steps(x, y, high + by))


@pytest.mark.parametrize(("corner", "x", "y"), [(0, 50, 40), (1, 80, 40), (2, 50, 60), (3, 80, 60)])
def test_each_corner_has_its_own_height(corner: int, x: float, y: float) -> None:
    corners = [1.0 if n == corner else 0.0 for n in range(4)]
    config = configured(simulation={"solids": {"work": {**BLOCK, "corners_mm": corners}}})
    assert Table(config).is_touched(_half_steps(x, y, -9.01))
    assert not Table(config).is_touched(_half_steps(x, y, -8.99))


def _half_steps(x: float, y: float, z: float) -> tuple[float, ...]:
    """Carriages of the built-in mill at a place of the machine."""
    table = Table(configured())
    zero = table.tip_mm((0, 0, 0))
    one = table.tip_mm((1, 1, 1))
    return tuple(
        (at - first) / (second - first)
        for at, first, second in zip((x, y, z), zero, one, strict=True)
    )


def test_a_solid_that_is_none_is_refused_in_a_sentence() -> None:
    with pytest.raises(ConfigError, match=r"x_mm goes from low to high, not 80 to 50"):
        from_table({"simulation": {"solids": {"work": {**BLOCK, "x_mm": [80, 50]}}}}, "here")


def test_a_mill_with_nothing_on_its_table_has_no_feeler() -> None:
    assert Table(configured()).blocks == []
    assert SimulatedSolid.model_validate(BLOCK).corners_mm == (0, 0, 0, 0)
