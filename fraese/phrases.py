"""Sentences for people: English in the house, in the reader's language where they leave it.

    phrase("There is no axis {axis}.", axis="B")  ->  "There is no axis B.", a text that
                                                      knows its template and parameters
    shown(it)                                     ->  "Eine Achse B gibt es nicht."

Rule 1: whatever a person reads is made by ``phrase``; other phrases in it are its parameters. An
        f-string around a phrase freezes it in English: use ``phrase``, ``joined``, or a plus.
Rule 2: a phrase is its English text: logs, records, comparisons and tests see nothing else.
Rule 3: it is turned into the reader's language once, by ``shown``, where it leaves the program.
Rule 4: numbers, keys, G-code and file names are the same in every language: people copy them.

A language is a gettext catalogue, ``locale/de/LC_MESSAGES/fraese.po``, read as it is; English has
none, and costs nothing.
"""

import os
import re
from collections.abc import Callable, Iterable, Mapping
from numbers import Number
from operator import methodcaller
from pathlib import Path
from typing import Final, Self
from zlib import crc32

#: Languages by their code; the first one is what the templates are written in.
LANGUAGES: Final[Mapping[str, str]] = {"en": "English", "de": "Deutsch"}
ENGLISH: Final = "en"
#: What says which language is wanted, before others; then what the system knows.
LANGUAGE_VARIABLE: Final = "FRAESE_LANGUAGE"
_SYSTEM_VARIABLES: Final = ("LC_ALL", "LC_MESSAGES", "LANG")

_LOCALE: Final = Path(__file__).parent / "locale"
_ENTRY: Final = re.compile(r'\nmsgid "(.*)"\nmsgstr "(.*)"')
_ESCAPE: Final = re.compile(r"\\(.)")
_ESCAPED: Final = {"n": "\n", "t": "\t"}
_WORD: Final = re.compile(r"[a-z]{2}", re.IGNORECASE)
_PLACEHOLDER: Final = re.compile(r"\{[^{}]*\}")

Catalogue = Mapping[str, str]


class Phrase(str):
    """A text in English that knows what it was made of.

    Attributes:
        template: with placeholders in braces, as ``str.format`` has them.
        parameters: what stands for them; phrases among them are turned into the same language.
        altered: what was done to the text afterwards; None: nothing.
    """

    __slots__ = ("altered", "parameters", "template")

    template: str
    parameters: Mapping[str, object]
    altered: Callable[[str], str] | None

    def __new__(
        cls,
        text: str,
        template: str = "",
        parameters: Mapping[str, object] | None = None,
        altered: Callable[[str], str] | None = None,
    ) -> Self:
        """The text as it is, and what it is to remember."""
        made = super().__new__(cls, text)
        made.template = template
        made.parameters = parameters or {}
        made.altered = altered
        return made

    def __str__(self) -> str:
        # Else ``str(error)`` would be a text that knows nothing.
        return self

    def __add__(self, other: str) -> "Phrase":
        return _glued([self, other])

    def __radd__(self, other: str) -> "Phrase":
        return _glued([other, self])

    def alter(self, change: Callable[[str], str]) -> "Phrase":
        """The phrase with something done to its text, in whichever language.

        Args:
            change: can be pickled, as a phrase can.
        """
        return Phrase(change(str.__str__(self)), "{0}", {"0": self}, change)

    def rstrip(self, chars: str | None = None, /) -> "Phrase":
        """As of a text, in whichever language."""
        return self.alter(methodcaller("rstrip", chars))

    def strip(self, chars: str | None = None, /) -> "Phrase":
        """As of a text, in whichever language."""
        return self.alter(methodcaller("strip", chars))

    def capitalize(self) -> "Phrase":
        """The first letter; the others stay, as nouns have capitals of their own in German."""
        return self.alter(_with_capital)

    def upper(self) -> "Phrase":
        """As of a text, in whichever language."""
        return self.alter(methodcaller("upper"))

    def in_language(self, catalogue: Catalogue) -> str:
        """The text by this catalogue; in English what is not in it."""
        values = {
            name: value.in_language(catalogue) if isinstance(value, Phrase) else value
            for name, value in self.parameters.items()
        }
        text = _filled(catalogue.get(self.template, self.template), values)
        return self.altered(text) if self.altered else text

    def core(self) -> "Phrase":
        """What says something in a phrase that only joins others: the first part with words."""
        if _WORD.search(_PLACEHOLDER.sub("", self.template)):
            return self
        parts = (value for value in self.parameters.values() if isinstance(value, Phrase))
        return next((part.core() for part in parts if part.core().template), self)

    @property
    def code(self) -> str:
        """Six digits that name the template, the same in every language."""
        return f"{crc32(self.core().template.encode()) & 0xFFFFFF:06x}"

    def as_dict(self) -> dict[str, object]:
        """Template and parameters, for programs."""
        return {
            "template": self.template,
            "parameters": {
                name: value.as_dict() if isinstance(value, Phrase) else _simple(value)
                for name, value in self.parameters.items()
            },
        }


