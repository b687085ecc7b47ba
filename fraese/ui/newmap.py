"""Where the next height map is written: beside the program, under a name that is free."""

from itertools import count
from pathlib import Path
from typing import Final

_ENDING: Final = ".map"


def new_map(program: Path | None, folder: Path) -> Path:
    """A file that is not there.

    Args:
        program: that is open; None: none is.
        folder: where it is put then.
    """
    first = folder / "board" if program is None else program
    for number in count(1):
        more = "" if number == 1 else f"-{number}"
        path = first.with_name(f"{first.stem}{more}{_ENDING}")
        if not path.exists():
            return path
    raise AssertionError
