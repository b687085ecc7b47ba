"""A stretch drawn with characters, one row a line, and its figures in tables.

    pin02_x_direction ▁▁▁│▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔│▁▁▁▁▁▁▁
    pin03_x_clock     ▁▁▁▁│▔│▁│▔│▁▒▒▒▒▒▒▒▒▒▒│▁▁▁▁▁▁▁▁▁▁
                      |         |         |
                      0 s       1 ms      2 ms

Rule 1: ▒ is a column with more edges than can be seen there; a shorter stretch shows them.
Rule 2: no row is longer than the width.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from fraese.phrases import phrase, spoken
from fraese.phrases import shown as read
from fraese.waves import times
from fraese.waves.figures import LineFigures, QuantityFigures, Shortest
from fraese.waves.stretch import Seen, Stretch

_TICK_COLUMNS: Final = 13


class Glyphs(NamedTuple):
    """Characters of a row: low, high, one edge, many, not known, and levels of a number."""

    low: str
    high: str
    edge: str
    many: str
    unknown: str
    levels: str


FINE: Final = Glyphs("▁", "▔", "│", "▒", "?", "▁▂▃▄▅▆▇█")
PLAIN: Final = Glyphs("_", "-", "|", "#", "?", "_.:-=+*#")


class Row(NamedTuple):
    """A drawn line: its name, and its columns."""

    name: str
    drawn: str


def label_width(names: Sequence[str], width: int) -> int:
    """Columns for the names, so that most of the width is left for what is drawn."""
    return min(max((len(name) for name in names), default=0), width // 3)


def row(seen: Seen, glyphs: Glyphs, label: int) -> Row:
    """A line as a row."""
    draw = _numbers if isinstance(seen.figures, QuantityFigures) else _bits
    return Row(shortened(seen.line.name, label), draw(seen, glyphs))


def shortened(name: str, most: int) -> str:
    """A name with so many characters; its end says most."""
    return name.ljust(most) if len(name) <= most else "~" + name[-(most - 1) :]


def _bits(seen: Seen, glyphs: Glyphs) -> str:
    def one(edges: int, end: float) -> str:
        if edges > 1:
            return glyphs.many
        if edges:
            return glyphs.edge
        if math.isnan(end):
            return glyphs.unknown
        return glyphs.high if end else glyphs.low

    columns = seen.columns
    return "".join(map(one, columns.edges.tolist(), columns.ends.tolist()))


def _numbers(seen: Seen, glyphs: Glyphs) -> str:
    figures = seen.figures
    assert isinstance(figures, QuantityFigures)
    span = figures.most - figures.least

    def one(value: float) -> str:
        if math.isnan(value):
            return glyphs.unknown
        part = (value - figures.least) / span if span else 0.0
        return glyphs.levels[min(len(glyphs.levels) - 1, int(part * len(glyphs.levels)))]

    return "".join(map(one, seen.columns.ends.tolist()))


def axis(stretch: Stretch) -> tuple[str, str]:
    """Marks, and the moments that they mean."""
    width, begin_s = stretch.width, stretch.start * stretch.file.unit_s
    tick_s = times.tick_s(stretch.span_s, width // _TICK_COLUMNS)
    marks, words = [" "] * width, [" "] * (width + 2 * _TICK_COLUMNS)
    number = math.ceil(begin_s / tick_s - 1e-9)
    while (place := round((number * tick_s - begin_s) / stretch.span_s * width)) < width:
        marks[place] = "|"
        word = times.tick_word(number, tick_s, stretch.end * stretch.file.unit_s)
        if place + len(word) <= width:
            words[place : place + len(word)] = word
        number += 1
    return "".join(marks).rstrip(), "".join(words)[:width].rstrip()


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading, and its word for a line."""

    heading: str
    word: Callable[[LineFigures, float], str]


def _moment(moment: int | None, unit_s: float) -> str:
    return times.moment(None if moment is None else moment * unit_s)


def _shortest(shortest: Shortest, unit_s: float) -> str:
    return times.length(None if shortest.length is None else shortest.length * unit_s)


def _begin(shortest: Shortest, unit_s: float) -> str:
    return _moment(None if shortest.length is None else shortest.at, unit_s)


def fastest_hz(figures: LineFigures, unit_s: float) -> float | None:
    """The rate of the shortest period; None: there is none, or it is too short for the file."""
    length = figures.period.length
    return 1 / (length * unit_s) if length else None


