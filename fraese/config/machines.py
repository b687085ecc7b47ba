"""Example machines: whole configurations to begin with.

Rule 1: what stands in ``machines/`` is what differs from the defaults, with one line about it; the
        whole file is made of it. Another machine is another file there.
"""

import tomllib
from collections.abc import Sequence
from importlib.resources import files

from fraese.config.config import Config
from fraese.config.file import annotated, from_table
from fraese.errors import UsageError
from fraese.phrases import joined, phrase

_FOLDER = files("fraese.config") / "machines"


def names() -> Sequence[str]:
    """Of all example machines."""
    return sorted(file.name.removesuffix(".toml") for file in _FOLDER.iterdir())


def about(name: str) -> str:
    """What machine it is, half a sentence."""
    return _text(name).partition("\n")[0].removeprefix("# ")


def config_of(name: str) -> Config:
    """An example machine.

    Raises:
        UsageError: if there is none of that name.
    """
    return from_table(tomllib.loads(_text(name)), name)


def whole(name: str) -> str:
    """The same as a file, every key with its sentence.

    Raises:
        UsageError: if there is none of that name.
    """
    return annotated(config_of(name), about(name))


def _text(name: str) -> str:
    if name not in names():
        raise UsageError(
            phrase(
                "There is no example machine {name}; there are: {names}.",
                name=name,
                names=joined(", ", names()),
            )
        )
    return (_FOLDER / f"{name}.toml").read_text("utf-8")
