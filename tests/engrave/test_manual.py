"""docs/engrave.md: its examples do what it says, and its pictures are of them."""

import re
import shutil

import pytest
from PIL import Image

from bench.engravings import EXAMPLES, MANUAL, PICTURES, examples, shown
from fraese.cli.table import commands_of
from fraese.engrave.hpgl.commands import PASSED, ROWS
from tests.engrave.bench import Bench


def test_every_example_is_carried_out_and_its_program_looked_through(bench: Bench) -> None:
    shutil.copytree(EXAMPLES, bench.folder, dirs_exist_ok=True)
    made = [words for words in examples() if words[0] == "engrave"]
    assert len(made) >= 7
    for words in examples():
        result = bench.run(*words)
        assert result.exit_code == 0, result.output
    for words in made:
        program = words[words.index("-o") + 1]
        assert bench.run("check", program).stdout.endswith("ok\n"), program
    for name in shown():
        with Image.open(PICTURES / name) as there, Image.open(bench.folder / name) as now:
            assert there.size == now.size, f"make engravings: {name}"


def test_the_pictures_are_small_and_all_of_them_are_shown() -> None:
    files = {path.name: path.stat().st_size for path in PICTURES.iterdir()}
    assert set(files) == shown()
    assert sum(files.values()) < 120_000


def test_every_command_of_a_plotter_in_the_manual_is_known() -> None:
    table = MANUAL.read_text("utf-8").partition("| commands |")[2].partition("\n\n")[0]
    named = set(re.findall(r"`([A-Z]{2})`", table))
    known = {*ROWS, "LB", "SM", "PE"}
    assert named <= known | set(PASSED)
    assert known <= named


@pytest.mark.parametrize("option", re.findall(r"`(--[a-z-]+)", MANUAL.read_text("utf-8")))
def test_every_option_in_the_manual_is_one(option: str) -> None:
    known = {name for each in commands_of("engrave")["engrave"].params for name in each.opts}
    assert option in known | {"--yes"}
