"""Codes and what they belong to: modal groups, order of execution, who uses which word.

A code is an integer in tenths: G38.2 is 382. Two codes of one group on one line contradict
each other. The order in which a line's groups act is the tuple ``ORDER``, as LinuxCNC
documents it ("order of execution").
"""

from dataclasses import dataclass
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.canon import PathMode, Plane
from fraese.phrases import phrase

# group -> codes in tenths
G_GROUPS: Final[dict[str, tuple[int, ...]]] = {
    "nonmodal": (40, 100, 280, 281, 300, 301, 520, 530, 920, 921, 922, 923),
    "motion": (0, 10, 20, 30, 382, 383, 384, 385, *(730, 740, 810, 820, 830, 840, 850, 860, 890)),
    "cancel": (800,),
    "plane": (170, 180, 190),
    "distance": (900, 910),
    "arc_distance": (901, 911),
    "feed_mode": (930, 940),
    "units": (200, 210, 700, 710),
    "cutter": (400, 410, 411, 420, 421),
    "length": (430, 431, 432, 490),
    "retract": (980, 990),
    "system": (540, 550, 560, 570, 580, 590, 591, 592, 593),
    "path": (610, 611, 640),
    "spindle_mode": (970,),
    "lathe": (80,),
    # What is never in force here may be ended; each is a group of its own.
    **{f"no G{code / 10:g}": (code,) for code in (131, 150, 230, 250, 401, 500, 501, 670, 690)},
}
#: Codes that say the same: G70 and G71 are the older spelling of the units.
SAME: Final[dict[int, int]] = {700: 200, 710: 210}
M_GROUPS: Final[dict[str, tuple[int, ...]]] = {
    "stop": (0, 1, 2, 30, 60),
    "tool_change": (6, 61),
    "spindle": (3, 4, 5),
    "coolant": (7, 8, 9),
    "override": (48, 49, 50, 51, 52, 53),
    "state": (70, 71, 72, 73),
}
# What a three-axis mill without feedback cannot honour, with the reason that the user reads.
G_REFUSED: Final[dict[int, str]] = {
    50: phrase("splines are not supported; approximate them by G1, G2 and G3"),
    51: phrase("splines are not supported; approximate them by G1, G2 and G3"),
    52: phrase("NURBS are not supported; approximate them by G1, G2 and G3"),
    53: phrase("NURBS are not supported; approximate them by G1, G2 and G3"),
    70: phrase("the lathe's diameter mode is not supported on a mill; program radii (G8)"),
    121: phrase("polar interpolation is not supported; let the CAM program write X and Y"),
    160: phrase("polar coordinates are written with @ and ^ here"),
    330: phrase("motion synchronised with the spindle needs a spindle encoder, and there is none"),
    331: phrase("rigid tapping needs a spindle encoder, and there is none"),
    510: phrase("scaling is not supported; let the CAM program scale"),
    511: phrase("mirroring is not supported; let the CAM program mirror"),
    541: phrase("there are nine work coordinate systems here, G54 to G59, G59.1, G59.2 and G59.3"),
    660: phrase("macros by G66 are not supported; call a subroutine by M98 or o<name> call"),
    680: phrase("a work coordinate system is turned by G10 L2 R here"),
    720: phrase("it is a lathe's cycle"),
    760: phrase("threading needs a spindle encoder, and there is none"),
    870: phrase("back boring needs an oriented spindle, and there is none"),
    880: phrase("boring with manual retract is not supported; use G86 or G89"),
    950: phrase("feed per revolution needs a spindle encoder, and there is none; use G94"),
    960: phrase("constant surface speed is not supported; use G97 and S"),
}
M_REFUSED: Final[dict[int, str]] = {
    19: phrase("the spindle cannot be oriented: it has no encoder"),
    98: phrase("it has to be the first word of its line, with P and L alone behind it"),
    99: phrase("it has to stand alone on its line"),
    **dict.fromkeys(range(62, 69), phrase("synchronised inputs and outputs are not supported")),
}
G_GROUP: Final = {code: group for group, codes in G_GROUPS.items() for code in codes}
#: M-codes that a user may give a meaning.
USER_CODES: Final = range(100, 200)
M_GROUP: Final = {code: group for group, codes in M_GROUPS.items() for code in codes}

