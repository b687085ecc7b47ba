"""The machine's axes as the language sees them: their letters, units and planes.

Rule 1: points are tuples in machine order; letters are found in them here.
Rule 2: G20 scales lengths; the degrees of a rotary axis are degrees always.
Rule 3: which axes a feed is along, ``feedway`` says. Where only rotary axes move in the group that
        counts, it is in degrees a minute.
"""

from collections.abc import Mapping
from operator import sub
from typing import Final, NamedTuple

from fraese.errors import ProgramError
from fraese.feedway import NO_WAY, counted, groups_of, length_of
from fraese.phrases import phrase
from fraese.workframe import LETTERS, Point

#: First and second axis of a plane, in right-handed order, and the third, about which it turns.
_PLANES: Final = {17: "xyz", 18: "zxy", 19: "yzx"}
#: Units of length in which a program may be, in mm.
UNITS_MM: Final = (1.0, 25.4)


class Plane(NamedTuple):
    """The axes of a plane, by their places."""

    first: int
    second: int
    third: int | None


class Way(NamedTuple):
    """What a feed counts along: a length, in mm or degrees, and whether G20 scales it."""

    length: float
    is_angle: bool


class Axes:
    """The axes of one machine.

    Args:
        letters: in machine order.
        rotary: which of them are in degrees.

    Attributes:
        letters: likewise.
        units: by unit of the program, for each letter its place and its unit.
        scales: by unit of the program, that of every axis.
        only_linear: no axis is rotary.
        reached: where absolute words lead from a point: point, words, unit of the program.
    """

    def __init__(self, letters: str, rotary: str) -> None:
        self.letters = letters
        self.only_linear = set(rotary).isdisjoint(letters)
        self.scales = {
            unit_mm: tuple(1.0 if letter in rotary else unit_mm for letter in letters)
            for unit_mm in UNITS_MM
        }
        self.units: Mapping[float, Mapping[str, tuple[int, float]]] = {
            unit_mm: {letter: (at, scales[at]) for at, letter in enumerate(letters)}
            for unit_mm, scales in self.scales.items()
        }
        self._in_order = {
            unit_mm: tuple(zip(letters, scales, strict=True))
            for unit_mm, scales in self.scales.items()
        }
        self._each = tuple(letters)
        # Plain lines of three axes are what there is most of.
        self.reached = self._reached_by_three if len(letters) == 3 else self._reached
        self._groups = groups_of(letters)
        self._rotary = tuple(letter in rotary for letter in letters)

    def _reached(self, at: Point, words: Mapping[str, float], unit_mm: float) -> Point:
        get = words.get
        return tuple(
            [
                old if (word := get(letter)) is None else word * scale
                for (letter, scale), old in zip(self._in_order[unit_mm], at, strict=True)
            ]
        )

    def _reached_by_three(self, at: Point, words: Mapping[str, float], unit_mm: float) -> Point:
        first, second, third = at
        one, two, three = self._each
        scale, scale_2, scale_3 = self.scales[unit_mm]
        if one in words:
            first = words[one] * scale
        if two in words:
            second = words[two] * scale_2
        if three in words:
            third = words[three] * scale_3
        return first, second, third

    def in_words(self) -> str:
        """All letters, for people: X, Y and Z."""
        most, last = ", ".join(self.letters[:-1].upper()), self.letters[-1].upper()
        return phrase("{others} and {last}", others=most, last=last) if most else last

    def require(self, letter: str) -> None:
        """See that the machine has an axis.

        Raises:
            ProgramError: if it has not.
        """
        if letter not in self.letters:
            raise ProgramError(
                phrase(
                    "there is no axis {letter} on this machine; it has {in_words}",
                    letter=letter.upper(),
                    in_words=self.in_words(),
                )
            )

    def plane(self, code: int, user: str) -> Plane:
        """The axes of a plane.

        Args:
            code: 17, 18 or 19.
            user: what needs them, for people.

        Raises:
            ProgramError: the machine has not both that it is made of.
        """
        first, second = plane_letters(code)
        for letter in (first, second):
            if letter not in self.letters:
                raise ProgramError(
                    phrase(
                        "{user} in plane G{code} needs axis {letter}, and this machine has"
                        " only {in_words}",
                        user=user,
                        code=code,
                        letter=letter.upper(),
                        in_words=self.in_words(),
                    )
                )
        place = self.letters.index
        third = third_letter(code)
        height = place(third) if third in self.letters else None
        return Plane(place(first), place(second), height)

    def third(self, code: int, user: str) -> int:
        """The axis along which a canned cycle works.

        Raises:
            ProgramError: the machine has none there.
        """
        letter = third_letter(code)
        if letter not in self.letters:
            raise ProgramError(
                phrase(
                    "{user} in plane G{code} works along axis {letter}, and this machine has"
                    " only {in_words}",
                    user=user,
                    code=code,
                    letter=letter.upper(),
                    in_words=self.in_words(),
                )
            )
        return self.letters.index(letter)

    def way(self, start: Point, end: Point) -> Way:
        """What the feed of a straight move counts along."""
        by = tuple(map(sub, end, start))
        group, length = counted(self._groups, by)
        if self.only_linear:
            return Way(length, False)
        straight = tuple(at for at in group if not self._rotary[at])
        return Way(length, bool(group) and length_of(straight, by) <= NO_WAY)


def third_letter(code: int) -> str:
    """The letter of the axis about which a plane turns."""
    return _PLANES[code][2]


def plane_letters(code: int) -> tuple[str, str]:
    """The letters of the axes that a plane is made of."""
    return _PLANES[code][0], _PLANES[code][1]


#: Letters that may be axes somewhere.
ALL: Final = frozenset(LETTERS)
