"""Commands speak the language that is wanted, and for programs always the same."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fraese.phrases import speak
from tests.cli.test_cli import Shop, shop

__all__ = ["shop"]


@pytest.fixture(autouse=True)
def english_again() -> Iterator[None]:
    yield
    speak("en")


_NO_FILE = "fraese: nowhere.toml: eine solche Konfigurationsdatei gibt es nicht."


def test_a_wrong_file_is_named_in_german(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRAESE_LANGUAGE", "en")
    result = shop.run("--language", "de", "move", "X1", "--config", "nowhere.toml")
    assert (result.exit_code, result.stderr.strip()) == (2, _NO_FILE)


def test_the_configuration_may_say_the_language(
    shop: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("FRAESE_LANGUAGE")
    Path("fraese.toml").write_text('language = "de"\n', "utf-8")
    result = shop.run("move", "B5")
    assert result.stderr.strip() == (
        "fraese: Eine Achse B gibt es nicht; diese Maschine hat X, Y und Z."
    )
    monkeypatch.setenv("FRAESE_LANGUAGE", "en")
    assert "There is no axis B" in shop.run("move", "B5").stderr


def test_programs_are_told_english_a_code_and_what_it_is_made_of(
    shop: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FRAESE_LANGUAGE", "en")
    result = shop.run("--language", "de", "move", "B5", "--json")
    assert '"message": "There is no axis B; this machine has X, Y and Z."' in result.stdout
    assert '"code": "usage-' in result.stdout
    assert '"template": "There is no axis {name}; this machine has {listed}."' in result.stdout
    assert "Eine Achse B gibt es nicht" in result.stderr


def test_a_language_that_there_is_not_is_refused(shop: Shop) -> None:
    result = shop.run("--language", "xx", "alarms")
    assert result.exit_code == 2
    assert "xx is none of en, de" in result.output


def test_alarms_say_in_german_what_to_do(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRAESE_LANGUAGE", "en")
    said = shop.run("--language", "de", "alarms", "23", state=False).stdout
    assert "homing.pull_off_mm größer machen." in said


def test_help_is_german_before_a_command_is_read(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "fraese", "--language", "de", "jog", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "Eine Achse ein kleines Stück fahren." in done.stdout
