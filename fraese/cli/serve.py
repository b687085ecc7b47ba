"""The command that lets other programs drive the machine."""

import json
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from fraese.assembly import Plant
from fraese.cli import language
from fraese.cli.departure import Departure
from fraese.cli.leaving import leave
from fraese.cli.options import TraceOption, with_options
from fraese.cli.output import note, result
from fraese.cli.shared import StartingPlace
from fraese.config.edit import file_to_write, set_keys
from fraese.config.file import from_table, load
from fraese.config.serving import ServeConfig, address_of
from fraese.control.adopting import adopt, is_at_once
from fraese.control.controller import Controller
from fraese.errors import Cancelled
from fraese.phrases import joined, phrase
from fraese.serve.access import Access, token_of
from fraese.serve.desk import Desk
from fraese.serve.pty import PtyDoor
from fraese.serve.server import Door
from fraese.serve.settings import Changes
from fraese.serve.store import FILE_NAME, Store
from fraese.serve.system import Write
from fraese.serve.tcp import TcpDoor
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
    tcp: TcpOption = None,
    allow: AllowOption = None,
    token_file: TokenOption = None,
    fast: FastOption = False,
    trace: TraceOption = None,
) -> None:
    """Speak grbl's protocol, so that any sender drives this machine. Ends with Ctrl+C."""

    def go() -> int:
        given = {"link": link, "tcp": tcp, "allow": allow, "token_file": token_file}
        how = how_served(language.load(on.config).serve, given)
        token = token_of(Path(how.token_file).expanduser() if how.token_file else None)
        plant = on.plant("virtual" if fast else "paced", trace=trace)
        departure = Departure()
        try:
            return _served(plant, on, how, Access(how.networks, token), departure)
        finally:
            plant.close()
            departure.machine_is_closed(_ENDED)

    leave(go, on.as_json)


def how_served(configured: ServeConfig, given: Mapping[str, Any]) -> ServeConfig:
    """How senders come in: as configured, but for what was said.

    Raises:
        ConfigError: what was said makes no sense.
    """
    said = {
        key: str(value) if isinstance(value, Path) else value
        for key, value in given.items()
        if value is not None
    }
    table = {**configured.model_dump(mode="json"), **said}
    return from_table({"serve": table}, "fraese serve").serve


def doors_of(how: ServeConfig, access: Access, wants_turn: Callable[[], object]) -> list[Door]:
    """What senders come in by.

    Raises:
        PortError: one of them cannot be had.
        ConfigError: the link cannot be made.
    """
    doors: list[Door] = [PtyDoor(how.link_path, wants_turn)]
    if how.tcp:
        try:
            doors.append(TcpDoor(*address_of(how.tcp), access, wants_turn))
        except BaseException:
            doors[0].close()
            raise
    return doors


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

    with watched(interrupt), ExitStack() as closing:
        closing.callback(desk.close)
        doors = doors_of(how, access, desk.wants_turn)
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