def mean_hz(figures: LineFigures, unit_s: float) -> float | None:
    """The mean rate; None: there are less than two rises."""
    return None if figures.rate is None else figures.rate / unit_s


COLUMNS: Final = (
    Column(phrase("edges"), lambda f, _: str(f.edges)),
    Column(phrase("rate"), lambda f, u: times.rate(mean_hz(f, u))),
    Column(phrase("fastest"), lambda f, u: times.rate(fastest_hz(f, u))),
    Column(phrase("duty"), lambda f, _: "-" if f.duty is None else f"{100 * f.duty:.4g} %"),
    Column(phrase("least high"), lambda f, u: _shortest(f.high, u)),
    Column(phrase("least low"), lambda f, u: _shortest(f.low, u)),
    Column(phrase("first edge"), lambda f, u: _moment(f.first_edge, u)),
    Column(phrase("last edge"), lambda f, u: _moment(f.last_edge, u)),
    Column(phrase("least high at"), lambda f, u: _begin(f.high, u)),
    Column(phrase("least low at"), lambda f, u: _begin(f.low, u)),
)


def tables(stretch: Stretch, shown: Sequence[Seen], label: int, width: int) -> list[str]:
    """Figures of the lines that change, in as many tables as the width makes necessary."""
    unit_s = stretch.file.unit_s
    lines = [(seen.line.name, seen.figures) for seen in shown]
    bits = [(name, f) for name, f in lines if isinstance(f, LineFigures) and f.edges]
    drawn: list[str] = []
    parts = (
        [[read(c.heading), *(c.word(f, unit_s) for _, f in bits)] for c in COLUMNS] if bits else []
    )
    names = [shortened(name, label) for name in ("", *(name for name, _ in bits))]
    while parts:
        rows, parts = _table(names, parts, width)
        drawn += [*([""] if drawn else []), *rows]
    drawn += _quantities(lines, label)
    return drawn


def _table(
    names: list[str], parts: list[list[str]], width: int
) -> tuple[list[str], list[list[str]]]:
    """As many columns as fit, at least one; and those that are left."""
    rows = list(names)
    for place, words in enumerate(parts):
        longest = max(map(len, words))
        if place and len(rows[0]) + 2 + longest > width:
            return rows, parts[place:]
        rows = [f"{row}  {word:>{longest}}" for row, word in zip(rows, words, strict=True)]
    return rows, []


def _quantities(
    lines: Sequence[tuple[str, LineFigures | QuantityFigures]], label: int
) -> list[str]:
    return [
        spoken(
            "{name}  {least:g} to {most:g}, {changes} changes",
            name=shortened(name, label),
            least=f.least,
            most=f.most,
            changes=f.changes,
        )
        for name, f in lines
        if isinstance(f, QuantityFigures) and f.changes
    ]


def set_ups(stretch: Stretch, shown: Sequence[Seen], label: int, width: int) -> list[str]:
    """A table of the directions among these lines that change."""
    unit_s, lines = stretch.file.unit_s, stretch.file.lines
    names = [seen.line.name for seen in shown]
    found = [s for s in stretch.set_ups if s.shortest.count and lines[s.direction].name in names]
    if not found:
        return []
    parts = [
        [spoken("set-up"), *(_shortest(s.shortest, unit_s) for s in found)],
        [spoken("of"), *(str(s.shortest.count) for s in found)],
        [spoken("at"), *(_begin(s.shortest, unit_s) for s in found)],
        ["to", *(lines[s.clock].name for s in found)],
    ]
    heads = ["", *(lines[s.direction].name for s in found)]
    rows, _ = _table([shortened(name, label) for name in heads], parts, width)
    return ["", *rows]


def still(stretch: Stretch, shown: Sequence[Seen]) -> list[str]:
    """Lines that never change, by their level."""
    words = {True: spoken("high"), False: spoken("low")}
    found: dict[str, list[str]] = {}
    for seen in shown:
        level = seen.columns.level
        if not isinstance(seen.figures, LineFigures):
            word = f"{level:g}"
        else:
            word = spoken("not known") if math.isnan(level) else words[bool(level)]
        if seen.is_still:
            found.setdefault(word, []).append(seen.line.name)
    return [
        spoken("{word} throughout: {names}", word=word, names=", ".join(names))
        for word, names in sorted(found.items())
    ]


def is_dense(drawn: Sequence[Seen]) -> bool:
    """Somewhere are more edges than can be seen."""
    return any((seen.columns.edges > 1).any() for seen in drawn)
