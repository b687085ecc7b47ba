"""Numbered and named parameters.

Numbered 1 to 5601: 1 to 30 belong to the running subroutine, the rest to the program; some
are answers of the machine and can only be read. Named ``#<local>`` belong to the running
subroutine, ``#<_global>`` to the program; some global names are answers as well.
"""

from collections.abc import Callable, Mapping
from typing import Final

from fraese.errors import ProgramError
from fraese.phrases import phrase
from fraese.workframe import PERSISTENT, TOOLS

MAX_INDEX: Final = 5601
ARGUMENTS: Final = 30
READ_ONLY: Final = frozenset(range(5400, 5429))

Live = Callable[[], float]


class Parameters:
    """The store; ``numbered`` may be read freely, writing goes through the methods.

    Attributes:
        changes: counts what was written to the persistent ones.
    """

    def __init__(self, initial: Mapping[int, float] | None = None) -> None:
        self.numbered: dict[int, float] = dict(initial or {})
        self.changes = 0
        self.live: dict[int, Live] = {}
        self.live_names: dict[str, Live] = {}
        self._globals: dict[str, float] = {}
        self._locals: dict[str, float] = {}

    def persistent(self) -> dict[int, float]:
        """What outlives the program, lengths in mm."""
        numbered = self.numbered
        own = {index: numbered[index] for index in PERSISTENT if index in numbered}
        return own | {index: value for index, value in numbered.items() if index >= TOOLS}

    def take_up(self, kept: Mapping[int, float]) -> None:
        """Let what outlives the program be this."""
        for index in self.persistent():
            del self.numbered[index]
        self.numbered |= kept

    def get(self, index: int) -> float:
        """Value of ``#index``; never set means 0.

        Raises:
            ProgramError: the number is out of range.
        """
        if not 1 <= index <= MAX_INDEX:
            raise ProgramError(
                phrase(
                    "#{index} is not a parameter: numbers go from 1 to {max_index}",
                    index=index,
                    max_index=MAX_INDEX,
                )
            )
        answer = self.live.get(index)
        return self.numbered.get(index, 0.0) if answer is None else answer()

    def set(self, index: int, value: float) -> None:
        """Set ``#index``.

        Raises:
            ProgramError: the number is out of range or can only be read.
        """
        if not 1 <= index <= MAX_INDEX:
            raise ProgramError(
                phrase(
                    "#{index} is not a parameter: numbers go from 1 to {max_index}",
                    index=index,
                    max_index=MAX_INDEX,
                )
            )
        if index in READ_ONLY:
            raise ProgramError(phrase("#{index} can only be read", index=index))
        self.numbered[index] = value
        if index >= PERSISTENT[0]:
            self.changes += 1

    def keep(self, index: int, value: float) -> None:
        """What is in force and outlives the program, under a number that the program only reads."""
        self.numbered[index] = value
        self.changes += 1

    def find(self, name: str) -> float | None:
        """Value of ``#<name>``, or None where it has not been set."""
        answer = self.live_names.get(name)
        if answer is not None:
            return answer()
        return self._scope(name).get(name)

    def set_name(self, name: str, value: float) -> None:
        """Set ``#<name>``.

        Raises:
            ProgramError: the name can only be read.
        """
        if name in self.live_names:
            raise ProgramError(phrase("#<{name}> can only be read", name=name))
        self._scope(name)[name] = value

    def _scope(self, name: str) -> dict[str, float]:
        return self._globals if name.startswith("_") else self._locals

    def enter(self, arguments: list[float]) -> "Scope":
        """Start a subroutine with its own #1 to #30 and its own names; returns the old ones."""
        numbered = self.numbered
        saved = [numbered.get(index, 0.0) for index in range(1, ARGUMENTS + 1)]
        for index in range(ARGUMENTS):
            numbered[index + 1] = arguments[index] if index < len(arguments) else 0.0
        scope = Scope(saved, self._locals)
        self._locals = {}
        return scope

    def enter_names(self) -> "Scope":
        """Start a subprogram: it has its own names, but its caller's #1 to #30."""
        scope = Scope([], self._locals)
        self._locals = {}
        return scope

    def leave(self, scope: "Scope") -> None:
        """Back to what ``enter`` or ``enter_names`` returned."""
        for index, value in enumerate(scope.arguments, start=1):
            self.numbered[index] = value
        self._locals = scope.names


class Scope:
    """What a subroutine hides while it runs."""

    __slots__ = ("arguments", "names")

    def __init__(self, arguments: list[float], names: dict[str, float]) -> None:
        self.arguments = arguments
        self.names = names
