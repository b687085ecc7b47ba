"""What the app expects of a program; the reader of files is handed in by the composition root."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from fraese.control.controller import Controller


class Facts(Protocol):
    """What is known of a program before it runs."""

    @property
    def low_mm(self) -> tuple[float, ...] | None:
        """Lowest machine position of every axis; None: nothing moves."""

    @property
    def high_mm(self) -> tuple[float, ...] | None:
        """Highest machine position of every axis; likewise."""

    @property
    def duration_s(self) -> float:
        """Planned machine time."""

    @property
    def length_mm(self) -> float:
        """Length of the path."""

    @property
    def blocks(self) -> int:
        """Number of blocks."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the operator should know; a sentence each."""


class Program(Protocol):
    """A program that has been read."""

    @property
    def name(self) -> str:
        """For people."""

    @property
    def lines(self) -> Sequence[str]:
        """Its text."""

    def check(self, controller: Controller) -> Facts:
        """See whether it can run from here; in the machine's thread.

        Raises:
            FraeseError: if it cannot.
        """

    def start(self, controller: Controller) -> None:
        """Hand it to the controller; in the machine's thread.

        Raises:
            FraeseError: if it is refused.
        """


OpenProgram = Callable[[Path], Program]


def in_words(facts: Facts) -> str:
    """Length and duration of a program."""
    minutes, seconds = divmod(round(facts.duration_s), 60)
    return f"{facts.blocks} blocks, {facts.length_mm:.1f} mm, {minutes}:{seconds:02d} min"
