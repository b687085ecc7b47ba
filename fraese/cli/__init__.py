"""The command line: the composition root."""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fraese.assembly import Plant
from fraese.cli import (
    alarms,
    appkeys,
    bench,
    bridge,
    calibrate,
    doctor,
    files,
    motion,
    ports,
    scancodes,
    trace,
    x4step,
)
from fraese.cli.departure import Closing, Departure, in_background, left_at_once
from fraese.cli.language import LanguageOption, as_the_system, named_in, translated
from fraese.cli.output import note, open_standard_files
from fraese.cli.session import AfterMotion
from fraese.cli.shared import ConfigOption, Drive, FreshOption, StateOption, TraceOption, leave
from fraese.config.edit import FileWriter
from fraese.control.asleft import left_by_crash
from fraese.errors import FraeseError, UsageError
from fraese.phrases import phrase
from fraese.program import ByHand, Resumption, open_program
from fraese.program.kept import KeptPrograms
from fraese.program.recent import RecentPrograms

if TYPE_CHECKING:
    from fraese.ui.app import FraeseApp

#: In the state folder: what was typed in the app.
_TYPED_LINES = "typed-lines"

app = typer.Typer(
    name="fraese",
    help="Machine control for stepper-driven mills, in the terminal. Without a command: the app.",
    no_args_is_help=False,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(motion.app)
app.add_typer(calibrate.app, name="calibrate")
app.add_typer(files.app)
app.add_typer(ports.app)
app.add_typer(bridge.app)
app.add_typer(doctor.app)
app.add_typer(bench.app)
app.add_typer(x4step.app)
app.add_typer(scancodes.app)
app.add_typer(trace.app)
app.add_typer(alarms.app)


@app.callback(invoke_without_command=True)
def start(
    context: typer.Context,
    config: ConfigOption = None,
    state: StateOption = None,
    fresh: FreshOption = False,
    file: Annotated[
        Path | None, typer.Option("--open", metavar="FILE", help="Program to open in the app.")
    ] = None,
    trace: TraceOption = None,
    language: LanguageOption = None,
) -> None:
    """Without a command, start the app."""
    if context.invoked_subcommand is not None:
        # What was said in front of the command holds for it.
        given = {"config": config, "state": state, "fresh": fresh or None, "trace": trace}
        given = {name: value for name, value in given.items() if value is not None}
        inner = dict.fromkeys(("check", *calibrate.NAMES), given)
        context.default_map = {context.invoked_subcommand: {**given, **inner}}
        return

    def go() -> int:
        if not sys.stdin.isatty() or not sys.stdout.isatty():
            raise UsageError(
                phrase("The app needs a terminal; without one use a command, see fraese --help.")
            )
        on = Drive(config=config, state=state, fresh=fresh, trace=trace)
        plant = on.plant("paced")
        return _run_app(plant, file, on)

    leave(go)


def _make_app(
    plant: Plant,
    program: Path | None,
    on: Drive,
    leaving: Callable[[int], object] | None = None,
) -> "FraeseApp":
    # Textual takes a quarter of a second to import; headless commands do not pay for it.
    from fraese.ui.app import FraeseApp

    # What a crash has left is offered by the app itself.
    left = left_by_crash(plant.controller)
    kept = KeptPrograms(on.folder)
    return FraeseApp(
        plant.controller,
        open_program=partial(open_program, apart=True, kept=kept),
        resume=partial(Resumption.of, kept=kept, apart=True),
        recent=RecentPrograms(on.folder),
        notes=[text for text in plant.notes if left is None or text != left.sentence],
        program=program,
        machine_name=plant.machine_name,
        hand=plant.press if plant.is_simulated else None,
        leaving=leaving,
        writer=FileWriter(on.config),
        bench=plant.bench,
        tools=ByHand(),
        history=kept.state_folder / _TYPED_LINES,
        keys=appkeys.table_of(plant.controller, plant.config, on.config),
    )


def _run_app(plant: Plant, program: Path | None, on: Drive) -> int:
    """The app, to its end; the exit code."""
    departure = Departure(leave=left_at_once(sys.stdin.fileno()))
    ui: FraeseApp | None = None

    def close() -> None:
        try:
            if ui is not None:
                ui.link.close()
        finally:
            plant.close()

    closing = Closing(close)

    def leaving(code: int) -> None:
        """The machine does not wait for the picture, nor for whoever should look at it."""
        departure.hurry()
        in_background(lambda: departure.machine_is_closed(closing.code(code)), "way out")

    try:
        ui = _make_app(plant, program, on, leaving)
        ui.run()
    finally:
        _close_moved(plant, closing)
        if plant.trace is not None:
            note(plant.trace.waveform.sentence())
    return ui.exit_code


def _close_moved(plant: Plant, closing: Closing) -> None:
    """Close; what fails then is no refusal if the machine has moved.

    Raises:
        FraeseError: if it cannot be closed, or its state not be kept.
    """
    try:
        closing()
    except FraeseError as error:
        if any(plant.controller.travelled_steps()):
            raise AfterMotion(error) from error
        raise


def main() -> None:
    """Entry point."""
    open_standard_files()
    named_in(sys.argv[1:])
    as_the_system()
    translated(typer.main.get_command(app))()
