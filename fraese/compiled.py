"""Which modules are compiled, where there is a C compiler, and which form of them counts.

    fraese/motor/ticks.py              the source: what is read, and run where nothing is compiled
    fraese/motor/ticks.cpython-311...  the same, made of it by mypyc (``setup.py``)

Rule 1: All of them or none: a compiled module calls the others without asking what they are now.
Rule 2: In a checkout the sources count as soon as one of them is not what was compiled: so whoever
        works on one sees his change. ``make compiled`` brings both together again.
Rule 3: Whoever wants the sources says so, with ``FRAESE_PLAIN=1``.

What is compiled can be changed by nobody from outside: no class of it is the base of one elsewhere,
and no method or function is put in the place of another. A generator that nobody wants any more is
just forgotten: one that has something to close behind its last word is none of these.
"""

import os
import sys
from collections.abc import Sequence
from enum import Enum
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    SOURCE_SUFFIXES,
    FileFinder,
    ModuleSpec,
    SourceFileLoader,
)
from pathlib import Path
from types import ModuleType
from typing import Final

#: Set to something, it asks for the plain form.
PLAIN: Final = "FRAESE_PLAIN"

_PACKAGE: Final = Path(__file__).parent
#: What was compiled, beside it: a digest of the sources.
_STAMP: Final = "compiled.stamp"

#: Where the time goes, by package: whatever is done for each step, each block or each line.
MODULES: Final = tuple(
    f"{package}.{module}"
    for package, modules in {
        "fraese": "feedway",
        "fraese.motor": "blockqueue cursor governor horizon pulses reactions run throttle ticks"
        " track wires contacts electronics mill rotor",
        "fraese.motor.cards": "smc1500 stepdir",
        "fraese.motor.realtime": "chores clock records ring",
        "fraese.motor.bridge": "records",
        "fraese.planner": "arcs backlash lines lookahead measure merging planner ramps rounding"
        " segments shapedwindow targets timing",
        "fraese.gcode": "arcs axes interpreter motion offsets oword parameters position source"
        " words",
        "fraese.program": "box numbers survey timetablemaker translate",
    }.items()
    for module in modules.split()
)


class Form(Enum):
    """The form that counts, and why."""

    COMPILED = "compiled"
    #: Nothing was compiled.
    PLAIN = "plain"
    #: It was asked for.
    WANTED = "wanted"
    #: A source is not what was compiled any more.
    STALE = "stale"

    def in_words(self) -> str:
        """For people, with what to do if it is not as it could be."""
        from fraese.phrases import phrase

        return {
            Form.COMPILED: phrase("compiled"),
            Form.PLAIN: phrase("plain"),
            Form.WANTED: phrase("plain, as {variable} says", variable=PLAIN),
            Form.STALE: phrase("plain: sources have changed since they were compiled"),
        }[self]


class _Sources:
    """Finds the sources of our modules, also of one that was listed once; nothing else."""

    def __init__(self) -> None:
        self._finders: dict[str, FileFinder] = {}

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """See ``importlib.abc.MetaPathFinder``."""
        if not name.startswith("fraese.") or not path:
            return None
        folder = path[0]
        if folder not in self._finders:
            self._finders[folder] = FileFinder(folder, (SourceFileLoader, SOURCE_SUFFIXES))
        return self._finders[folder].find_spec(name)


def sources(package: Path) -> list[Path]:
    """The files of the modules that are compiled."""
    return [package.joinpath(*name.split(".")[1:]).with_suffix(".py") for name in MODULES]


def digest(package: Path) -> str:
    """What they hold."""
    import hashlib  # Nobody else pays for it.

    held = hashlib.sha256(" ".join(MODULES).encode("ascii"))
    for source in sources(package):
        held.update(source.read_bytes())
    return held.hexdigest()


def stamp(package: Path, held: str, at_s: float) -> None:
    """Remember of what everything was compiled.

    Args:
        package: where the modules are.
        held: their ``digest``
        at_s: at this time, s since 1970.
    """
    path = package / _STAMP
    path.write_text(held, "ascii")
    os.utime(path, (at_s, at_s))


def form_of(package: Path, wanted: str) -> Form:
    """The form that counts.

    Args:
        package: where the modules are.
        wanted: what the environment says.
    """
    files = sources(package)
    if not all(file.with_suffix(EXTENSION_SUFFIXES[0]).exists() for file in files):
        return Form.PLAIN
    if wanted not in ("", "0"):
        return Form.WANTED
    return Form.STALE if _is_stale(package, files) else Form.COMPILED


def _is_stale(package: Path, files: Sequence[Path]) -> bool:
    """Whether a source is not what was compiled; what was installed is not worked on."""
    if not (package.parent / "setup.py").exists():
        return False
    try:
        made_at_s = (package / _STAMP).stat().st_mtime
        if all(file.stat().st_mtime < made_at_s for file in (*files, Path(__file__))):
            return False
        return (package / _STAMP).read_text("ascii") != digest(package)
    except OSError:
        return True


#: The form that counts in this process.
FORM: Final = form_of(_PACKAGE, os.environ.get(PLAIN, ""))

if FORM is not Form.COMPILED:
    sys.meta_path.insert(0, _Sources())
