"""The table of commands: complete, and each of them imports what it needs only."""

import subprocess
import sys
from pathlib import Path

import pytest

import fraese.cli
from fraese.cli.table import MODULES, commands_of


def test_every_module_with_commands_is_in_it() -> None:
    folder = Path(fraese.cli.__file__).parent
    have = {path.stem for path in folder.glob("*.py") if "\napp = typer.Typer(" in path.read_text()}
    assert set(MODULES.values()) == have - {"__init__"}


@pytest.mark.parametrize("module", sorted(set(MODULES.values())))
def test_every_command_of_a_module_is_in_it(module: str) -> None:
    assert {name for name, where in MODULES.items() if where == module} == set(commands_of(module))


@pytest.mark.parametrize(
    ("arguments", "not_wanted"),
    [
        (["alarms"], "fraese.config"),
        (["where"], "numpy"),
        (["where"], "PIL"),
        (["check", "part.ngc"], "fraese.engrave"),
        (["engrave", "--help"], "numpy"),
        (["check", "part.ngc"], "numpy"),
        (["run", "part.ngc"], "numpy"),
        (["where"], "fraese.motor.bridge.driver"),
        (["where"], "fraese.control.calibration"),
        (["where"], "fraese.x4step"),
        (["run", "part.ngc"], "textual"),
    ],
)
def test_a_command_imports_what_it_needs(
    arguments: list[str], not_wanted: str, tmp_path: Path
) -> None:
    (tmp_path / "part.ngc").write_text("G1 X1 F300\nM2\n")
    program = (
        "import atexit, sys\n"
        f"atexit.register(lambda: print({not_wanted!r} in sys.modules))\n"
        f"sys.argv = ['fraese', *{arguments!r}]\n"
        "from fraese.__main__ import main\n"
        "main()\n"
    )
    place = {"HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state")}
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, env=place
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[-1].startswith("False")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--help"], "Ein Programm fahren"),
        (["where", "--help"], "Konfigurationsdatei"),
        (["calibrate", "steps", "--help"], "Konfigurationsdatei"),
    ],
)
def test_help_is_in_the_readers_language_and_has_no_frame(words: list[str], said: str) -> None:
    command = [sys.executable, "-m", "fraese", "--language", "de", *words]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert said in shown
    assert "─" not in shown
