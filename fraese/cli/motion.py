"""Commands that drive the machine, or ask it something."""

import sys
from typing import Annotated

import typer

from fraese.axiswords import axes_named, axis_words, target
from fraese.cli.leaving import leave
from fraese.cli.looking import Looking, tell_others
from fraese.cli.options import VALUES, FileArgument, HeightMapOption, with_options
from fraese.cli.output import note
from fraese.cli.shared import Answering, Drive, OpenPlace, StartingPlace
from fraese.cli.switchwatch import watch_switches
from fraese.control.asleft import take_as_left
from fraese.control.controller import Controller
from fraese.errors import Cancelled, FraeseError, UsageError
from fraese.phrases import phrase
from fraese.program.check import Facts
from fraese.program.context import ProgramContext, tool_table
from fraese.program.interrupted import cut_short
from fraese.program.kept import KeptPrograms
from fraese.program.mapped import about_map, take_map
from fraese.program.program import Program, open_program
from fraese.program.resumption import Resumption
from fraese.tooldata import changed_tools

FeedOption = Annotated[
    float | None,
    typer.Option("--feed", metavar="MM_MIN", help="Feed, mm/min; else as fast as the axes can."),
]
JogFeedOption = Annotated[
    float | None,
    typer.Option("--feed", metavar="MM_MIN", help="Feed, mm/min; else as jog.feed_mm_min says."),
]

app = typer.Typer()


@app.command()
@with_options
def run(
    file: FileArgument,
    *,
    on: Answering,
    stream: Annotated[
        bool, typer.Option("--stream", help="Start at once, without looking the file through.")
    ] = False,
    from_line: Annotated[
        int, typer.Option("--from-line", metavar="N", min=1, help="Begin at this line.")
    ] = 1,
    height_map: HeightMapOption = None,
) -> None:
    """Run a program: G-code, or a list of coordinates."""

    def action(controller: Controller) -> None:
        program = open_program(file, kept=KeptPrograms(on.folder), drawn=False)
        if height_map is not None:
            program.heights = take_map(height_map)
            for line in about_map(program.heights, ProgramContext.of(controller)):
                note(line)
        facts = None if stream else _looked_through(program, controller)
        if from_line > 1:
            _announce(program.way_from(controller, from_line), on.yes)
        context = ProgramContext.of(controller)
        program.start(controller, facts, from_line=from_line)
        if not all(context.referenced):
            percent = context.config.run.unreferenced_percent
            note(
                phrase(
                    "The machine is not referenced: running at {percent:g} % of its rates.",
                    percent=percent,
                )
            )

    on.do(action)


def _looked_through(program: Program, controller: Controller) -> Facts:
    program.told = looking = Looking(program.name)
    try:
        return program.check(controller, plan=sys.stderr.isatty())
    except FraeseError as error:
        looking.done()
        tell_others(program.facts, str(program.path), error)
        raise
    finally:
        looking.done()


@app.command()
@with_options
def resume(
    *,
    on: Answering,
    back: Annotated[
        int, typer.Option("--back", metavar="N", min=0, help="Begin so many moves earlier.")
    ] = 0,
) -> None:
    """Go on with the program that was cut short, at the move at which it was left."""

    def action(controller: Controller) -> None:
        resumption = Resumption.of(controller, KeptPrograms(on.folder))
        _announce(resumption.words(back), on.yes)
        resumption.start(controller, back)

    on.do(action)


def _announce(way: list[str], yes: bool) -> None:
    """Say what a start in the middle will do, and ask."""
    for line in way:
        note(line)
    if yes:
        return
    if not sys.stdin.isatty():
        raise UsageError(
            phrase("A start in the middle asks before it moves; without a terminal add --yes.")
        )
    if not typer.confirm("Go?", err=True):
        raise Cancelled(phrase("Not started; nothing has moved."))