def _with_capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def phrase(template: str, /, **parameters: object) -> Phrase:
    """A sentence, or a piece of one.

    Args:
        template: English, a literal: catalogues are made of the literals that stand here.
        parameters: by the names in the template's braces; what is no number and has no format is
            kept as its text.
    """
    kept = {
        name: value
        if isinstance(value, str | Number | None) or f"{{{name}:" in template
        else str(value)
        for name, value in parameters.items()
    }
    return Phrase(template.format_map(kept), template, kept)


def reason(error: OSError) -> Phrase:
    """Why the system refused something, in its words."""
    if isinstance(error.strerror, Phrase):
        return error.strerror
    return remembered(error.strerror or os.strerror(error.errno or 0))


def remembered(text: str) -> Phrase:
    """A text that is a phrase without parameters, from where only its English was kept."""
    return Phrase(text, text.replace("{", "{{").replace("}", "}}"))


def joined(separator: str, parts: Iterable[str]) -> Phrase:
    """As ``separator.join(parts)``, in whichever language; the separator may be a phrase too."""
    pieces: list[str] = []
    for part in parts:
        pieces += (separator, part) if pieces else (part,)
    return _glued(pieces)


def _glued(parts: list[str]) -> Phrase:
    names = [str(number) for number in range(len(parts))]
    template = "".join(f"{{{name}}}" for name in names)
    return Phrase("".join(parts), template, dict(zip(names, parts, strict=True)))


def _filled(template: str, values: Mapping[str, object]) -> str:
    # Names that are numbers are places for ``str.format``.
    return template.format(*values.values(), **values)


def _simple(value: object) -> object:
    return value if isinstance(value, str | int | float | None) else str(value)


# --- where phrases leave the program -----------------------------------------------------------

#: Languages in which 10,5 is a number.
_WITH_COMMA: Final = frozenset({"de"})

_catalogue: Catalogue | None = None
_language = ENGLISH


def speak(language: str) -> None:
    """From now on phrases are shown in this language.

    Args:
        language: a code of ``LANGUAGES``.
    """
    global _catalogue, _language
    _language = language
    _catalogue = None if language == ENGLISH else read_catalogue(language)


def shown(text: str) -> str:
    """A text as its reader wants it; of a plain one, what the catalogue has for it."""
    if _catalogue is None:
        return text
    if isinstance(text, Phrase):
        return text.in_language(_catalogue)
    return _catalogue.get(text, text)


def comma_is_decimal() -> bool:
    """A person who writes this language types 10,5, also where G-code wants 10.5."""
    return _language in _WITH_COMMA


def spoken(template: str, /, **parameters: object) -> str:
    """A phrase as its reader wants it, at once: for what draws on the screen.

    Args:
        template: as of ``phrase``.
        parameters: as of ``phrase``.
    """
    return shown(phrase(template, **parameters))


def wanted_language(environment: Mapping[str, str], configured: str | None = None) -> str:
    """Which language somebody wants.

    Args:
        environment: the variables that may name it.
        configured: what the configuration says; None: nothing.
    """
    system = next((environment[name] for name in _SYSTEM_VARIABLES if environment.get(name)), "")
    for said in (environment.get(LANGUAGE_VARIABLE), configured, system):
        # As in de_AT.UTF-8.
        language = re.split(r"[_.@-]", said or "")[0].lower()
        if language in LANGUAGES:
            return language
    return ENGLISH


def catalogue_path(language: str) -> Path:
    """Where the catalogue of a language lies."""
    return _LOCALE / language / "LC_MESSAGES" / "fraese.po"


def read_catalogue(language: str) -> dict[str, str]:
    """Templates in English, and what stands for them."""
    return parsed(catalogue_path(language).read_text("utf-8"))


def parsed(text: str) -> dict[str, str]:
    """The pairs of a catalogue; those without translation are left out.

    Args:
        text: each entry on two lines, as ``rigs.catalogue`` writes it.
    """
    return {_meant(said): _meant(ours) for said, ours in _ENTRY.findall(text) if said and ours}


def _meant(text: str) -> str:
    if "\\" not in text:
        return text
    return _ESCAPE.sub(lambda match: _ESCAPED.get(match[1], match[1]), text)
