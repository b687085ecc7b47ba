"""The app as a command: its machine, and the way out."""

import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

from fraese.assembly import Plant
from fraese.cli import appkeys
from fraese.cli.appsettings import AppSettings
from fraese.cli.departure import Closing, Departure, in_background, left_at_once
from fraese.cli.leaving import AfterMotion
from fraese.cli.output import note
from fraese.cli.shared import Drive
from fraese.config.edit import FileWriter
from fraese.control.asleft import left_by_crash
from fraese.errors import FraeseError, UsageError
from fraese.phrases import phrase
from fraese.program.byhand import ByHand
from fraese.program.kept import KeptPrograms
from fraese.program.program import open_program
from fraese.program.recent import RecentPrograms
from fraese.program.resumption import Resumption
from fraese.ui.app import FraeseApp

#: In the state folder: what was typed in the app.
_TYPED_LINES: Final = "typed-lines"
#: And what it looked like.
_SESSION: Final = "session.json"


def run(on: Drive, file: Path | None) -> int:
    """The app, to its end; the exit code.

    Args:
        on: the machine.
        file: program to open.

    Raises:
        UsageError: there is no terminal.
    """
    has_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    if not has_terminal and not _is_served():
        raise UsageError(
            phrase("The app needs a terminal; without one use a command, see fraese --help.")
        )
    return _run_app(on.plant("paced"), file, on)


def _is_served() -> bool:
    """A browser is the terminal: ``textual serve`` has started this and stands between."""
    return os.environ.get("TEXTUAL_DRIVER", "").startswith("textual.drivers.web_driver")


def make_app(
    plant: Plant,
    program: Path | None,
    on: Drive,
    leaving: Callable[[int], object] | None = None,
) -> FraeseApp:
    """The app on a machine.

    Args:
        plant: the machine.
        program: to open.
        on: where its configuration and its state are.
        leaving: told the exit code when it is on its way out.
    """
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
        settings=AppSettings(on.config, plant.controller),
        macros=appkeys.macros_of(plant.config),
        session=kept.state_folder / _SESSION,
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
        ui = make_app(plant, program, on, leaving)
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
