"""Which language commands and the app speak.

Rule 1: what is said in front of the command counts, then ``FRAESE_LANGUAGE``, then the
        configuration, then the system.
"""

import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fraese.phrases import LANGUAGE_VARIABLE, LANGUAGES, phrase, shown, speak, wanted_language

if TYPE_CHECKING:
    from fraese.config.config import Config


def as_the_system() -> None:
    """Before anything is known of a configuration."""
    speak(wanted_language(os.environ))


def named_in(words: Sequence[str]) -> None:
    """Take the language from a command line before it is read: its help is in that language too."""
    for word, following in pairwise((*words, "")):
        name, _, value = word.partition("=")
        language = value or following
        if name == "--language" and language in LANGUAGES:
            os.environ[LANGUAGE_VARIABLE] = language


def translated(command: Any) -> Any:
    """A command with its help, and that of all below it, as its reader wants it."""
    command.help = command.help and shown(command.help)
    for parameter in command.params:
        help_ = getattr(parameter, "help", None)
        if help_:
            parameter.help = shown(help_)
    for inner in getattr(command, "commands", {}).values():
        translated(inner)
    return command


def load(named: Path | None) -> "Config":
    """The configuration; from now on its language, if nobody said otherwise.

    Raises:
        ConfigError: one sentence with file, key and what would be right.
    """
    # Commands that need none do not pay for it.
    from fraese.config import file as configuration

    config = configuration.load(named)
    speak(wanted_language(os.environ, config.language))
    return config


def _said(language: str | None) -> str | None:
    if language is not None:
        if language not in LANGUAGES:
            raise typer.BadParameter(
                phrase(
                    "{language} is none of {languages}.",
                    language=language,
                    languages=", ".join(LANGUAGES),
                )
            )
        os.environ[LANGUAGE_VARIABLE] = language
        as_the_system()
    return language


LanguageOption = Annotated[
    str | None,
    typer.Option(
        "--language",
        metavar="|".join(LANGUAGES),
        help="Language; else as FRAESE_LANGUAGE, the configuration, or the system says.",
        callback=_said,
        is_eager=True,
    ),
]