# The order in which a line takes effect. Single letters are words, the rest groups.
ORDER: Final = (
    "feed_mode",
    "f",
    "s",
    "t",
    "state",
    "tool_change",
    "spindle_mode",
    "spindle",
    "coolant",
    "override",
    "user",
    "dwell",
    "plane",
    "units",
    "cutter",
    "length",
    "system",
    "path",
    "distance",
    "arc_distance",
    "retract",
    "lathe",
    "nonmodal",
    "cancel",
    "motion",
    "stop",
)

ARCS: Final = frozenset({20, 30})
CUTTER_ON: Final = frozenset({410, 411, 420, 421})
CYCLES: Final = frozenset({730, 740, 810, 820, 830, 840, 850, 860, 890})
STRAIGHT: Final = frozenset({0, 10})
# The ways home; what stands beside them on a line is not moved again.
HOMES: Final = frozenset({280, 300})
# Codes outside the motion group that use X, Y and Z for themselves.
AXIS_USERS: Final = frozenset({100, 280, 300, 431, 520, 920})

_USER: Final = tuple(1000 + code for code in USER_CODES)

# word -> (codes that use it, how to say so)
WORD_USERS: Final[dict[str, tuple[frozenset[int], str]]] = {
    "i": (ARCS | {100}, phrase("G2, G3 or G10")),
    "j": (ARCS | {100}, phrase("G2, G3 or G10")),
    "k": (ARCS, phrase("G2 or G3")),
    "r": (ARCS | CYCLES | {100}, phrase("an arc, a canned cycle or G10")),
    "l": (CYCLES | CUTTER_ON | {100}, phrase("a canned cycle, G41.1, G42.1 or G10")),
    "q": (frozenset({100, 640, 730, 830, 1061, *_USER}), phrase("G10, G64, G73, G83 or M61")),
    "h": (frozenset({430, 432}), "G43"),
    "p": (
        ARCS | {40, 100, 640, 740, 820, 840, 860, 890, 1050, 1051, 1052, 1053, *_USER},
        phrase("G2, G3, G4, G10, G64, G74, G82, G84, G86, G89 or M50 to M53"),
    ),
    "$": (frozenset({1003, 1004, 1005, 1051, 970}), phrase("M3, M4, M5, M51 or G97")),
    "d": (CUTTER_ON, phrase("G41, G41.1, G42 or G42.1")),
}
# M-codes get this added where they share a table with G-codes.
M_OFFSET: Final = 1000


def name(code: int) -> str:
    """The way a person writes a G-code: 382 is ``G38.2``."""
    whole, tenth = divmod(code, 10)
    return f"G{whole}.{tenth}" if tenth else f"G{whole}"


def g_code(value: float) -> int:
    """The code of a G word, in tenths.

    Raises:
        ProgramError: there is no such code, or it is not supported.
    """
    code = round(value * 10)
    if abs(value * 10 - code) > 1e-3 or code not in G_GROUP:
        if code in G_REFUSED and abs(value * 10 - code) <= 1e-3:
            raise ProgramError(
                phrase("{name} is refused: {g_refused}", name=name(code), g_refused=G_REFUSED[code])
            )
        raise ProgramError(phrase("G{value:g} is not a known code", value=value))
    return code


def m_code(value: float) -> int:
    """The code of an M word.

    Raises:
        ProgramError: there is no such code, or it is not supported.
    """
    code = round(value)
    if abs(value - code) > 1e-4:
        raise ProgramError(
            phrase("M{value:g} is not a known code: M takes a whole number", value=value)
        )
    if code not in M_GROUP and code not in USER_CODES:
        if code in M_REFUSED:
            raise ProgramError(
                phrase("M{code} is refused: {m_refused}", code=code, m_refused=M_REFUSED[code])
            )
        raise ProgramError(phrase("M{code} is not a known code", code=code))
    return code


@dataclass(slots=True)
class Modal:
    """What stays in force from line to line; the coordinate systems are kept apart."""

    motion: int | None = None
    plane: Plane = 17
    scale_mm: float = 1.0
    absolute: bool = True
    arc_absolute: bool = False
    inverse_time: bool = False
    feed_mm_min: float = 0.0
    # the F word as written, which a change of units leaves alone; in G93 what came of it
    feed_word: float = 0.0
    spindle: int = 0
    rev_min: float = 0.0
    # an S word has come
    has_speed: bool = False
    mist: bool = False
    flood: bool = False
    tool: int = 0
    selected_tool: int = 0
    retract_to_start: bool = False
    path_mode: PathMode = PathMode.BLEND
    tolerance_mm: float = 0.0
    overrides: bool = True
