"""Lines that are only read, to know what they leave in force: what they cannot say is refused.

only read ............ | place | carried out
G92  G10 L20  G28.1 ^    refused: they depend on where the machine stood
G91 X5            ^      X is adrift, until an absolute word says where it is
"""

from collections.abc import Callable, Collection, Mapping
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.modal import name
from fraese.phrases import phrase

_INSTEAD: Final = phrase("begin before it, or go on with the run that was cut short")
_G10_NAMES: Final[dict[float, str]] = {10.0: "G10 L10", 11.0: "G10 L11", 20.0: "G10 L20"}


class Replay:
    """What is not known of a program that is read as far as a place.

    Args:
        axes: letters of the machine's axes.
        is_over: whether the line in hand is carried out.

    Attributes:
        adrift: axes of which nobody knows where the program has them, with the line.
    """

    def __init__(self, axes: str, is_over: Callable[[], bool]) -> None:
        self._axes = axes
        self._is_over = is_over
        self._fixed: set[str] = set()
        self.adrift: dict[str, int] = {}

    def goes(self, words: Mapping[str, float], line: int, *, absolute: bool) -> None:
        """Axis words lead somewhere."""
        if self._is_over():
            return
        given = [letter for letter in self._axes if letter in words]
        if "@" in words or "^" in words:
            given += ["x", "y"]
        if absolute:
            self.fix(given)
            return
        for letter in given:
            if letter not in self._fixed and words.get(letter, 1.0):
                self.adrift.setdefault(letter, line)

    def fix(self, letters: Collection[str]) -> None:
        """These axes are where the program says."""
        if self._is_over():
            return
        self._fixed.update(letters)
        for letter in letters:
            self.adrift.pop(letter, None)

    def refuse(self, code: int, kind: float = 0.0) -> None:
        """A code that means the place where the machine stands.

        Raises:
            ProgramError: it is only read.
        """
        if not self._is_over():
            said = _G10_NAMES.get(kind, name(code))
            raise ProgramError(
                phrase(
                    "{said} depends on where the machine stood then, and on what was in force: it"
                    " is not read again from another place; {instead}",
                    said=said,
                    instead=_INSTEAD,
                )
            )

    def require_place(self) -> None:
        """See that it is known where the program has its axes.

        Raises:
            ProgramError: it is not.
        """
        for letter, line in self.adrift.items():
            raise ProgramError(
                phrase(
                    "{letter} goes by G91 from where the machine stood at the start, and nobody"
                    " knows where that was; {instead}",
                    letter=letter.upper(),
                    instead=_INSTEAD,
                ),
                line,
            )
