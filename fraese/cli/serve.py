"""The command that lets other programs drive the machine."""

import json
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Final

import typer

from fraese.assembly import Plant
from fraese.cli import language
from fraese.cli.departure import Departure
from fraese.cli.leaving import leave
from fraese.cli.options import TraceOption, with_options
from fraese.cli.output import note, result
from fraese.cli.serving import access_of, doors_of, how_served, writer
from fraese.cli.shared import Drive, StartingPlace
from fraese.config.serving import ServeConfig
from fraese.errors import Cancelled
from fraese.phrases import joined, phrase
from fraese.serve.access import Access
from fraese.serve.desk import Desk
from fraese.serve.server import Door
from fraese.serve.store import FILE_NAME, Store
from fraese.signalwatch import watched

app = typer.Typer()

LinkOption = Annotated[
    Path | None,
    typer.Option("--link", metavar="PATH", help="A link to the pseudo-terminal, made anew."),
]
TcpOption = Annotated[
    str | None,
    typer.Option(
        "--tcp",
        metavar="[HOST:]PORT",
        help="Let senders in on a port too; of this computer only, unless HOST says otherwise.",
    ),
]
AllowOption = Annotated[
    list[str] | None,
    typer.Option("--allow", metavar="ADDRESS", help="Let this computer in, or those of a network."),
]
TokenOption = Annotated[
    Path | None,
    typer.Option(
        "--token-file", metavar="FILE", help="Let in who sends the word in it as his first line."
    ),
]
AppOption = Annotated[
    bool, typer.Option("--app", help="With the app, which shows who drives, and can take over.")
]
FastOption = Annotated[
    bool, typer.Option("--fast", help="The simulated mill does not take its time.")
]
#: As in the app.
_SWITCH_INTERVAL_S: Final = 0.0005
_ENDED: Final = Cancelled.exit_code


@app.command()
@with_options
def serve(
    *,
    on: StartingPlace,
    link: LinkOption = None,
    tcp: TcpOption = None,
    allow: AllowOption = None,
    token_file: TokenOption = None,
    fast: FastOption = False,
    in_app: AppOption = False,
    trace: TraceOption = None,
) -> None:
    """Speak grbl's protocol, so that any sender drives this machine. Ends with Ctrl+C."""

    def go() -> int:
        given = {"link": link, "tcp": tcp, "allow": allow, "token_file": token_file}
        how = how_served(language.load(on.config).serve, given)
        access = access_of(how)
        if in_app:
            # It takes a quarter of a second to import.
            from fraese.cli import theapp

            place = Drive(config=on.config, state=on.state, fresh=on.fresh, trace=trace)
            return theapp.run(place, None, given)
        plant = on.plant("virtual" if fast else "paced", trace=trace)
        departure = Departure()
        try:
            return _served(plant, on, how, access, departure)
        finally:
            plant.close()
            departure.machine_is_closed(_ENDED)

    leave(go, on.as_json)


def _served(
    plant: Plant, on: StartingPlace, how: ServeConfig, access: Access, departure: Departure
) -> int:
    store = Store(on.folder / FILE_NAME)
    desk = Desk(plant.controller, store, writer(on.config, plant.controller), note)
    for text in plant.notes:
        note(text)

    def interrupt(number: int = 0) -> None:
        departure.hurry()
        desk.leave()

    # Who reads the line has his turn soon, whatever the machine's thread computes.
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    with watched(interrupt), ExitStack() as closing:
        closing.callback(desk.close)
        doors = doors_of(how, access, desk.wants_turn)
        _say_where(doors, as_json=on.as_json)
        desk.serve(doors)
    _say_how_it_ended(plant, as_json=on.as_json)
    return _ENDED


def _say_how_it_ended(plant: Plant, *, as_json: bool) -> None:
    """Where the machine stands, and how it got there; the waveform, if there is one."""
    plant.close()
    if plant.trace is not None:
        note(plant.trace.waveform.sentence())
    state, machine = plant.controller.state(), plant.controller.machine
    if as_json:
        ended = {
            "status": "cancelled",
            "position_mm": dict(zip(state.axes, state.position_mm, strict=True)),
            "late_ticks": state.late_ticks,
            "dry_queues": state.dry_queues,
            # Only the simulated mill can be looked at.
            "carriages_mm": dict(zip(state.axes, state.carriages_mm, strict=False)) or None,
            "lost_steps": dict(zip(state.axes, state.lost_steps, strict=False)) or None,
        }
        result(json.dumps(ended), lambda: True)
        return
    where = machine.in_words(state.work_mm)
    result(phrase("Ended: {where}", where=where), lambda: True)


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
