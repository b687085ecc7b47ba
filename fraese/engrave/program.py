"""Moves as lines of G-code, a word only where it is another one than before."""

from collections.abc import Callable, Iterable, Iterator, Sequence

from fraese.engrave.job import Job
from fraese.engrave.moves import Move
from fraese.engrave.placing import Sheet
from fraese.engrave.strokes import Stroke, Strokes
from fraese.engrave.tools import Cutter, Laser, Tool

_STATE = "G21 G90 G17 G40 G49 G80 G94"


def moves(
    tool: Tool, strokes: Strokes, job: Job, tell: Callable[[int], None] = lambda done: None
) -> Iterator[Move]:
    """All moves of a program.

    Args:
        tool: what cuts.
        strokes: what it cuts.
        job: what somebody wants.
        tell: is told how many strokes are done.
    """
    yield from tool.begin()
    for number, stroke in enumerate(strokes.each):
        yield from _cut(tool, stroke, job)
        tell(number + 1)
    yield from tool.end()


def _cut(tool: Tool, stroke: Stroke, job: Job) -> Iterator[Move]:
    return tool.cut(stroke, job)


def lines(head: Sequence[str], tool: Cutter | Laser, each: Iterable[Move]) -> Iterator[str]:
    """The lines of a program.

    Args:
        head: comments, without brackets.
        tool: what cuts.
        each: all moves.
    """
    for comment in head:
        yield f"({commented(comment)})"
    yield _STATE
    yield from _switched_on(tool)
    writer = _Writer()
    for move in each:
        line = writer.line(move)
        if line:
            yield line
    if isinstance(tool, Laser) or tool.spindle_rev_min:
        yield "M5"
    yield "M2"


def _switched_on(tool: Cutter | Laser) -> Iterator[str]:
    if isinstance(tool, Laser):
        yield f"S0 {'M4' if tool.dynamic else 'M3'}"
    elif tool.spindle_rev_min:
        yield f"S{_number(tool.spindle_rev_min)} M3"


def described(name: str, tool: Cutter | Laser, job: Job, sheet: Sheet) -> list[str]:
    """What stands at the head of a program."""
    width, height = sheet.size
    what = [job.way]
    if job.way == "sweep":
        what.append(f"angle {job.angle_deg:g}")
    if job.way != "outline":
        what.append(f"distance {job.distance_mm:g}")
    if job.way == "bitmap":
        what.append(job.grey)
    if isinstance(tool, Cutter):
        passes = len(tool.depths_mm)
        how = (
            f"cutter: depth {tool.depth_mm:g} mm in {passes} {'pass' if passes == 1 else 'passes'},"
            f" feed {tool.feed_mm_min:g}, plunge {tool.plunge_mm_min:g},"
            f" safe height {tool.safe_mm:g}"
        )
        zero = "Z0 is the surface of the work"
    else:
        how = f"laser: S{_number(tool.power)}, feed {tool.feed_mm_min:g}"
        zero = "Z stays where it is"
    where = {
        "corner": "X0 Y0 is the lower left corner",
        "centre": "X0 Y0 is the centre",
        "file": "X0 Y0 is the zero of the file",
    }[job.origin]
    return [
        f"from {name}: {', '.join(what)}; {width:.3f} x {height:.3f} mm",
        how,
        f"{where}; {zero}",
    ]


def commented(text: str) -> str:
    """Foreign text, fit for a comment."""
    kept = "".join(c if c.isascii() and c.isprintable() else "?" for c in text)
    return kept.translate(str.maketrans("()", "[]"))[:200]


class _Writer:
    """Knows which words are in force."""

    def __init__(self) -> None:
        self._kind = ""
        self._words = {"X": "", "Y": "", "Z": "", "F": "", "S": "0"}
        self._at = (0.0, 0.0)

    def line(self, move: Move) -> str:
        """A move as a line; empty: it changes nothing."""
        is_arc = move.centre is not None
        words = [] if move.kind == self._kind else [move.kind]
        moved = False
        for letter, value in (("X", move.x), ("Y", move.y), ("Z", move.z)):
            if value is None:
                continue
            text = _number(value)
            if text != self._words[letter] or (is_arc and letter != "Z"):
                self._words[letter] = text
                words.append(letter + text)
                moved = True
        if move.centre is not None:
            words += [
                f"{letter}{_number(centre - float(self._at[n]), 4)}"
                for n, (letter, centre) in enumerate(zip("IJ", move.centre, strict=True))
            ]
        changed = self._changed(move)
        if not moved and not changed:
            return ""
        if not moved:
            # A power alone: nothing moves.
            return " ".join(changed)
        self._kind = move.kind
        self._at = (float(self._words["X"] or 0), float(self._words["Y"] or 0))
        return " ".join(words + changed)

    def _changed(self, move: Move) -> list[str]:
        changed = []
        for letter, value in (("F", move.feed), ("S", move.power)):
            if value is not None and (text := _number(value)) != self._words[letter]:
                self._words[letter] = text
                changed.append(letter + text)
        return changed


def _number(value: float, digits: int = 3) -> str:
    """Without zeros that say nothing."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
