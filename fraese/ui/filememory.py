"""What is remembered of files: which were opened last, and which height map one is bent to."""

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol


class Recent(Protocol):
    """Files that were opened."""

    def paths(self) -> Sequence[Path]:
        """Newest first."""

    def add(self, path: Path) -> None:
        """This one was opened just now."""


class Forgets:
    """Of an app that keeps no list."""

    def paths(self) -> Sequence[Path]:
        """None."""
        return ()

    def add(self, path: Path) -> None:
        """Nothing is kept."""


class MapMemory:
    """The height map that was chosen last, and for which file: that is bent to it again."""

    def __init__(self) -> None:
        self._file: Path | None = None
        self._map: Path | None = None

    def remember(self, file: Path | None, heights: Path | None) -> None:
        """This file is bent to this map from now on, or to none."""
        self._file, self._map = file, heights

    def of(self, file: Path | None) -> Path | None:
        """The map of this file; None: it has none."""
        return self._map if file is not None and file == self._file else None
