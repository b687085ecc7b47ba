"""What a row of the tables says."""

from pathlib import Path
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).resolve().parents[2]


class Mutant(NamedTuple):
    """A fault in one line.

    Attributes:
        name: room and line, unique.
        harm: what would come of it.
        file: below the root of the tree.
        old: text that stands in it exactly once,
        new: and what stands there instead.
        tests: what must see it, as pytest is told; several words of a ``-k`` are joined by "or".
        limit_s: longer than this the tests take only if the fault hangs them.
    """

    name: str
    harm: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    limit_s: float = 180.0

    def applied_to(self, text: str) -> str:
        """The file with the fault.

        Raises:
            ValueError: if the row does not fit it.
        """
        found = text.count(self.old)
        if found != 1:
            raise ValueError(f"{self.name}: {self.old!r} is {found} times in {self.file}, not once")
        return text.replace(self.old, self.new)


def tests_of(file: str, *names: str) -> tuple[str, ...]:
    """Tests of one file, as pytest is told."""
    return tuple(f"tests/{file}::{name}" for name in names)
