"""The command that lets other programs drive the machine."""

import json
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Final

import typer

from fraese.assembly import Plant
from fraese.cli.departure import Departure
from fraese.cli.leaving import leave
from fraese.cli.options import TraceOption, with_options
from fraese.cli.output import note, result
from fraese.cli.shared import StartingPlace
from fraese.config.edit import file_to_write, set_keys
from fraese.config.file import load
from fraese.control.adopting import adopt, is_at_once
from fraese.control.controller import Controller
from fraese.errors import Cancelled
from fraese.phrases import joined, phrase
from fraese.serve.desk import Desk
from fraese.serve.pty import PtyDoor
from fraese.serve.server import Door
from fraese.serve.settings import Changes
from fraese.serve.store import FILE_NAME, Store
from fraese.serve.system import Write
from fraese.signalwatch import watched

app = typer.Typer()

LinkOption = Annotated[
    Path | None,
    typer.Option("--link", metavar="PATH", help="A link to the pseudo-terminal, made anew."),
]
FastOption = Annotated[
    bool, typer.Option("--fast", help="The simulated mill does not take its time.")
]
_ENDED: Final = Cancelled.exit_code


@app.command()
@with_options
def serve(
    *,
    on: StartingPlace,
    link: LinkOption = None,
    fast: FastOption = False,
    trace: TraceOption = None,
) -> None:
    """Speak grbl's protocol, so that any sender drives this machine. Ends with Ctrl+C."""

    def go() -> int:
        plant = on.plant("virtual" if fast else "paced", trace=trace)
        departure = Departure()
        try:
            return _served(plant, on, link, departure)
        finally:
            plant.close()
            departure.machine_is_closed(_ENDED)

    leave(go, on.as_json)


def _served(plant: Plant, on: StartingPlace, link: Path | None, departure: Departure) -> int:
    store = Store(on.folder / FILE_NAME)
    desk = Desk(plant.controller, store, writer(on.config, plant.controller), note)
    for text in plant.notes:
        note(text)

    def interrupt(number: int = 0) -> None:
        departure.hurry()
        desk.leave()

    with watched(interrupt), ExitStack() as closing:
        closing.callback(desk.close)
        doors: list[Door] = [PtyDoor(link, desk.wants_turn)]
        _say_where(doors, as_json=on.as_json)
        desk.serve(doors)
    return _ENDED


def _say_where(doors: list[Door], *, as_json: bool) -> None:
    names = [door.name for door in doors]
    if as_json:
        result(json.dumps({"status": "serving", "at": names}), lambda: False)
        return
    result(
        phrase(
            "Senders find the machine at {names}. Ctrl+C ends.",
            names=joined(phrase(" and "), names),
        ),
        lambda: False,
    )


def writer(named: Path | None, controller: Controller) -> Write:
    """What writes keys of the configuration, and puts into force what counts at once.

    Args:
        named: the file, by the user; None: the one that is found.
        controller: of the machine; called in its thread.
    """

    def write(changes: Changes) -> str:
        path = file_to_write(named)
        set_keys(path, changes)
        adopt(controller, load(path))
        later = [key for key in changes if not is_at_once(key)]
        return (
            phrase("Written to {path}; it counts from the next start.", path=path) if later else ""
        )

    return write
