"""Outlines for the judge of cutter compensation, made by hypothesis: any corner, any arc."""

import math

from hypothesis import strategies as st

#: Diameters of the tools, mm.
DIAMETERS = {1: 6.0, 2: 1.5, 3: 0.4}
LENGTHS = dict.fromkeys(DIAMETERS, 0.0)
# No round numbers: a corner of nothing, or a move of which nothing is left, is a matter of
# rounding, and rounding is done elsewhere there.
_WAYS = st.integers(-20_000, 20_000).map(lambda n: n / 997)
_RADII = st.integers(300, 12_000).map(lambda n: n / 997)
_DEGREES = st.integers(1, 35_900).map(lambda n: n / 100 + 0.0037)
#: By plane: end words, centre words, and the third.
_LETTERS = {17: ("x", "y", "i", "j", "z"), 18: ("z", "x", "k", "i", "y")}


def _line(code: str, way: tuple[float, float], plane: int) -> str:
    a, b, *_ = _LETTERS[plane]
    return f"{code} {a}{way[0]:.6f} {b}{way[1]:.6f}"


def _arc(code: str, radius: float, at: float, sweep: float, rise: str, plane: int) -> str:
    """An arc in relative words: from its start about a centre at this angle."""
    a, b, i, j, _ = _LETTERS[plane]
    ci, cj = radius * math.cos(math.radians(at)), radius * math.sin(math.radians(at))
    turn = math.radians(sweep if code == "g3" else -sweep)
    x = ci - ci * math.cos(turn) + cj * math.sin(turn)
    y = cj - ci * math.sin(turn) - cj * math.cos(turn)
    return f"{code} {a}{x:.6f} {b}{y:.6f} {i}{ci:.6f} {j}{cj:.6f}{rise}"


def _pieces(plane: int) -> st.SearchStrategy[str]:
    third = _LETTERS[plane][4]
    planes = st.just(plane)
    lines = st.builds(_line, st.sampled_from(("g1", "g1", "g0")), st.tuples(_WAYS, _WAYS), planes)
    arcs = st.builds(
        _arc,
        st.sampled_from(("g2", "g3")),
        _RADII,
        _DEGREES,
        _DEGREES,
        st.sampled_from(("", "", f" {third}1.5", " f77")),
        planes,
    )
    others = st.sampled_from((f"g0 {third}1", f"g1 {third}-.7", "s200 m3", "g4 p.5", "f250"))
    return st.one_of(lines, lines, arcs, arcs, others)


def _program(plane: int, on: str, tool: int, entry: float, pieces: list[str], off: str) -> str:
    word = f"d{tool}" if "." not in on else f"d{DIAMETERS[tool]}"
    first = _line("g1", (entry, 0.0), plane)
    return "\n".join(
        ("g21 f100 g0 x1 y2 z3", f"g{plane} g91", f"{on} {word}", first, *pieces, off, "m2", "")
    )


def outlines(plane: int) -> st.SearchStrategy[str]:
    """Programs of one outline in a plane: a way to it, the pieces, and a way off."""
    return st.builds(
        _program,
        st.just(plane),
        st.sampled_from(("g41", "g42", "g41.1", "g42.1")),
        st.sampled_from((1, 2, 2, 3, 3, 3)),
        st.integers(2_500, 20_000).map(lambda n: n / 997),
        st.lists(_pieces(plane), min_size=1, max_size=7),
        st.sampled_from(("g40 g1 x3 y4 z5", "g40\ng0 x3 y4 z5", "g40\ng90 g1 x3", "m5")),
    )


#: The first move is an arc.
def _entered_by_arc(on: str, tool: int, arc: str, pieces: list[str]) -> str:
    return "\n".join(("g21 f100 g0 x1 y2 z3 g91", f"{on} d{tool}", arc, *pieces, "m2", ""))


ENTERED_BY_ARC = st.builds(
    _entered_by_arc,
    st.sampled_from(("g41", "g42")),
    st.sampled_from((2, 3)),
    st.builds(
        _arc, st.sampled_from(("g2", "g3")), _RADII, _DEGREES, _DEGREES, st.just(""), st.just(17)
    ),
    st.lists(_pieces(17), max_size=2),
)
