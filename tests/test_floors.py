"""The import contracts really refuse what they are there to refuse: tried on a copy."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
_LINT = "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()"


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A copy of the package with the contracts."""
    shutil.copytree(ROOT / "fraese", tmp_path / "fraese", ignore=shutil.ignore_patterns("__py*"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def _broken(house: Path) -> list[str]:
    """Names of the contracts that the copy breaks."""
    done = subprocess.run(
        [sys.executable, "-c", _LINT, "--no-cache"],
        cwd=house,
        env={**os.environ, "PYTHONPATH": str(house), "COLUMNS": "400"},
        capture_output=True,
        text=True,
        check=False,
    )
    broken = re.findall(r"^(.*) BROKEN", done.stdout, re.MULTILINE)
    assert (done.returncode == 0) == (not broken), done.stdout + done.stderr
    return broken


def _write(house: Path, file: str, line: str) -> None:
    path = house / "fraese" / file
    text = path.read_text("utf-8") if path.exists() else '"""Stray."""\n'
    path.write_text(f"{text}\n{line}\n", "utf-8")


def test_the_house_as_it_stands_breaks_nothing(house: Path) -> None:
    assert _broken(house) == []


@pytest.mark.parametrize(
    ("file", "line", "contract"),
    [
        ("stray.py", "", "Floors"),
        ("stray.py", "import textual\nfrom fraese.planner import planner", "Floors"),
        ("errors.py", "from fraese import blocks", "Floors"),
        ("control/jobs.py", "from fraese.program import check", "Floors"),
        ("planner/arcs.py", "from fraese.motor import seams", "Floors"),
        ("kinds/card.py", "from fraese.ui import keyrows", "Floors"),
        ("doctor/board.py", "from fraese.x4step import codes", "Floors"),
        ("x4step/codes.py", "from fraese.cli import shared", "Floors"),
        ("motor/track.py", "from fraese import machine", "The world of steps"),
        ("motor/track.py", "from fraese import workframe", "The world of steps"),
        ("motor/track.py", "from fraese import feedway", "The world of steps"),
        ("gcode/canon.py", "from fraese import blocks", "The language"),
        ("control/stray.py", "from fraese.gcode import canon", "The controller"),
        ("motor/track.py", "from fraese.motor.cards import control", "The core"),
        ("motor/ports/stray.py", "", "No port"),
        ("motor/ports/null.py", "from fraese.motor.ports import sim", "No port"),
        ("motor/cards/stepdir.py", "from fraese.motor.cards import smc1500", "No card"),
        ("ui/feed.py", "from fraese.program import translate", "The UI"),
        ("ui/feed.py", "from fraese.control import runner", "The UI"),
        ("ui/stray.py", "from fraese import machine", "The UI"),
        ("ui/feed.py", "import typer", "The UI"),
        ("ui/feed.py", "from fraese import workframe", "The UI"),
        ("ui/feed.py", "from fraese import feedway", "The UI"),
        ("program/source.py", "import rich", "The terminal"),
        ("engrave/tools.py", "from fraese.gcode import canon", "Floors"),
        ("engrave/sketch.py", "import rich", "The terminal"),
        ("workframe.py", "import rich", "The terminal"),
        ("anythread.py", "import typer", "The terminal"),
        ("feedway.py", "import textual", "The terminal"),
    ],
)
def test_a_stray_module_or_import_is_refused(
    house: Path, file: str, line: str, contract: str
) -> None:
    _write(house, file, line)
    broken = _broken(house)
    assert [name for name in broken if name.startswith(contract)], broken
