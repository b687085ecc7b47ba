"""What the app expects of who knows the language; handed in by the composition root."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

from fraese.control.controller import Controller
from fraese.errors import StateError
from fraese.phrases import spoken


class HandTools(Protocol):
    """Typed lines and probing. What starts something is called in the machine's thread.

    A refusal is a ``FraeseError``; then nothing has moved.
    """

    def typed(self, controller: Controller, text: str) -> None:
        """Start lines of G-code."""

    def macro(self, controller: Controller, name: str, text: str, file: str) -> None:
        """Start lines of G-code, or (if it is named) those of a file."""

    def probe(self, controller: Controller, name: str, values: Mapping[str, float]) -> None:
        """Start a probing cycle."""

    def probe_map(self, controller: Controller, path: Path, values: Mapping[str, float]) -> None:
        """Start to probe a height map into a new file."""

    def cycles(self, axes: Sequence[str]) -> tuple[str, ...]:
        """Names of the cycles for these axes."""


class NoTools:
    """Nobody knows the language here."""

    def typed(self, controller: Controller, text: str) -> None:
        """Refused."""
        raise StateError(spoken("This app was started without the language: no line can be typed."))

    def macro(self, controller: Controller, name: str, text: str, file: str) -> None:
        """Refused."""
        self.typed(controller, text)

    def probe(self, controller: Controller, name: str, values: Mapping[str, float]) -> None:
        """Refused."""
        raise StateError(spoken("This app was started without the language: it cannot probe."))

    def probe_map(self, controller: Controller, path: Path, values: Mapping[str, float]) -> None:
        """Refused."""
        self.probe(controller, "", values)

    def cycles(self, axes: Sequence[str]) -> tuple[str, ...]:
        """None."""
        return ()
