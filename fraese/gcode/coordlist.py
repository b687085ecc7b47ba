"""Plain lists of coordinates: one point a line, driven to in straight lines.

    # unit: mm            a comment; "unit:" followed by mm or inch sets the unit
    x;y;z;feed            optional: names of the columns, in any order
    0;0;5;600
    10,5;0;;              decimal comma where the separator is no comma; an empty cell
                          leaves that axis, or the feed, as it was

The separator is found in the first line with columns and then holds for the file: semicolon,
comma, or blanks. Without a header the columns are the machine's axes and feed: x, y, z, feed.
Coordinates count in the active work offset, feeds are in units per minute; a rotary axis is in
degrees, whatever the unit.
"""

import re
from collections.abc import Iterable, Iterator
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.axes import ALL, Axes
from fraese.gcode.canon import End, Feed, Move
from fraese.gcode.expressions import MAX_VALUE
from fraese.gcode.setup import Setup
from fraese.gcode.text import MAX_LINE
from fraese.phrases import phrase
from fraese.workframe import LETTERS, Point, WorkFrame

UNITS_MM: Final = {"mm": 1.0, "millimetre": 1.0, "millimeter": 1.0, "inch": 25.4, "in": 25.4}
_UNIT = re.compile(r"\bunits?\s*[:=]\s*([a-z]+)", re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?")
_COLUMN: Final = f"(?:[{LETTERS}f]|feed)"
_HEADER = re.compile(rf"{_COLUMN}(?:[;,\s]+{_COLUMN})*[;,\s]*", re.IGNORECASE)
_IN_POINTS: Final = frozenset("+-0123456789.,;eE \t")


def looks_like_points(lines: Iterable[str]) -> bool:
    """Whether the first line that says anything is a point or a header of columns.

    A line that starts with a semicolon says nothing: it is a remark in G-code.
    """
    for text in lines:
        line = text.strip().removeprefix("\ufeff")
        if (
            not line
            or line.startswith(";")
            or (line.startswith("#") and "=" not in _UNIT.sub("", line))
        ):
            continue
        return _is_header(line) or (_IN_POINTS.issuperset(line) and any(map(str.isdigit, line)))
    return False


def read_points(
    lines: Iterable[str],
    setup: Setup | None = None,
    unit: str = "mm",
    feed_mm_min: float = 0.0,
) -> Iterator[Move]:
    """Yield a straight move for every point, and an end.

    Args:
        lines: the lines of the list.
        setup: start position and work offsets.
        unit: unit of the file where it does not say its own, "mm" or "inch".
        feed_mm_min: feed where the file gives none; 0 for none.

    Raises:
        ProgramError: a line is no point, or there is no feed.
    """
    setup = setup or Setup()
    reader = _Reader(setup, unit, feed_mm_min)
    number = 0
    try:
        for number, text in enumerate(lines, start=1):
            yield from reader.line(number, text)
    except ProgramError as error:
        if error.line:
            raise
        raise ProgramError(error.message, number, setup.file) from error
    yield End(max(number, 1))


class _Reader:
    """What holds from line to line."""

    def __init__(self, setup: Setup, unit: str, feed_mm_min: float) -> None:
        self._axes = Axes(setup.axes, setup.rotary)
        self._frame = WorkFrame.of(setup.parameters, setup.axes)
        here = setup.position_mm or (0.0,) * len(setup.axes)
        self._at: Point = self._frame.to_work(here)
        self._unit_mm = _unit_mm(unit)
        self._feed = feed_mm_min
        self._feed_unit_mm = 1.0
        self._columns: tuple[str, ...] = (*setup.axes, "feed")
        self._separator: str | None = None

    def line(self, number: int, text: str) -> Iterator[Move]:
        if len(text) > MAX_LINE:
            raise ProgramError(
                phrase("the line is longer than {max_line} characters", max_line=MAX_LINE)
            )
        data, _, comment = text.removeprefix("\ufeff").partition("#")
        if unit := _UNIT.search(comment):
            self._unit_mm = _unit_mm(unit.group(1))
        data = data.strip()
        if not data:
            return
        if self._separator is None:
            self._separator = _separator(data)
        if _is_header(data):
            self._columns = self._header(data)
            return
        before = self._at
        self._take(data)
        if self._feed <= 0:
            raise ProgramError(
                phrase("there is no feed: add a feed column, or give a feed for the file")
            )
        is_angle = self._axes.way(before, self._at).is_angle
        feed = self._feed * (1.0 if is_angle else self._feed_unit_mm)
        yield Feed(number, self._frame.to_machine(self._at), feed)

    def _cells(self, data: str) -> list[str]:
        if self._separator == " ":
            return data.split()
        return [cell.strip() for cell in data.split(self._separator)]

    def _header(self, data: str) -> tuple[str, ...]:
        said = [cell.lower() for cell in self._cells(data) if cell]
        names = tuple("feed" if name == "f" else name for name in said)
        for name in ALL.intersection(names):
            self._axes.require(name)
        if len(set(names)) != len(names):
            columns = ", ".join(self._axes.letters)
            raise ProgramError(
                phrase(
                    "the header has to name columns out of {columns} and feed, each once",
                    columns=columns,
                )
            )
        return names

    def _take(self, data: str) -> None:
        cells = self._cells(data)
        while cells and not cells[-1]:
            cells.pop()
        if len(cells) > len(self._columns):
            said = ", ".join(self._columns)
            raise ProgramError(
                phrase(
                    "{count} values stand where {said} are expected", count=len(cells), said=said
                )
            )
        values = {
            name: self._number(cell)
            for name, cell in zip(self._columns, cells, strict=False)
            if cell
        }
        self._at = self._axes.reached(self._at, values, self._unit_mm)
        if "feed" in values:
            self._feed, self._feed_unit_mm = values["feed"], self._unit_mm

    def _number(self, cell: str) -> float:
        text = cell if self._separator == "," else cell.replace(",", ".")
        value = float(text) if _NUMBER.fullmatch(text) else MAX_VALUE * 10
        if not abs(value) <= MAX_VALUE:
            raise ProgramError(phrase("{cell} is not a number", cell=repr(cell[:40])))
        return value


def _unit_mm(unit: str) -> float:
    if unit.lower() not in UNITS_MM:
        raise ProgramError(
            phrase("the unit {unit} is unknown; it is mm or inch", unit=repr(unit[:20]))
        )
    return UNITS_MM[unit.lower()]


def _is_header(line: str) -> bool:
    return _HEADER.fullmatch(line) is not None


def _separator(line: str) -> str:
    """Semicolon if there is one; a comma that stands before a blank, or where there is none."""
    if ";" in line:
        return ";"
    commas = "," in line and (re.search(r",\s", line) or not re.search(r"\s", line))
    return "," if commas else " "
