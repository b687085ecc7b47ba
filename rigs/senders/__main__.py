"""Every sender that is installed, one after the other: ``make senders``."""

import importlib.util
import json
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from rigs.senders import program, throughput
from rigs.senders.bcnc import Bcnc
from rigs.senders.cncjs import Cncjs
from rigs.senders.scenario import Sender, play
from rigs.senders.streamer import Streamer

#: Where ``make senders`` puts what npm installs.
MODULES: Final = Path(__file__).parents[2] / ".rig-cache" / "senders" / "node_modules"


def _has(module: str) -> str:
    return "" if importlib.util.find_spec(module) else f"{module} (PyPI)"


def _program(name: str) -> str:
    return "" if shutil.which(name) else f"{name} (Debian)"


#: By name: what is missing, and how it is made for a folder.
SENDERS: Final[Mapping[str, tuple[Callable[[], list[str]], Callable[[Path], Sender]]]] = {
    "grbl-streamer": (lambda: [_has("grbl_streamer")], lambda folder: Streamer()),
    "bCNC": (
        lambda: [_has("bCNC"), _has("tkinter"), _program("xvfb-run")],
        Bcnc,
    ),
    "cncjs": (
        lambda: [_program("node"), "" if (MODULES / "cncjs").is_dir() else "cncjs (npm)"],
        lambda folder: Cncjs(MODULES, folder),
    ),
}


def missing(name: str) -> list[str]:
    """Packages that a sender needs and that are not here."""
    return [each for each in SENDERS[name][0]() if each]


def judge(name: str, folder: Path, count: int = program.LINES) -> dict[str, object]:
    """What a sender brought about; raises if it was not as it should be."""
    sender = SENDERS[name][1](folder)
    try:
        return play(sender, folder, count)
    finally:
        sender.close()


def main() -> int:
    failed = 0
    for name in sys.argv[1:] or SENDERS:
        if absent := missing(name):
            print(f"{name}: not here: {', '.join(absent)}")
            failed += 1
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                print(json.dumps(judge(name, Path(folder))))
            except AssertionError as error:
                failed += 1
                print(f"{name}: {error}")
    if not sys.argv[1:]:
        throughput.main()
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main())
