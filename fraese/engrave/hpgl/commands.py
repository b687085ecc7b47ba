"""The commands of a plotter: what each does, a row each.

Rule 1: a command takes ``least`` numbers, and more of them in groups; what is left over is noted.
Rule 2: a command that draws nothing has no function, and a word that says why it is passed over.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from fraese.engrave.hpgl import encoded
from fraese.engrave.hpgl.lexer import Command
from fraese.engrave.hpgl.plotter import Plotter
from fraese.engrave.shapes import Points
from fraese.phrases import phrase

Numbers = Sequence[float]
Action = Callable[[Plotter, Numbers], None]
#: Numbers beyond this are no places.
_FURTHEST: Final = 1e9


class Row(NamedTuple):
    """What a command does.

    Attributes:
        act: with the plotter and its numbers.
        least: so many numbers it needs; without any it may have another meaning.
        group: further ones come so many at a time; 0: there are none.
        bare: it may stand without numbers.
    """

    act: Action
    least: int = 0
    group: int = 0
    bare: bool = False


def carry_out(command: Command, plotter: Plotter) -> None:
    """Do what a command says; never raises for what stands in it."""
    name = command.name
    if name in _TEXTS:
        _TEXTS[name](plotter, command.text)
        return
    if name in PASSED:
        plotter.note(name, phrase("{name} is passed over: {why}.", name=name, why=PASSED[name]))
        return
    row = ROWS.get(name)
    if row is None:
        unknown = phrase(
            "{name} in line {line} is not known, and passed over.", name=name, line=command.line
        )
        plotter.note(name, unknown)
        return
    numbers = _numbers_of(command, row, plotter)
    if numbers is not None:
        row.act(plotter, numbers)


def _numbers_of(command: Command, row: Row, plotter: Plotter) -> Numbers | None:
    """As many as the command takes; None: they are too few, or are no places."""
    numbers, name = command.numbers, command.name
    if any(abs(number) > _FURTHEST for number in numbers):
        plotter.note(
            name + "!",
            phrase(
                "{name} in line {line} has a number that is no place.", name=name, line=command.line
            ),
        )
        return None
    if not numbers and row.bare:
        return numbers
    more = len(numbers) - row.least
    left = more if not row.group else more % row.group
    if more < 0:
        plotter.note(
            name + "-",
            phrase(
                "{name} in line {line} has {count} numbers and needs {least}; it is passed over.",
                name=name,
                line=command.line,
                count=len(numbers),
                least=row.least,
            ),
        )
        return None
    if left:
        plotter.note(
            name + "+",
            phrase(
                "{name} in line {line} has {left} numbers too many; they are left out.",
                name=name,
                line=command.line,
                left=left,
            ),
        )
    return numbers[: len(numbers) - left]


# --- moves -------------------------------------------------------------------------------------


def _pairs(numbers: Numbers) -> list[tuple[float, float]]:
    return list(zip(numbers[::2], numbers[1::2], strict=False))


def _go(plotter: Plotter, numbers: Numbers) -> None:
    for x, y in _pairs(numbers):
        plotter.go(plotter.target(x, y))


def _up(plotter: Plotter, numbers: Numbers) -> None:
    plotter.rise()
    _go(plotter, numbers)


def _down(plotter: Plotter, numbers: Numbers) -> None:
    plotter.touch()
    _go(plotter, numbers)


def _moves(*, relative: bool) -> Action:
    def go(plotter: Plotter, numbers: Numbers) -> None:
        plotter.is_relative = relative
        _go(plotter, numbers)

    return go


def _encoded(plotter: Plotter, text: str) -> None:
    for move in encoded.moves(text):
        to = plotter.target(move.x, move.y, relative=not move.absolute)
        if move.draws:
            plotter.touch()
        else:
            plotter.rise()
        plotter.go(to)


# --- arcs and curves ---------------------------------------------------------------------------


def _arc(*, relative: bool) -> Action:
    def swing(plotter: Plotter, numbers: Numbers) -> None:
        x, y, sweep_deg = numbers[:3]
        plotter.swing(plotter.target(x, y, relative=relative), sweep_deg)

    return swing


def _three_points(*, relative: bool) -> Action:
    def swing(plotter: Plotter, numbers: Numbers) -> None:
        begin = plotter.here()
        middle = plotter.target(*numbers[0:2], relative=relative)
        end = plotter.target(*numbers[2:4], relative=relative)
        centre, sweep_deg = _through(begin, middle, end)
        if centre is None:
            plotter.go(end)
        else:
            plotter.swing(centre, sweep_deg)

    return swing


def _through(begin: Points, middle: Points, end: Points) -> tuple[Points | None, float]:
    """Centre and angle of the arc through three points; None: they lie in a line."""
    if (begin == end).all():
        return (begin + middle) / 2, 360.0
    a, b = middle - begin, end - begin
    double = 2 * (a[0] * b[1] - a[1] * b[0])
    if abs(double) <= 1e-9 * float(a @ a + b @ b):
        return None, 0.0
    away = np.array((b[1] * (a @ a) - a[1] * (b @ b), a[0] * (b @ b) - b[0] * (a @ a))) / double
    first, last = -away, b - away
    swept = np.degrees(np.arctan2(last[1], last[0]) - np.arctan2(first[1], first[0]))
    sweep_deg = float(np.mod(swept, 360) if double > 0 else -np.mod(-swept, 360))
    return begin + away, sweep_deg


def _curves(*, relative: bool) -> Action:
    def bend(plotter: Plotter, numbers: Numbers) -> None:
        for at in range(0, len(numbers), 6):
            controls = [
                plotter.target(x, y, relative=relative) for x, y in _pairs(numbers[at : at + 6])
            ]
            plotter.bend(np.array(controls))

    return bend


def _circle(plotter: Plotter, numbers: Numbers) -> None:
    plotter.ring(numbers[0])


# --- shapes ------------------------------------------------------------------------------------


def _rectangle(*, relative: bool) -> Action:
    def outline(plotter: Plotter, numbers: Numbers) -> None:
        (x0, y0), (x1, y1) = plotter.here(), plotter.target(*numbers[:2], relative=relative)
        plotter.outline([np.array(at) for at in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])

    return outline


def _wedge(plotter: Plotter, numbers: Numbers) -> None:
    radius, start_deg, sweep_deg = numbers[:3]
    plotter.wedge(radius, start_deg, sweep_deg)


def _polygon(plotter: Plotter, numbers: Numbers) -> None:
    step = int(numbers[0]) if numbers else 0
    actions = {0: Plotter.begin_polygon, 1: Plotter.close_polygon, 2: Plotter.end_polygon}
    actions.get(step, Plotter.close_polygon)(plotter)


def _draw_polygon(plotter: Plotter, _numbers: Numbers) -> None:
    plotter.draw_polygon()


# --- where and how -----------------------------------------------------------------------------


def _reset(plotter: Plotter, _numbers: Numbers) -> None:
    plotter.lift()
    plotter.reset()


def _defaults(plotter: Plotter, _numbers: Numbers) -> None:
    plotter.scale(None, isotropic=False)
    plotter.is_relative = False


def _pen(plotter: Plotter, numbers: Numbers) -> None:
    if not numbers or numbers[0] == 0:
        plotter.rise()
    plotter.take_pen(int(numbers[0]) if numbers else 0)


def _input_points(plotter: Plotter, numbers: Numbers) -> None:
    if not numbers:
        plotter.usual_frame()
        return
    p1 = (numbers[0], numbers[1])
    width, height = plotter.size()
    p2 = (numbers[2], numbers[3]) if len(numbers) > 2 else (p1[0] + width, p1[1] + height)
    if p1[0] == p2[0] or p1[1] == p2[1]:
        plotter.note("IP0", phrase("IP names two places without a width; it is passed over."))
        return
    plotter.frame(p1, p2)


def _scale(plotter: Plotter, numbers: Numbers) -> None:
    if not numbers:
        plotter.scale(None, isotropic=False)
        return
    kind = int(numbers[4]) if len(numbers) > 4 else 0
    x0, x1, y0, y1 = numbers[:4]
    if kind == 2:
        # Two places and two factors, in plotter units for each user unit.
        width, height = plotter.size()
        x0, x1, y0, y1 = x0, x0 + _share(width, x1), y0, y0 + _share(height, y1)
    if x0 == x1 or y0 == y1:
        plotter.note("SC0", phrase("SC names a scale without a width; it is passed over."))
        return
    if not plotter.is_framed:
        plotter.note(
            "SC?", phrase("SC stands without IP: it is scaled as a plotter for A4 would have done.")
        )
    plotter.scale((x0, x1, y0, y1), isotropic=kind == 1)


def _share(length: float, factor: float) -> float:
    return length / factor if factor else 0.0


def _rotate(plotter: Plotter, numbers: Numbers) -> None:
    plotter.lift()
    plotter.rotate(round(numbers[0] / 90) if numbers else 0)


def _line_type(plotter: Plotter, numbers: Numbers) -> None:
    if numbers:
        plotter.note("LT", phrase("LT: dashed lines are drawn whole."))


# --- texts -------------------------------------------------------------------------------------


def _label(plotter: Plotter, text: str) -> None:
    if text.strip():
        plotter.note(
            "LB",
            phrase(
                'LB: labels are not drawn, as in "{text}"; make lines of them in the program that'
                " they come from.",
                text=text.strip()[:40],
            ),
        )


def _symbols(plotter: Plotter, text: str) -> None:
    if text.strip(" ;"):
        plotter.note("SM", phrase("SM: symbols at the corners are not drawn."))


#: Commands with a text of their own.
_TEXTS: Final[Mapping[str, Callable[[Plotter, str], None]]] = {
    "LB": _label,
    "PE": _encoded,
    "SM": _symbols,
    "DT": lambda plotter, text: None,
}

#: Commands that draw, or say where.
ROWS: Final[Mapping[str, Row]] = {
    "IN": Row(_reset, bare=True, group=1),
    "DF": Row(_defaults, bare=True),
    "PU": Row(_up, group=2),
    "PD": Row(_down, group=2),
    "PA": Row(_moves(relative=False), group=2),
    "PR": Row(_moves(relative=True), group=2),
    "AA": Row(_arc(relative=False), 3, 1),
    "AR": Row(_arc(relative=True), 3, 1),
    "AT": Row(_three_points(relative=False), 4, 1),
    "RT": Row(_three_points(relative=True), 4, 1),
    "BZ": Row(_curves(relative=False), 6, 6),
    "BR": Row(_curves(relative=True), 6, 6),
    "CI": Row(_circle, 1, 1),
    "EA": Row(_rectangle(relative=False), 2),
    "ER": Row(_rectangle(relative=True), 2),
    "RA": Row(_rectangle(relative=False), 2),
    "RR": Row(_rectangle(relative=True), 2),
    "EW": Row(_wedge, 3, 1),
    "WG": Row(_wedge, 3, 1),
    "PM": Row(_polygon, 1, bare=True),
    "EP": Row(_draw_polygon, bare=True),
    "FP": Row(_draw_polygon, group=1, bare=True),
    "SP": Row(_pen, 1, bare=True),
    "IP": Row(_input_points, 2, 2, bare=True),
    "SC": Row(_scale, 4, 1, bare=True),
    "RO": Row(_rotate, 1, bare=True),
    "LT": Row(_line_type, group=1, bare=True),
}

_SPEED: Final = phrase("the feed is what --feed says")
_PEN: Final = phrase("the tool is as wide as it is")
_FILL: Final = phrase("fills are what --way sweep makes")
_TEXT: Final = phrase("it shapes labels, which are not drawn")
_PAPER: Final = phrase("it is about the paper")
_ANSWER: Final = phrase("nobody waits for an answer")
_WINDOW: Final = phrase("nothing is cut off at a window; all of it is drawn")

#: Commands that draw nothing here, and why.
PASSED: Final[Mapping[str, str]] = {
    name: why
    for names, why in {
        "VS AS FS VA VN": _SPEED,
        "PW WU PT LA AC UL TR SV MC MT NP PC CR CO": _PEN,
        "FT RF SB": _FILL,
        "CA CS CP CC CM DI DR DV DL ES LO PB SA SI SL SR SS SD AD FI FN TD LM UC BL FR": _TEXT,
        "PS PG AF AH EC RP BP IR GM": _PAPER,
        "OA OC OD OE OF OG OH OI OK OL OO OP OS OT OW DP DC DA IM": _ANSWER,
        "IW": _WINDOW,
        "NR": _PAPER,
        "TL XT YT": phrase("ticks of axes are not drawn"),
    }.items()
    for name in names.split()
}
