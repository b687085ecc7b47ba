"""Starting a module of ours in another process, whatever folder and environment we are in.

Rule 1: the folder in which the user works is not searched for modules: what lies there is data.
"""

import os
import sys
from pathlib import Path
from typing import Final

#: Where our own modules are.
_HOME: Final = Path(__file__).parents[1]


def command(module: str, *arguments: str) -> list[str]:
    """What to run; the current folder is not searched for modules."""
    return [sys.executable, "-P", "-m", module, *arguments]


def environment() -> dict[str, str]:
    """Ours, with the modules that we see, but for those of the working folder."""
    path = os.pathsep.join(folder for folder in sys.path if folder and not _is_foreign(folder))
    return {**os.environ, "PYTHONPATH": path}


def _is_foreign(folder: str) -> bool:
    """The working folder, and it is not where we are at home."""
    try:
        return os.path.samefile(folder, ".") and not os.path.samefile(folder, _HOME)
    except OSError:
        return False
