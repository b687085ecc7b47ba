"""Height maps as files: readable JSON, a row of the grid in a line.

Rule 1: whoever reads a file believes nothing: what is missing, unknown, no number or out of order
        is refused with one sentence that names the key, and the row and column of a height.
Rule 2: a map that is not probed to its end has ``null`` where heights are missing. It is kept, to
        be gone on with, and never used.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fraese.errors import ProgramError
from fraese.heightmap.heights import Flat, HeightMap
from fraese.phrases import Phrase, phrase
from fraese.workframe import SYSTEMS

FORMAT: Final = "fraese height map"
VERSION: Final = 1
#: Probing more would take days.
MOST_POINTS: Final = 100_000
#: No file is larger.
MOST_BYTES: Final = 4 << 20
_FURTHEST_MM: Final = 100_000

_POINTS: Final = ("reference_mm", "origin_mm")

_Place = Annotated[float, Field(strict=True, ge=-_FURTHEST_MM, le=_FURTHEST_MM)]
_Lines = Annotated[list[_Place], Field(min_length=2, max_length=MOST_POINTS)]


class _File(BaseModel):
    """What stands in a file."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, defer_build=True)

    format: Literal["fraese height map"]
    version: Literal[1]
    system: Literal[SYSTEMS] = "G54"  # type: ignore[valid-type]
    reference_mm: tuple[_Place, _Place] = (0.0, 0.0)
    origin_mm: tuple[_Place, _Place] | None = None
    x_mm: _Lines
    y_mm: _Lines
    heights_mm: list[list[_Place | None]]


@dataclass(frozen=True)
class PartMap:
    """A map as far as it is probed.

    Attributes:
        x_mm: as of a ``HeightMap``, and so are the others.
        y_mm: likewise.
        heights_mm: row by row; None: not probed yet.
        reference_mm: likewise.
        system: likewise.
        origin_mm: likewise.
    """

    x_mm: tuple[float, ...]
    y_mm: tuple[float, ...]
    heights_mm: tuple[tuple[float | None, ...], ...]
    reference_mm: Flat = (0.0, 0.0)
    system: int = 1
    origin_mm: Flat | None = None

    @property
    def missing(self) -> int:
        """So many points are not probed."""
        return sum(row.count(None) for row in self.heights_mm)

    @property
    def points(self) -> int:
        """So many it has."""
        return len(self.x_mm) * len(self.y_mm)

    def whole(self) -> HeightMap:
        """The map, when nothing is missing.

        Raises:
            ValueError: something is.
        """
        rows = tuple(tuple(each for each in row if each is not None) for row in self.heights_mm)
        if self.missing:
            raise ValueError("heights are missing")
        return HeightMap(self.x_mm, self.y_mm, rows, self.reference_mm, self.system, self.origin_mm)


def encoded(part: PartMap) -> str:
    """The text of a file."""
    rows = ",\n".join("    " + _in_a_row(row) for row in part.heights_mm)
    head = {
        "format": FORMAT,
        "version": VERSION,
        "system": SYSTEMS[part.system - 1],
        "reference_mm": list(part.reference_mm),
        "origin_mm": part.origin_mm and list(part.origin_mm),
        "x_mm": list(part.x_mm),
        "y_mm": list(part.y_mm),
    }
    lines = "".join(f'  "{key}": {json.dumps(value)},\n' for key, value in head.items())
    return f'{{\n{lines}  "heights_mm": [\n{rows}\n  ]\n}}\n'


def _in_a_row(heights: Sequence[float | None]) -> str:
    return json.dumps(list(heights))


def decoded(text: str, file: str) -> PartMap:
    """What a file holds.

    Args:
        text: of it.
        file: its name in messages.

    Raises:
        ProgramError: it is no height map; with the line, or the key.
    """
    try:
        found = json.loads(text, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        said = phrase("is no height map: a file of JSON has no such thing here")
        raise ProgramError(said, error.lineno, file) from error
    except (ValueError, RecursionError) as error:
        raise ProgramError(
            phrase("is no height map: a height is a number or null."), file=file
        ) from error
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise ProgramError(
            phrase('is no height map: it would begin with "format": "{format}".', format=FORMAT),
            file=file,
        )
    if found.get("version") != VERSION:
        raise ProgramError(
            phrase(
                "version is {found}: this program knows version {version}.",
                found=json.dumps(found.get("version"))[:20],
                version=VERSION,
            ),
            file=file,
        )
    try:
        read = _File.model_validate(found)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        raise ProgramError(_said(first["type"], first["loc"], first["msg"]), file=file) from error
    wrong = _out_of_shape(read)
    if wrong:
        raise ProgramError(wrong, file=file)
    return PartMap(
        tuple(read.x_mm),
        tuple(read.y_mm),
        tuple(tuple(row) for row in read.heights_mm),
        read.reference_mm,
        SYSTEMS.index(read.system) + 1,
        read.origin_mm,
    )


def _no_number(word: str) -> Any:
    raise ValueError(word)


def _said(kind: str, place: tuple[int | str, ...], reason: str) -> Phrase:
    """What is wrong with one value."""
    key = str(place[0]) if place else ""
    if key in _POINTS:
        return phrase("{key} is a point: two numbers of mm, X and Y.", key=key)
    if kind == "missing":
        return phrase("{key} is missing.", key=key)
    if kind == "extra_forbidden":
        keys = ", ".join(_File.model_fields)
        return phrase('there is no key "{key}"; there are {keys}.', key=key[:60], keys=keys)
    numbers = [n + 1 for n in place[1:] if isinstance(n, int)]
    if key == "heights_mm" and len(numbers) > 1:
        row, column = numbers[:2]
        return phrase(
            "heights_mm, row {row}, column {column}: a height is a number of mm, or null.",
            row=row,
            column=column,
        )
    if key in ("x_mm", "y_mm") and numbers:
        return phrase("{key}, number {n}: a place is a number of mm.", key=key, n=numbers[0])
    return phrase("{key} is not as it should be ({reason}).", key=key, reason=reason[:100])


def _out_of_shape(read: _File) -> str:
    """What does not fit together, a sentence; empty: all does."""
    for key, places in (("x_mm", read.x_mm), ("y_mm", read.y_mm)):
        for before, after in pairwise(places):
            if before >= after:
                return phrase(
                    "{key} goes up from number to number, and not from {before:g} to {after:g}.",
                    key=key,
                    before=before,
                    after=after,
                )
    if len(read.heights_mm) != len(read.y_mm):
        return phrase(
            "heights_mm has {rows} rows, and y_mm {count} numbers: there is a row for each.",
            rows=len(read.heights_mm),
            count=len(read.y_mm),
        )
    for number, row in enumerate(read.heights_mm, start=1):
        if len(row) != len(read.x_mm):
            return phrase(
                "heights_mm, row {row} has {columns} heights, and x_mm {count} numbers: there is"
                " a height for each.",
                row=number,
                columns=len(row),
                count=len(read.x_mm),
            )
    return ""
