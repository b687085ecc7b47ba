"""The app as a command: its machine, and the way out."""

import os
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

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

if TYPE_CHECKING:
    from fraese.cli.appserving import AppSenders

#: In the state folder: what was typed in the app.
_TYPED_LINES: Final = "typed-lines"
#: And what it looked like.
_SESSION: Final = "session.json"


def run(on: Drive, file: Path | None, served: Mapping[str, Any] | None = None) -> int:
    """The app, to its end; the exit code.

    Args:
        on: the machine.
        file: program to open.
        served: senders are let in, and so much was said of how; None: if that is configured.

    Raises:
        UsageError: there is no terminal.
    """
    has_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    if not has_terminal and not _is_served():
        raise UsageError(
            phrase("The app needs a terminal; without one use a command, see fraese --help.")
        )
    return _run_app(on.plant("paced"), file, on, served)


def _is_served() -> bool:
    """A browser is the terminal: ``textual serve`` has started this and stands between."""
    return os.environ.get("TEXTUAL_DRIVER", "").startswith("textual.drivers.web_driver")


def make_app(
    plant: Plant,
    program: Path | None,
    on: Drive,
    leaving: Callable[[int], object] | None = None,
    senders: "AppSenders | None" = None,
) -> FraeseApp:
    """The app on a machine.

    Args:
        plant: the machine.
        program: to open.
        on: where its configuration and its state are.
        leaving: told the exit code when it is on its way out.
        senders: other programs that may drive it, too; None: none may.
    """
    # What a crash has left is offered by the app itself.
    left = left_by_crash(plant.controller)
    kept = KeptPrograms(on.folder)
    notes = [text for text in plant.notes if left is None or text != left.sentence]
    app = FraeseApp(
        plant.controller,
        open_program=partial(open_program, apart=True, kept=kept),
        resume=partial(Resumption.of, kept=kept, apart=True),
        recent=RecentPrograms(on.folder),
        notes=notes if senders is None else [*notes, senders.sentence],
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
    if senders is not None:
        senders.go_by(app.link)
    return app


def _senders(plant: Plant, on: Drive, said: Mapping[str, Any] | None) -> "AppSenders | None":
    """Those that are let in, if they are wanted."""
    if said is None and not plant.config.serve.app:
        return None
    # Nobody else pays for it.
    from fraese.cli.appserving import AppSenders
    from fraese.cli.serving import access_of, how_served, writer
    from fraese.serve.store import FILE_NAME, Store

    how = how_served(plant.config.serve, said or {})
    write = writer(on.config, plant.controller)
    store = Store(on.folder / FILE_NAME)
    return AppSenders(plant.controller, store, write, how, access_of(how))


def _run_app(
    plant: Plant, program: Path | None, on: Drive, served: Mapping[str, Any] | None
) -> int:
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
        senders = _senders(plant, on, served)
        ui = make_app(plant, program, on, leaving, senders)
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
