"""Which form of our modules counts: compiled or plain."""

import os
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest

from fraese import compiled
from fraese.compiled import FORM, MODULES, Form, digest, form_of, sources, stamp
from fraese.phrases import shown

HOUSE = Path(compiled.__file__).parent
LONG_AGO_S = 1e9


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A checkout in which everything was compiled long ago."""
    package = tmp_path / "fraese"
    for source in sources(package):
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(f'"""{source.stem}."""\n')
        os.utime(source, (LONG_AGO_S, LONG_AGO_S))
        source.with_suffix(EXTENSION_SUFFIXES[0]).touch()
    (tmp_path / "setup.py").touch()
    stamp(package, digest(package), LONG_AGO_S + 60)
    return package


def test_every_module_that_is_listed_is_there_and_listed_once() -> None:
    assert [path for path in sources(HOUSE) if not path.exists()] == []
    assert len(set(MODULES)) == len(MODULES)


def test_what_was_compiled_counts(house: Path) -> None:
    assert form_of(house, "") is Form.COMPILED
    assert form_of(house, "0") is Form.COMPILED


def test_who_wants_the_sources_gets_them(house: Path) -> None:
    assert form_of(house, "1") is Form.WANTED


def test_all_of_them_or_none(house: Path) -> None:
    sources(house)[3].with_suffix(EXTENSION_SUFFIXES[0]).unlink()
    assert form_of(house, "") is Form.PLAIN


def test_a_source_that_was_changed_counts_until_it_is_compiled(house: Path) -> None:
    changed = sources(house)[5]
    before = changed.read_text()
    changed.write_text('"""Another one."""\n')
    assert form_of(house, "") is Form.STALE
    stamp(house, digest(house), LONG_AGO_S + 60)
    assert form_of(house, "") is Form.COMPILED
    # Changed back: newer, and not what was compiled now.
    changed.write_text(before)
    assert form_of(house, "") is Form.STALE


def test_a_source_that_is_newer_and_the_same_is_no_change(house: Path) -> None:
    os.utime(sources(house)[5])
    assert form_of(house, "") is Form.COMPILED


def test_without_a_stamp_nobody_knows_what_was_compiled(house: Path) -> None:
    (house / "compiled.stamp").unlink()
    assert form_of(house, "") is Form.STALE


def test_what_was_installed_is_not_looked_at(house: Path) -> None:
    (house.parent / "setup.py").unlink()
    (house / "compiled.stamp").unlink()
    os.utime(sources(house)[0])
    assert form_of(house, "") is Form.COMPILED


def _asked(*arguments: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


@pytest.mark.parametrize("plain", ["", "1"])
def test_the_version_says_in_which_form_it_runs_and_all_modules_do(plain: str) -> None:
    files = (
        "from importlib import import_module as one; from fraese.compiled import FORM, MODULES;"
        " print(FORM.value, *sorted({one(name).__file__.rpartition('.')[2] for name in MODULES}))"
    )
    said, *suffixes = _asked("-c", files, FRAESE_PLAIN=plain).split()
    form = Form(said)
    assert suffixes == ["so" if form is Form.COMPILED else "py"]
    assert form is not Form.COMPILED or not plain
    version = _asked("-m", "fraese", "--version", FRAESE_PLAIN=plain)
    assert version.endswith(f", {shown(form.in_words())}")


def test_every_form_has_words() -> None:
    words = [shown(form.in_words()) for form in Form]
    assert len(set(words)) == len(words)
    assert shown(FORM.in_words()) in words
