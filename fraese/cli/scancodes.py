"""Scan codes of keys, as STATUS.EXE on the disk of X4Step showed them."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import typer

from fraese.cli import language
from fraese.cli.leaving import leave
from fraese.cli.options import ConfigOption, KeysOption
from fraese.cli.output import tell
from fraese.errors import StateError
from fraese.phrases import phrase
from fraese.x4step.codes import ESC_CODE
from fraese.x4step.decoder import Decoder, Stroke
from fraese.x4step.keyboard import BREAK, MAKE_CODES
from fraese.x4step.keys import NoKeys, ToldKeys
from fraese.x4step.surroundings import can_read_keys, program_keys, wanted_keys

app = typer.Typer()

_NAMES: Final = {code: name for name, code in MAKE_CODES.items()}
#: Between two looks for a key, s.
_LOOK_S: Final = 0.01
#: Within this time a terminal has said what it knows, s.
_KNOWN_S: Final = 0.3


@app.command()
def scancodes(config: ConfigOption = None, keys: KeysOption = None) -> None:
    """Press keys and see their make and break codes, as X4BrakeCodes wants them; ESC twice ends."""

    def go() -> int:
        wanted = wanted_keys(language.load(config).x4step, keys)
        if sys.stdin.isatty() and not can_read_keys():
            raise StateError(
                phrase(
                    "The keys of a terminal cannot be read on this system; those of a file"
                    " can, as in fraese scancodes < FILE."
                )
            )
        source = program_keys(wanted)
        strokes = _of_file(wanted.layout) if isinstance(source, NoKeys) else _of_keys(source)
        before = 0
        for stroke in strokes:
            tell(_said(stroke))
            if stroke.phase in ("release", "repeat"):
                continue
            if stroke.key.code == before == ESC_CODE:
                break
            before = stroke.key.code
        return 0

    leave(go)


def _of_file(layout: str) -> Iterator[Stroke]:
    """What a terminal would make of a file."""
    sys.stderr.write("Keys come from a file, as a terminal would send them.\n")
    decoder = Decoder(layout)
    yield from decoder.strokes(sys.stdin.buffer.read(), 0)
    yield from (Stroke(key, "typed") for key in decoder.rest())


def _of_keys(source: ToldKeys) -> Iterator[Stroke]:
    with _taken(source):
        first: list[Stroke] = []
        until_s = time.monotonic() + _KNOWN_S
        while not first and time.monotonic() < until_s:
            time.sleep(_LOOK_S)
            first = source.strokes()
        tell(phrase("Keys come from {said}. ESC twice ends.", said=source.said))
        yield from first
        while True:
            yield from source.strokes()
            time.sleep(_LOOK_S)


@contextmanager
def _taken(source: ToldKeys) -> Iterator[None]:
    source.begin()
    try:
        yield
    finally:
        source.end()


def _said(stroke: Stroke) -> str:
    key, phase = stroke
    if not key.code:
        return phrase(
            "{text}: lies nowhere on this keyboard; see x4step.keyboard", text=repr(key.text)
        )
    line = phrase(
        "{names:10} make {code:3d}  break {code_2:3d}",
        names=_NAMES[key.code],
        code=key.code,
        code_2=key.code + BREAK,
    )
    return line if phase == "typed" else f"{line}  {_WORDS[phase]}"


_WORDS: Final = {"press": "down", "repeat": "repeats", "release": "up"}
