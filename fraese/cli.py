"""The command line: the composition root."""

import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Final

import typer

from fraese import configfile as configuration
from fraese.assembly import Plant, assemble, state_folder
from fraese.config import AXIS_NAMES
from fraese.context import ProgramContext
from fraese.controller import Controller
from fraese.errors import Cancelled, FraeseError, UsageError
from fraese.examine import Facts, examine
from fraese.gcode.jsonl import as_dict
from fraese.headless import Session, note, refuse, watch_switches
from fraese.log import write
from fraese.machine import Machine
from fraese.program import open_program
from fraese.sources import ProgramSource
from fraese.words import axes_named, axis_words

app = typer.Typer(
    name="fraese",
    help="Machine control for stepper-driven mills, in the terminal. Without a command: the app.",
    no_args_is_help=False,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
config_app = typer.Typer(help="Look at the configuration.", no_args_is_help=True)
app.add_typer(config_app, name="config")

ConfigOption = Annotated[
    Path | None,
    typer.Option(
        "--config", metavar="FILE", help="Configuration file; else ./fraese.toml, else the user's."
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Result as one JSON object on the last line.")
]
StateOption = Annotated[
    Path | None,
    typer.Option("--state", metavar="DIR", help="Folder in which the machine's state is kept."),
]
FreshOption = Annotated[bool, typer.Option("--fresh", help="Forget the state that was kept.")]
RealTimeOption = Annotated[
    bool, typer.Option("--real-time", help="Let the simulated mill take its time.")
]
FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Program or coordinate list.")]
FeedOption = Annotated[
    float | None,
    typer.Option("--feed", metavar="MM_MIN", help="Feed, mm/min; else as fast as the axes can."),
]

#: Words such as -1.5 or X-3 are values here, not options.
_VALUES: Final = {"ignore_unknown_options": True}


def _command(
    action: Callable[[Controller], object],
    config: Path | None,
    as_json: bool,
    state: Path | None,
    fresh: bool,
    real_time: bool,
) -> None:
    """One command on one machine; leaves with its exit code."""

    def go() -> int:
        plant = assemble(
            configuration.load(config),
            clock="paced" if real_time else "virtual",
            state=state or state_folder(),
            fresh=fresh,
        )
        try:
            return Session(plant, as_json=as_json).do(action)
        except BaseException:
            plant.close()
            raise

    _leave(go, as_json)


def _leave(action: Callable[[], int], as_json: bool = False) -> None:
    """Leave with an exit code; whatever is refused is one sentence."""
    code = 0
    try:
        code = _carried_out(action, as_json)
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read the output has seen enough; what was done was done.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    raise typer.Exit(code)


def _carried_out(action: Callable[[], int], as_json: bool) -> int:
    try:
        return action()
    except FraeseError as error:
        return refuse(error, as_json=as_json)
    except (KeyboardInterrupt, typer.Abort):
        return refuse(Cancelled("Cancelled before anything moved."), as_json=as_json)
    except BrokenPipeError:
        raise
    except Exception as error:
        write("cli", action.__qualname__, "error", traceback.format_exc())
        note(f"fraese: stopped by an error in the program itself: {error!r}.")
        return 1


# --- the app -----------------------------------------------------------------------------------


@app.callback(invoke_without_command=True)
def start(
    context: typer.Context,
    config: ConfigOption = None,
    state: StateOption = None,
    fresh: FreshOption = False,
    file: Annotated[
        Path | None, typer.Option("--open", metavar="FILE", help="Program to open in the app.")
    ] = None,
) -> None:
    """Without a command, start the app."""
    if context.invoked_subcommand is not None:
        # What was said in front of the command holds for it.
        given = {"config": config, "state": state, "fresh": fresh or None}
        given = {name: value for name, value in given.items() if value is not None}
        context.default_map = {context.invoked_subcommand: {**given, "check": given}}
        return

    def go() -> int:
        if not sys.stdin.isatty() or not sys.stdout.isatty():
            raise UsageError(
                "The app needs a terminal; without one use a command, see fraese --help."
            )
        plant = assemble(
            configuration.load(config), clock="paced", state=state or state_folder(), fresh=fresh
        )
        return _run_app(plant, file)

    _leave(go)


def _run_app(plant: Plant, program: Path | None) -> int:
    # Textual takes a quarter of a second to import; headless commands do not pay for it.
    from fraese.ui.app import FraeseApp

    try:
        FraeseApp(
            plant.controller,
            open_program=open_program,
            notes=plant.notes,
            before_motion=lambda: plant.save(moving=True),
            program=program,
            machine_name=plant.machine_name,
            hand=plant.press if plant.is_simulated else None,
        ).run()
    finally:
        plant.close()
    return 0


# --- motion ------------------------------------------------------------------------------------


@app.command()
def run(
    file: FileArgument,
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
    real_time: RealTimeOption = False,
    stream: Annotated[
        bool, typer.Option("--stream", help="Start at once, without looking the file through.")
    ] = False,
    from_line: Annotated[
        int, typer.Option("--from-line", metavar="N", min=1, help="Begin at this line.")
    ] = 1,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before --from-line.")] = False,
) -> None:
    """Run a program: G-code, or a list of coordinates."""

    def action(controller: Controller) -> None:
        program = open_program(file)
        facts = None if stream else program.check(controller, plan=sys.stderr.isatty())
        if from_line > 1:
            _announce(program.way_from(controller, from_line), yes)
        context = controller.program_context()
        program.start(controller, facts, from_line=from_line)
        if not all(context.referenced):
            percent = context.config.run.unreferenced_percent
            note(f"The machine is not referenced: running at {percent:g} % of its rates.")

    _command(action, config, as_json, state, fresh, real_time)


def _announce(way: list[str], yes: bool) -> None:
    """Say what --from-line will do, and ask."""
    for line in way:
        note(line)
    if yes:
        return
    if not sys.stdin.isatty():
        raise UsageError("--from-line asks before it moves; without a terminal add --yes.")
    if not typer.confirm("Go?", err=True):
        raise Cancelled("Not started; nothing has moved.")


@app.command(context_settings=_VALUES)
def move(
    words: Annotated[list[str], typer.Argument(metavar="X.. Y.. Z..", help="As in X10 Y-5.5.")],
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
    real_time: RealTimeOption = False,
    feed: FeedOption = None,
    relative: Annotated[bool, typer.Option("--relative", help="Distances from here.")] = False,
    machine: Annotated[bool, typer.Option("--machine", help="Machine coordinates.")] = False,
) -> None:
    """Move one or several axes in a straight line, in mm, to work coordinates."""

    def action(controller: Controller) -> None:
        targets = axis_words(words)
        if feed is not None and not feed > 0:
            raise UsageError(f"--feed {feed:g}: a feed is above 0 mm/min.")
        controller.move_to(
            targets, relative=relative, machine_coordinates=machine, feed_mm_min=feed
        )

    _command(action, config, as_json, state, fresh, real_time)


@app.command(context_settings=_VALUES)
def jog(
    axis: Annotated[str, typer.Argument(metavar="AXIS", help="X, Y or Z.")],
    distance: Annotated[str, typer.Argument(metavar="MM", help="Signed distance, mm.")],
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
    real_time: RealTimeOption = False,
) -> None:
    """Move one axis a little way."""

    def action(controller: Controller) -> None:
        words = axis_words([axis + distance])
        if len(words) > 1:
            raise UsageError(f'"{axis} {distance}": a jog is of one axis, as in jog X 1.5.')
        for name, distance_mm in words.items():
            controller.jog(name, distance_mm)

    _command(action, config, as_json, state, fresh, real_time)


@app.command()
def home(
    axes: Annotated[
        list[str] | None, typer.Argument(metavar="[AXES]", help="As in Z X; all by default.")
    ] = None,
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
    real_time: RealTimeOption = False,
    measure: Annotated[
        bool, typer.Option("--measure", help="Run to the other end too, and measure the travel.")
    ] = False,
) -> None:
    """Reference the axes at their end switches."""
    _command(
        lambda controller: controller.home(axes_named(axes or []), measure=measure or None),
        config,
        as_json,
        state,
        fresh,
        real_time,
    )


@app.command()
def frame(
    file: FileArgument,
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
    real_time: RealTimeOption = False,
) -> None:
    """Drive round the bounding box of a program, at a safe height."""
    _command(
        lambda controller: open_program(file).drive_frame(controller),
        config,
        as_json,
        state,
        fresh,
        real_time,
    )


@app.command()
def switches(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
) -> None:
    """Press each end switch by hand and see it; nothing moves. Ends with Ctrl+C."""

    def go() -> int:
        plant = assemble(configuration.load(config), clock="paced", state=state or state_folder())
        try:
            return watch_switches(plant.controller, as_json=as_json)
        finally:
            plant.close()

    _leave(go, as_json)


@app.command()
def zero(
    axes: Annotated[
        list[str] | None, typer.Argument(metavar="[AXES]", help="As in X Y; all by default.")
    ] = None,
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
) -> None:
    """Make the present position the work zero."""
    _command(
        lambda controller: controller.set_zero(axes_named(axes or []) or AXIS_NAMES),
        config,
        as_json,
        state,
        fresh=False,
        real_time=False,
    )


@app.command()
def where(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
) -> None:
    """Say where the machine stands, without moving it."""
    _command(lambda controller: None, config, as_json, state, fresh, real_time=False)


# --- programs without motion -------------------------------------------------------------------


@app.command()
def check(
    file: FileArgument,
    config: ConfigOption = None,
    as_json: JsonOption = False,
    state: StateOption = None,
    fresh: FreshOption = False,
) -> None:
    """Look a program through: everything but the motors."""

    def go() -> int:
        plant = assemble(configuration.load(config), state=state or state_folder(), fresh=fresh)
        facts = examine(file, plant.controller.program_context())
        plant.controller.close()
        if as_json:
            print(json.dumps(_facts_as_dict(facts)))
        else:
            _print_facts(file, facts)
        return 0 if facts.ok else UsageError.exit_code

    _leave(go, as_json)


def _facts_as_dict(facts: Facts) -> dict[str, object]:
    bounds = None
    if facts.low_mm is not None and facts.high_mm is not None:
        bounds = {
            name: [low, high]
            for name, low, high in zip(AXIS_NAMES, facts.low_mm, facts.high_mm, strict=True)
        }
    return {
        "ok": facts.ok,
        "errors": [{"line": e.line, "message": e.message} for e in facts.errors],
        "warnings": [{"line": w.line, "message": w.message} for w in facts.outside],
        "bounds_mm": bounds,
        "duration_s": round(facts.duration_s, 3),
        "length_mm": round(facts.length_mm, 3),
        "lines": facts.lines,
        "blocks": facts.blocks,
    }


def _print_facts(file: Path, facts: Facts) -> None:
    for error in facts.errors:
        place = f"{file}, line {error.line}" if error.line else f"{file}"
        note(f"{place}: {error.message}")
    for warning in facts.warnings:
        note(f"{file}, {warning}")
    if facts.low_mm is not None and facts.high_mm is not None:
        for name, low, high in zip(AXIS_NAMES, facts.low_mm, facts.high_mm, strict=True):
            print(f"{name.upper()} {low:10.3f} to {high:10.3f} mm (machine)")
    minutes, seconds = divmod(facts.duration_s, 60)
    print(
        f"{facts.lines} lines, {facts.blocks} blocks, {facts.length_mm:.1f} mm,"
        f" {minutes:.0f} min {seconds:04.1f} s"
    )
    print("ok" if facts.ok else "refused")


@app.command()
def gcode(file: FileArgument, config: ConfigOption = None) -> None:
    """Print the canonical moves of a program, one JSON object a line; starts at zero."""

    def go() -> int:
        open_program(file)
        settings = configuration.load(config)
        machine = Machine.from_config(settings)
        nowhere = (0,) * len(machine.axes)
        context = ProgramContext(settings, machine, nowhere, nowhere, (False,) * 3, {})
        out = sys.stdout
        for canonical in ProgramSource(file, context).moves():
            values = as_dict(canonical)
            if values is not None:
                out.write(json.dumps(values) + "\n")
        out.flush()
        return 0

    _leave(go)


# --- configuration -----------------------------------------------------------------------------


@config_app.command("check")
def config_check(config: ConfigOption = None) -> None:
    """See whether the configuration makes sense."""

    def go() -> int:
        settings = configuration.load(config)
        assemble(settings).controller.close()
        found = configuration.find_file(config)
        print(f"{found}: ok" if found else "No configuration file: built-in defaults. ok")
        return 0

    _leave(go)


@config_app.command("schema")
def config_schema() -> None:
    """Print the JSON schema of the configuration, for editors."""
    _leave(lambda: _printed(json.dumps(configuration.schema(), indent=2) + "\n"))


@config_app.command("default")
def config_default() -> None:
    """Print a configuration file with every key at its default."""
    _leave(lambda: _printed(configuration.annotated()))


def _printed(text: str) -> int:
    print(text, end="")
    return 0


def main() -> None:
    """Entry point."""
    app()
