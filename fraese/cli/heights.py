"""The command that probes a height map."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from fraese.axiswords import axis_words
from fraese.cli.options import with_options
from fraese.cli.output import note
from fraese.cli.shared import Answering
from fraese.control.controller import Controller
from fraese.errors import OutputError, UsageError
from fraese.heightmap.heights import Flat
from fraese.heightmap.mapfile import PartMap
from fraese.phrases import phrase
from fraese.program.content import take
from fraese.program.grid import Grid
from fraese.program.mapfiles import MapFile
from fraese.program.mapped import part_of
from fraese.program.mapping import Feeling, empty_map
from fraese.program.mapping import Mapping as MapProbing

app = typer.Typer()

_USUAL = Feeling()

OutputOption = Annotated[
    Path, typer.Option("--output", "-o", metavar="MAP", help="File of the height map.")
]
FromOption = Annotated[
    str | None, typer.Option("--from", metavar='"X0 Y0"', help="A corner, work coordinates.")
]
ToOption = Annotated[
    str | None, typer.Option("--to", metavar='"X100 Y80"', help="The opposite corner.")
]
EveryOption = Annotated[
    float, typer.Option("--every", metavar="MM", help="From point to point, at most.")
]
ReferenceOption = Annotated[
    str | None,
    typer.Option(
        "--reference",
        metavar='"X0 Y0"',
        help="Where Z0 is touched off, and the height is 0; else the point nearest to X0 Y0.",
    ),
]
ClearanceOption = Annotated[
    float, typer.Option("--clearance", metavar="MM", help="Over the work at this height.")
]
DepthOption = Annotated[
    float, typer.Option("--depth", metavar="MM", help="So far below the reference at most.")
]
ReachOption = Annotated[
    float, typer.Option("--reach", metavar="MM", help="So far down to the reference at most.")
]
FeedOption = Annotated[
    float, typer.Option("--feed", metavar="MM_MIN", help="Towards the work, mm/min.")
]
GoOnOption = Annotated[bool, typer.Option("--go-on", help="Probe what is missing in the file.")]
ForceOption = Annotated[bool, typer.Option("--force", help="Replace the file.")]


@app.command("probe-map")
@with_options
def probe_map(
    output: OutputOption,
    *,
    on: Answering,
    low: FromOption = None,
    high: ToOption = None,
    every: EveryOption = 10.0,
    reference: ReferenceOption = None,
    clearance: ClearanceOption = _USUAL.clearance_mm,
    depth: DepthOption = _USUAL.depth_mm,
    reach: ReachOption = _USUAL.reach_mm,
    feed: FeedOption = _USUAL.feed_mm_min,
    go_on: GoOnOption = False,
    force: ForceOption = False,
) -> None:
    """Probe a height map: the tool stands above the work, and goes from point to point.

    Every point is in the file as soon as it is known; what is missing is probed with --go-on.
    """
    file = MapFile(output)
    probing: list[MapProbing] = []

    def action(controller: Controller) -> None:
        names = controller.machine.names
        if go_on:
            if low is not None or high is not None or reference is not None:
                raise UsageError(
                    phrase(
                        "--go-on takes the points from the file: leave out --from, --to and"
                        " --reference."
                    )
                )
            part = _begun(output)
        else:
            _require_new(output, force)
            grid = Grid(
                _corner(low, "--from", names),
                _corner(high, "--to", names),
                every,
                None if reference is None else _corner(reference, "--reference", names),
            )
            part = empty_map(controller, grid)
        one = MapProbing(controller, part, Feeling(clearance, depth, reach, feed), file.keep)
        one.require_ready()
        file.begin(part)
        one.start()
        probing.append(one)

    try:
        on.do(action, more=lambda: _found(probing[0].part, file, on.as_json))
    finally:
        file.close()
        if probing and _is_begun(probing[0].part, force):
            note(_how_far(probing[0].part, file))


def _corner(text: str | None, option: str, names: tuple[str, ...]) -> Flat:
    """X and Y of a corner.

    Raises:
        UsageError: they are not both there, or something else is.
    """
    if text is None:
        raise UsageError(
            phrase('Give two corners: --from "X0 Y0" --to "X100 Y80", in work coordinates.')
        )
    values = axis_words(text, names)
    if set(values) != {"x", "y"}:
        raise UsageError(
            phrase(
                '{option} "{text}": a point has X and Y, as in "X10 Y20".', option=option, text=text
            )
        )
    return values["x"], values["y"]


def _begun(path: Path) -> PartMap:
    content = take(path)
    if content is None:
        raise UsageError(phrase("{path}: there is no height map to go on with.", path=path))
    return part_of(content)


def _is_begun(part: PartMap, force: bool) -> bool:
    """There is something to go on with; what was to be replaced is still there without a point."""
    return 0 < part.missing < part.points + (not force)


def _require_new(path: Path, force: bool) -> None:
    """See that nothing is lost.

    Raises:
        UsageError: there is a file, and it is not to be replaced.
        ProgramError: it is no height map, which nobody means by --force.
    """
    if path.is_file() and force and path.stat().st_size:
        _begun(path)
    elif path.exists() and not force:
        raise UsageError(
            phrase(
                "{path} is there already: go on with it (--go-on), replace it (--force), or name"
                " another file.",
                path=path,
            )
        )


def _found(part: PartMap, file: MapFile, as_json: bool) -> Mapping[str, Any]:
    """What belongs to the result; for people it is noted.

    Raises:
        OutputError: the file could not be written.
    """
    file.close()
    if file.failure:
        raise OutputError(file.failure)
    heights = part.whole()
    if not as_json:
        note(
            phrase(
                "{path}: {in_words}; height 0 is at {reference}.",
                path=file.path,
                in_words=heights.in_words(),
                reference=heights.reference_in_words(),
            )
        )
    return {
        "height_map": {
            "file": str(file.path),
            "points": part.points,
            "heights_mm": [heights.lowest_mm, heights.highest_mm],
            "reference_mm": list(heights.reference_mm),
        }
    }


def _how_far(part: PartMap, file: MapFile) -> str:
    if file.failure:
        return file.failure
    return phrase(
        "{path} has {found} of {points} points; go on with: fraese probe-map -o {path} --go-on",
        path=file.path,
        found=part.points - part.missing,
        points=part.points,
    )
