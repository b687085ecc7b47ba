"""Scan codes of keys, as STATUS.EXE on the disk of X4Step showed them."""

import sys
from collections.abc import Iterator
from typing import Final

import typer

from fraese.cli.shared import ConfigOption, leave
from fraese.config import file as configuration
from fraese.x4step.codes import ESC_CODE
from fraese.x4step.decoder import Decoder, Key
from fraese.x4step.keyboard import MAKE_CODES
from fraese.x4step.keys import BREAK
from fraese.x4step.surroundings import terminal_keyboard

app = typer.Typer()

_NAMES: Final = {code: name for name, code in MAKE_CODES.items()}


@app.command()
def scancodes(config: ConfigOption = None) -> None:
    """Press keys and see their make and break codes, as X4BrakeCodes wants them; ESC twice ends."""

    def go() -> int:
        before = 0
        for key in _keys(configuration.load(config).x4step.keyboard):
            print(_said(key), flush=True)
            if key.code == before == ESC_CODE:
                break
            before = key.code
        return 0

    leave(go)


def _keys(layout: str) -> Iterator[Key]:
    """Keys of the terminal, or those that a file would be."""
    if not sys.stdin.isatty():
        decoder = Decoder(layout)
        yield from decoder.take(sys.stdin.buffer.read(), 0)
        yield from decoder.rest()
        return
    keyboard = terminal_keyboard(layout)
    while True:
        try:
            yield keyboard.getch()
        except EOFError:
            return


def _said(key: Key) -> str:
    if not key.code:
        return f"{key.text!r}: lies nowhere on this keyboard; see x4step.keyboard"
    return f"{_NAMES[key.code]:10} make {key.code:3d}  break {key.code + BREAK:3d}"
