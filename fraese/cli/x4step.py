"""What a C compiler must be told to build a program of X4Step."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from fraese import x4step
from fraese.cli.leaving import leave
from fraese.cli.output import say
from fraese.errors import UsageError
from fraese.phrases import phrase

app = typer.Typer()


@app.command(name="x4step")
def flags(
    cflags: Annotated[bool, typer.Option("--cflags", help="Where the headers are.")] = False,
    libs: Annotated[bool, typer.Option("--libs", help="The library, a C file.")] = False,
) -> None:
    """Say what gcc needs for a C program of X4Step, as pkg-config does."""

    def go() -> int:
        folder = Path(x4step.__file__).parent / "c"
        words = []
        if cflags:
            words += [f"-I{folder}", f'-DX4STEP_PYTHON="{sys.executable}"']
        if libs:
            words.append(str(folder / "x4step.c"))
        if not words:
            raise UsageError(
                phrase(
                    "Say --cflags, --libs or both, as in gcc prog.c $(fraese x4step --cflags"
                    " --libs)."
                )
            )
        say(" ".join(words))
        return 0

    leave(go)
