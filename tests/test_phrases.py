"""Phrases keep what they are made of, and every one of them has its German."""

import ast
import copy
import pickle
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese import phrases
from fraese.errors import Alarm, ConfigError, FraeseError, LimitError, PortError, ProgramError
from fraese.phrases import Phrase, joined, parsed, phrase, read_catalogue, shown, wanted_language
from rigs.catalogue import HOUSE, brought_up_to_date, entry, placeholders, sentences

#: Packages with texts of errors that no catalogue can have yet.
NOT_YET = {
    "x4step",
}
_NOT_FOR_PEOPLE = {"ValueError", "TypeError", "RuntimeError", "AssertionError", "OSError"}


@pytest.fixture
def in_german() -> Iterator[None]:
    phrases.speak("de")
    yield
    phrases.speak("en")


# --- what a phrase is --------------------------------------------------------------------------


def test_a_phrase_is_its_english_text() -> None:
    said = phrase("There is no axis {name}; this machine has {listed}.", name="B", listed="X")
    assert said == "There is no axis B; this machine has X."
    assert isinstance(said, str)
    assert shown(said) == said


def test_it_is_shown_in_german_with_the_phrases_in_it(in_german: None) -> None:
    listed = phrase("{others} and {last}", others="X, Y", last="Z")
    said = phrase("There is no axis {name}; this machine has {listed}.", name="B", listed=listed)
    assert shown(said) == "Eine Achse B gibt es nicht; diese Maschine hat X, Y und Z."
    assert str(said) == "There is no axis B; this machine has X, Y and Z."


@pytest.mark.parametrize(
    "made",
    [
        lambda it: "(" + it + ")",
        lambda it: joined("", ["(", it, ")"]),
        lambda it: phrase("({it})", it=it),
        lambda it: "(" + str(it) + ")",
        lambda it: str(ConfigError("(" + it + ")")),
    ],
)
def test_what_is_made_of_it_is_german_too(made: object, in_german: None) -> None:
    assert callable(made)
    said = made(phrase("line {line}", line=3))
    assert said == "(line 3)"
    assert shown(said) == "(Zeile 3)"


def test_its_text_is_changed_in_either_language(in_german: None) -> None:
    said = (phrase("Nothing has moved.") + "..").rstrip(".").capitalize().upper()
    assert said == "NOTHING HAS MOVED"
    assert shown(said) == "NICHTS HAT SICH BEWEGT"


@given(st.text(), st.text())
def test_a_parameter_may_be_any_text(name: str, braces: str) -> None:
    said = phrase("{named}: there is no such configuration file.", named=name) + braces
    assert said == f"{name}: there is no such configuration file.{braces}"
    catalogue = {"{named}: there is no such configuration file.": "{named} fehlt."}
    assert said.in_language(catalogue) == f"{name} fehlt.{braces}"


def test_a_parameter_with_a_format_is_no_text_yet() -> None:
    at = datetime(2026, 11, 29, 16, 5)
    assert phrase("ends {at:%H:%M} in {path}", at=at, path=Path("a")) == "ends 16:05 in a"


def test_it_survives_copies_and_other_processes() -> None:
    said = ("at " + phrase("line {line}", line=3)).rstrip("3")
    for other in (pickle.loads(pickle.dumps(said)), copy.deepcopy(said)):
        assert (other, other.as_dict()) == (said, said.as_dict())
        assert other.in_language({"line {line}": "Zeile {line}"}) == "at Zeile "


def test_a_plain_text_is_looked_up_as_it_is(in_german: None) -> None:
    assert shown("Nothing has moved.") == "Nichts hat sich bewegt."
    assert shown("of no catalogue {") == "of no catalogue {"


def test_a_place_and_its_calls_are_german(in_german: None) -> None:
    error = ProgramError(
        phrase("must be given"), 7, "a.ngc", (("sub.ngc", 3), ("sub.ngc", 9), ("a.ngc", 2))
    )
    assert shown(str(error)) == (
        "a.ngc, Zeile 7 (aufgerufen in sub.ngc, Zeile 3 ... aufgerufen in a.ngc, Zeile 2):"
        " muss angegeben werden"
    )


def test_a_word_that_no_screen_holds_is_shortened_in_either_language(in_german: None) -> None:
    error = ConfigError(phrase("{named}: there is no such configuration file.", named="a" * 1000))
    assert len(str(error)) < 200
    assert len(shown(str(error))) < 200
    assert shown(str(error)).endswith("a: eine solche Konfigurationsdatei gibt es nicht.")