@app.command(context_settings=VALUES)
@with_options
def move(
    words: Annotated[list[str], typer.Argument(metavar="X.. Y..", help="As in X10 Y-5.5.")],
    *,
    on: Drive,
    feed: FeedOption = None,
    relative: Annotated[bool, typer.Option("--relative", help="Distances from here.")] = False,
    machine: Annotated[bool, typer.Option("--machine", help="Machine coordinates.")] = False,
) -> None:
    """Move axes in a straight line to work coordinates, in mm; rotary ones in degrees."""

    def action(controller: Controller) -> None:
        there = target(" ".join(words), controller.machine.names)
        _require(feed)
        if feed is not None and there.feed_mm_min is not None:
            raise UsageError(phrase("The feed is given twice: either --feed or F."))
        controller.move_to(
            there.targets_mm,
            relative=relative,
            machine_coordinates=machine,
            feed_mm_min=feed or there.feed_mm_min,
        )

    on.do(action)


def _require(feed: float | None) -> None:
    if feed is not None and not feed > 0:
        raise UsageError(phrase("--feed {feed:g}: a feed is above 0 mm/min.", feed=feed))


@app.command(context_settings=VALUES)
@with_options
def jog(
    axis: Annotated[str, typer.Argument(metavar="AXIS", help="Its letter.")],
    distance: Annotated[
        str, typer.Argument(metavar="DISTANCE", help="Signed, in mm; rotary: degrees.")
    ],
    *,
    on: Drive,
    feed: JogFeedOption = None,
) -> None:
    """Move one axis a little way."""

    def action(controller: Controller) -> None:
        words = axis_words(f"{axis} {distance}", controller.machine.names)
        if len(words) > 1:
            raise UsageError(
                phrase(
                    '"{axis} {distance}": a jog is of one axis, as in jog X 1.5.',
                    axis=axis,
                    distance=distance,
                )
            )
        _require(feed)
        for name, distance_mm in words.items():
            controller.jog(name, distance_mm, feed_mm_min=feed)

    on.do(action)


@app.command()
@with_options
def home(
    axes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[AXES]", help="As in Z X; by default all that have end switches."),
    ] = None,
    *,
    on: Drive,
    measure: Annotated[
        bool, typer.Option("--measure", help="Run to the other end too, and measure the travel.")
    ] = False,
) -> None:
    """Reference the axes at their end switches; one without, by its name: here is its zero."""

    def action(controller: Controller) -> None:
        named = axes_named(axes or [], controller.machine.names)
        controller.home(named, measure=measure or None)

    on.do(action)


@app.command()
@with_options
def frame(
    file: FileArgument,
    *,
    on: Drive,
) -> None:
    """Drive round the bounding box of a program, at a safe height."""
    on.do(lambda controller: open_program(file, drawn=False).drive_frame(controller))


@app.command()
@with_options
def switches(on: OpenPlace) -> None:
    """Press each end switch by hand and see it; nothing moves. Ends with Ctrl+C."""

    def go() -> int:
        plant = on.plant("paced")
        try:
            return watch_switches(plant.controller, as_json=on.as_json)
        finally:
            plant.close()
            if plant.trace is not None:
                note(plant.trace.waveform.sentence())

    leave(go, on.as_json)


@app.command()
@with_options
def zero(
    axes: Annotated[
        list[str] | None, typer.Argument(metavar="[AXES]", help="As in X Y; all by default.")
    ] = None,
    *,
    on: OpenPlace,
) -> None:
    """Make the present position the work zero."""

    def action(controller: Controller) -> None:
        names = controller.machine.names
        controller.set_zero(axes_named(axes or [], names) or names)

    on.do(action)


@app.command()
@with_options
def trust(on: OpenPlace) -> None:
    """Take the position as a crash left it, where the motors find back to it; nothing moves.

    Only if nobody has pushed an axis since. What is known of the position, fraese where says.
    """
    on.do(take_as_left)


@app.command()
@with_options
def where(on: StartingPlace) -> None:
    """Say where the machine stands, without moving it; also while another program drives it."""

    def action(controller: Controller) -> None:
        for sentence in cut_short(controller.keep().job):
            note(sentence)
        kept = controller.position.offsets.parameters
        for number, tool in changed_tools(kept, tool_table(controller.config)).items():
            note(
                phrase(
                    "Tool {number}, as a program has set it: length {length_mm:.3f} mm, diameter"
                    " {diameter_mm:.3f} mm.",
                    number=number,
                    length_mm=tool.length_mm,
                    diameter_mm=tool.diameter_mm,
                )
            )

    on.do(action, at_desk=not on.fresh)
