"""Man page and completion are as the program is; every command has its help in them."""

import shutil
import subprocess
from pathlib import Path

import pytest

from fraese.cli.table import MODULES
from rigs import manual

SHARE = Path(__file__).parents[2] / "share"


def test_what_is_shared_is_as_the_program_is() -> None:
    for place, text in manual.shared_files().items():
        assert (SHARE / place).read_text("utf-8") == text, "run make manual"


def test_every_command_and_every_option_has_its_help() -> None:
    pages = list(manual.every(manual.root()))
    names = {page.name for page in pages}
    assert {f"fraese {name}" for name in MODULES} <= names
    assert {"fraese config init", "fraese bridge flash"} <= names
    assert all(page.help for page in pages)
    silent = [(page.name, row.typed) for page in pages for row in page.options if not row.help]
    assert silent == []


def test_a_page_says_how_it_is_called() -> None:
    (run,) = [page for page in manual.root().inner if page.name == "fraese run"]
    text = manual.markdown(run)
    assert text.startswith("# fraese run\n\nRun a program")
    assert "fraese run [OPTIONS]" in text
    assert "| `--from-line N` |" in text


@pytest.mark.skipif(shutil.which("groff") is None, reason="needs the Debian package groff")
def test_the_man_page_is_sound_roff() -> None:
    page = SHARE / "man" / "man1" / "fraese.1"
    command = ["groff", "-man", "-ww", "-T", "utf8", str(page)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert "None of this is an emergency stop" in done.stdout
