"""Canned cycles G73, G74, G81 to G86 and G89 as sequences of simple strokes.

In the plane's own axes: the cycle moves across the plane and drills along the third axis.
Where it starts, with "old" the height at which the first cycle of a series began::

    old below R          rapid up to R first, then across at R
    not above R, G98     across to the old height
    not above R, G99     across to R
    above R              across at the present height

then down to R, the cycle's own strokes, and up: to R (G99) or to the old height (G98).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final, Literal

from fraese.errors import ProgramError
from fraese.phrases import phrase

# How far above the last depth a rapid plunge of G83 ends, and how far G73 backs off: 0.01 inch.
CLEARANCE_MM: Final = 0.254

Stroke = tuple[
    Literal["rapid", "feed", "dwell", "stop", "start", "reverse", "hold feed", "free feed"],
    float,  # height in mm, or seconds for a dwell, nothing for spindle and feed override
]


@dataclass(frozen=True, slots=True)
class Sticky:
    """Words that a cycle remembers from line to line while its code stays in force.

    In units of the program as written; None where never given.
    """

    code: int
    r: float | None = None
    depth: float | None = None
    p: float | None = None
    q: float | None = None

    def updated(self, words: dict[str, float], depth_letter: str) -> "Sticky":
        """The same with what a new line says."""
        return replace(
            self,
            r=words.get("r", self.r),
            depth=words.get(depth_letter, self.depth),
            p=words.get("p", self.p),
            q=words.get("q", self.q),
        )


@dataclass(frozen=True, slots=True)
class Hole:
    """One hole in absolute heights: from ``r_mm`` down to ``bottom_mm``, then to ``clear_mm``."""

    r_mm: float
    bottom_mm: float
    clear_mm: float
    peck_mm: float | None
    dwell_s: float | None


def _drill(hole: Hole) -> Iterator[Stroke]:
    yield "feed", hole.bottom_mm
    yield "rapid", hole.clear_mm


def _drill_dwell(hole: Hole) -> Iterator[Stroke]:
    yield "feed", hole.bottom_mm
    yield "dwell", _dwell(hole)
    yield "rapid", hole.clear_mm


def _peck(hole: Hole, to_top: bool) -> Iterator[Stroke]:
    peck_mm = _peck_depth(hole)
    depth_mm = hole.r_mm - peck_mm
    while depth_mm > hole.bottom_mm:
        yield "feed", depth_mm
        if to_top:
            yield "rapid", hole.r_mm
        yield "rapid", depth_mm + CLEARANCE_MM
        depth_mm -= peck_mm
    yield from _drill(hole)


def _bore(hole: Hole) -> Iterator[Stroke]:
    yield "feed", hole.bottom_mm
    yield "feed", hole.r_mm
    yield "rapid", hole.clear_mm


def _bore_stop(hole: Hole) -> Iterator[Stroke]:
    yield "feed", hole.bottom_mm
    yield "dwell", _dwell(hole)
    yield "stop", 0.0
    yield "rapid", hole.clear_mm
    yield "start", 0.0


def _bore_dwell(hole: Hole) -> Iterator[Stroke]:
    yield "feed", hole.bottom_mm
    yield "dwell", _dwell(hole)
    yield "feed", hole.clear_mm


def _tap(hole: Hole) -> Iterator[Stroke]:
    # The tap's own pitch leads; a floating holder makes up for what feed and speed differ.
    yield "hold feed", 0.0
    yield "feed", hole.bottom_mm
    yield "reverse", 0.0
    yield "dwell", 0.0 if hole.dwell_s is None else _dwell(hole)
    yield "feed", hole.clear_mm
    yield "start", 0.0
    yield "free feed", 0.0


STROKES: Final[dict[int, Callable[[Hole], Iterator[Stroke]]]] = {
    730: lambda hole: _peck(hole, to_top=False),
    740: _tap,
    810: _drill,
    820: _drill_dwell,
    830: lambda hole: _peck(hole, to_top=True),
    840: _tap,
    850: _bore,
    860: _bore_stop,
    890: _bore_dwell,
}

# Which way the spindle has to turn; the other way, or not at all, is an error.
TURNS: Final[dict[int, tuple[tuple[int, ...], str]]] = {
    740: ((-1,), phrase("G74 taps a left-hand thread and needs a spindle that turns by M4")),
    840: ((1,), phrase("G84 taps a right-hand thread and needs a spindle that turns by M3")),
    860: ((-1, 1), phrase("G86 needs a turning spindle: start it with M3 or M4")),
}


def _dwell(hole: Hole) -> float:
    if hole.dwell_s is None:
        raise ProgramError(
            phrase("this canned cycle needs a P word: the time at the bottom in seconds")
        )
    if hole.dwell_s < 0:
        raise ProgramError(phrase("the P word of a canned cycle must not be negative"))
    return hole.dwell_s


def _peck_depth(hole: Hole) -> float:
    if hole.peck_mm is None:
        raise ProgramError(phrase("this canned cycle needs a Q word: the depth of one peck"))
    if hole.peck_mm <= 0:
        raise ProgramError(phrase("the Q word of a canned cycle has to be greater than 0"))
    if (hole.r_mm - hole.bottom_mm) / hole.peck_mm > 1e5:
        raise ProgramError(phrase("the Q word of the canned cycle asks for more than 100000 pecks"))
    return hole.peck_mm
