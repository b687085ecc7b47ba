"""What ``fraese engrave`` is told."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import typer

from fraese.cli.options import JsonOption

Way = Literal["outline", "sweep", "bitmap"]
Origin = Literal["corner", "centre", "file"]
Grey = Literal["dots", "steps"]


def _mm(name: str, help_: str, metavar: str = "MM") -> object:
    return typer.Option(name, metavar=metavar, help=help_)


@dataclass(frozen=True)
class Wanted:
    """What somebody says of a program; None: nothing, so it is as usual."""

    output: Annotated[
        str | None,
        typer.Option(
            "--output", "-o", metavar="FILE.ngc", help="The program; - is standard output."
        ),
    ] = None
    way: Annotated[
        Way, typer.Option("--way", help="Along outlines, filled by lines, or as a bitmap.")
    ] = "outline"
    width: Annotated[float | None, _mm("--width", "How wide it becomes; its height follows.")] = (
        None
    )
    height: Annotated[
        float | None, _mm("--height", "How high it becomes; with both it fits into both.")
    ] = None
    origin: Annotated[
        Origin, typer.Option("--origin", help="What is at zero: corner, centre, or the file's own.")
    ] = "corner"
    distance: Annotated[
        float | None,
        _mm(
            "--distance", "From line to line; else 0.1 for a laser and outlines, 0.5 for a cutter."
        ),
    ] = None
    dpi: Annotated[float | None, _mm("--dpi", "The same as lines in an inch.", "N")] = None
    angle: Annotated[
        float | None, _mm("--angle", "Of the lines of a sweep, from X; else 0.", "DEGREES")
    ] = None
    one_way: Annotated[
        bool, typer.Option("--one-way", help="Cut all lines in one direction, not there and back.")
    ] = False
    grey: Annotated[
        Grey | None,
        typer.Option("--grey", help="Greys of a bitmap: as dots, or in steps of power or depth."),
    ] = None
    levels: Annotated[
        int | None, typer.Option("--levels", metavar="N", help="So many greys in steps; else 16.")
    ] = None
    threshold: Annotated[
        float | None,
        _mm("--threshold", "What is darker in a picture is cut; else 50.", "PERCENT"),
    ] = None
    invert: Annotated[bool, typer.Option("--invert", help="Cut what is bright in a picture.")] = (
        False
    )
    depth: Annotated[float | None, _mm("--depth", "With a cutter: how deep; else 0.5.")] = None
    pass_depth: Annotated[
        float | None, _mm("--pass-depth", "No deeper at a time; else all of it.")
    ] = None
    safe_height: Annotated[
        float | None, _mm("--safe-height", "Height of rapids above the work; else 2.")
    ] = None
    plunge_feed: Annotated[
        float | None, _mm("--plunge-feed", "Feed downwards; else 100.", "MM/MIN")
    ] = None
    spindle: Annotated[
        float | None,
        _mm("--spindle", "Speed of the spindle; else 10000. 0: it stays off.", "REV/MIN"),
    ] = None
    power: Annotated[
        float | None, _mm("--power", "With a laser: S of its greatest power.", "S")
    ] = None
    power_min: Annotated[
        float | None, _mm("--power-min", "S at which it just leaves a trace; else 0.", "S")
    ] = None
    dynamic: Annotated[
        bool, typer.Option("--dynamic", help="Laser by M4: power follows the feed where it can.")
    ] = False
    overscan: Annotated[
        float | None,
        _mm("--overscan", "Dark way of a laser before and behind lines; else 2."),
    ] = None
    feed: Annotated[
        float | None, _mm("--feed", "Feed of cuts; else 300, of a laser 1000.", "MM/MIN")
    ] = None
    tabs: Annotated[
        int | None,
        typer.Option("--tabs", metavar="N", help="Bridges on each closed outline; else none."),
    ] = None
    tab_width: Annotated[
        float | None, _mm("--tab-width", "Of a bridge, along the tool's way; else 4.")
    ] = None
    tab_height: Annotated[
        float | None, _mm("--tab-height", "Of a bridge, from the bottom; else 1.")
    ] = None
    tolerance: Annotated[
        float | None, _mm("--tolerance", "How far lines may be from curves; else 0.01.")
    ] = None
    preview: Annotated[
        Path | None,
        typer.Option("--preview", metavar="FILE.png", help="Also draw the program into this file."),
    ] = None
    show: Annotated[bool, typer.Option("--show", help="Also draw what is cut in the terminal.")] = (
        False
    )
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that are there.")] = False
    as_json: JsonOption = False
