"""The list of alarms: whole, numbered for ever, and what users read is what the program says."""

import ast
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fraese import alarms
from fraese.alarms import ALARMS, BY_NUMBER, AlarmKind
from fraese.cli import app
from fraese.cli.alarms import page
from fraese.errors import Alarm, HomingError, PortError

ROOT = Path(__file__).parents[1]


def _constants() -> dict[str, AlarmKind]:
    return {name: value for name, value in vars(alarms).items() if isinstance(value, AlarmKind)}


def _named() -> set[str]:
    """Names of alarms that are raised somewhere, or are what a class of errors usually means."""
    return {
        node.attr
        for path in (ROOT / "fraese").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "alarms"
    }


def test_every_alarm_is_in_the_list_once_in_order() -> None:
    assert set(_constants().values()) == set(ALARMS)
    numbers = [kind.number for kind in ALARMS]
    assert numbers == sorted(set(numbers))
    assert len({kind.name for kind in ALARMS}) == len(ALARMS) == len(BY_NUMBER)


def test_every_alarm_is_raised_somewhere() -> None:
    assert set(_constants()) <= _named()


def test_every_class_of_alarms_has_a_kind() -> None:
    for kind in Alarm.__subclasses__():
        assert kind("It happened.").kind in ALARMS


@pytest.mark.parametrize("kind", ALARMS, ids=lambda kind: kind.name)
def test_the_words_are_sentences(kind: AlarmKind) -> None:
    for text in (kind.what, kind.trust.value, kind.remedy):
        assert text[0].isupper()
        assert text.endswith(".")
        assert text == " ".join(text.split())


def test_the_page_says_what_the_program_says() -> None:
    assert (ROOT / "docs/alarms.md").read_text("utf-8").endswith(page())


def test_an_alarm_says_what_it_is_about() -> None:
    usual = HomingError("Not found.", end="xmin")
    assert usual.as_dict()["number"] == 20
    assert usual.as_dict()["parameters"] == {"end": "xmin"}
    assert PortError("Gone.", alarms.BRIDGE_LOST).as_dict()["name"] == "bridge_lost"
    assert str(PortError("Gone.", alarms.BRIDGE_LOST)) == "Gone."


def test_the_command_prints_all_or_one() -> None:
    run = CliRunner()
    every = run.invoke(app, ["alarms"])
    assert every.exit_code == 0
    assert [line.split()[0] for line in every.stdout.splitlines() if line[:1].isdigit()] == [
        str(kind.number) for kind in ALARMS
    ]
    one = json.loads(run.invoke(app, ["alarms", "41", "--json"]).stdout)
    assert [(kind["number"], kind["trust"]) for kind in one] == [(41, "ramped")]
    wrong = run.invoke(app, ["alarms", "99"])
    assert wrong.exit_code == 2
    assert "no alarm 99; there are 10, 20" in wrong.stderr