# --- codes -------------------------------------------------------------------------------------


def test_a_code_does_not_depend_on_language_place_or_parameters(in_german: None) -> None:
    def error(name: str, line: int) -> FraeseError:
        return ProgramError(phrase("unknown key {key}", key=name), line, "a.ngc")

    assert error("a", 1).error_code == error("b", 2).error_code
    assert error("a", 1).error_code.startswith("program-")
    assert error("a", 1).error_code != LimitError(phrase("unknown key {key}", key="a")).error_code


def test_an_alarms_code_is_its_number() -> None:
    assert PortError("gone").error_code == "alarm-50"


def test_no_two_sentences_have_the_same_code() -> None:
    codes = {Phrase(text, text).code: text for text in sentences()}
    assert len(codes) == len(sentences())


def test_every_family_of_errors_has_a_name() -> None:
    def families(kind: type[FraeseError]) -> Iterator[type[FraeseError]]:
        yield kind
        for child in kind.__subclasses__():
            if not issubclass(child, Alarm):
                yield from families(child)

    ours = [kind for kind in families(FraeseError) if kind.__module__ == "fraese.errors"]
    assert len({kind.kind_name for kind in ours}) == len(ours)


# --- which language ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("environment", "configured", "language"),
    [
        ({}, None, "en"),
        ({"LANG": "de_AT.UTF-8"}, None, "de"),
        ({"LANG": "de_AT.UTF-8", "LC_ALL": "C"}, None, "en"),
        ({"LANG": "fr_FR.UTF-8"}, None, "en"),
        ({"LANG": "en_GB.UTF-8"}, "de", "de"),
        ({"FRAESE_LANGUAGE": "en", "LANG": "de_DE"}, "de", "en"),
        ({"FRAESE_LANGUAGE": "DE"}, None, "de"),
        ({"FRAESE_LANGUAGE": "klingon", "LANG": "de"}, None, "de"),
    ],
)
def test_the_nearest_word_about_the_language_counts(
    environment: dict[str, str], configured: str | None, language: str
) -> None:
    assert wanted_language(environment, configured) == language


# --- catalogues --------------------------------------------------------------------------------

_TO_DO = "run python -m rigs.catalogue, and translate what has no translation"


def test_every_sentence_has_its_german() -> None:
    missing = sorted(set(sentences()) - set(read_catalogue("de")))
    assert missing == [], _TO_DO


def test_the_catalogue_is_as_the_sources_are() -> None:
    assert phrases.catalogue_path("de").read_text("utf-8") == brought_up_to_date("de"), _TO_DO


def test_a_translation_has_the_same_placeholders() -> None:
    wrong = {
        said: ours
        for said, ours in read_catalogue("de").items()
        if placeholders(said) != placeholders(ours)
    }
    assert wrong == {}


def test_a_translation_begins_and_ends_as_its_sentence_does() -> None:
    def edges(text: str) -> tuple[str, str, bool]:
        return text[: -len(text.lstrip())], text[len(text.rstrip()) :], text.endswith(".")

    wrong = {s: o for s, o in read_catalogue("de").items() if edges(s) != edges(o)}
    assert wrong == {}


@given(st.dictionaries(st.text(min_size=1), st.text(min_size=1)))
def test_what_is_written_to_a_catalogue_is_read_again(pairs: dict[str, str]) -> None:
    lines = {name: ours for name, ours in pairs.items() if "\r" not in name + ours}
    lines = {name: ours for name, ours in lines.items() if (name + ours).isprintable()}
    text = "\n".join(entry("a.py", said, ours) for said, ours in lines.items())
    assert parsed(text) == lines


# --- sources -----------------------------------------------------------------------------------


def _frozen(path: Path) -> Iterator[str]:
    """Errors whose text is no phrase."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not (isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args):
            continue
        first = node.exc.args[0]
        text = isinstance(first, ast.JoinedStr) or (
            isinstance(first, ast.Constant) and isinstance(first.value, str) and first.value
        )
        if text and ast.unparse(node.exc.func) not in _NOT_FOR_PEOPLE:
            yield f"{path.relative_to(HOUSE)}:{node.lineno}"


def test_the_text_of_an_error_is_a_phrase() -> None:
    found = {place for path in HOUSE.rglob("*.py") for place in _frozen(path)}
    frozen = {place.partition("/")[0] for place in found}
    assert frozen <= NOT_YET, sorted(found)
    assert frozen == NOT_YET, f"these are converted: {NOT_YET - frozen}"
