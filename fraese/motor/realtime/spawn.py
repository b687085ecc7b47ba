"""Starting a module of ours in another process, whatever folder and environment we are in."""

import os
import sys


def command(module: str, *arguments: str) -> list[str]:
    """What to run; the current folder is not searched for modules."""
    return [sys.executable, "-P", "-m", module, *arguments]


def environment() -> dict[str, str]:
    """Ours, with the modules that we see."""
    path = os.pathsep.join(folder for folder in sys.path if folder)
    return {**os.environ, "PYTHONPATH": path}
