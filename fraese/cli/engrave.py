"""Pictures and drawings made into programs."""

from pathlib import Path
from typing import Annotated

import typer

from fraese.cli.engraveoptions import Wanted
from fraese.cli.leaving import leave
from fraese.cli.options import with_options
from fraese.phrases import phrase

app = typer.Typer()


@app.command()
@with_options
def engrave(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Picture, SVG, DXF or HPGL, by what is in it.")
    ],
    *,
    on: Wanted,
) -> None:
    """Make a program of a picture or a drawing: outlines, sweeps, bitmaps."""

    def go() -> int:
        # Numbers and pictures take half a second to import; other commands do not pay for it.
        from fraese.cli.engraving import engraved

        return engraved(file, on)

    leave(go, on.as_json, phrase("Cancelled; no program was written."))
