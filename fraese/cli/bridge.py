"""The serial bridge: who is there, is it well, and its firmware put on a board.

The last two are in ``bridgetrial.py`` and ``flash.py``.
"""

import json
import statistics
from typing import Annotated, Final

import typer

from fraese.cli import language
from fraese.cli.bridgeplace import BaudOption, DeviceOption, Place, place_of
from fraese.cli.bridgetrial import tried
from fraese.cli.flash import HALF_WRITTEN, BoardOption, DryRunOption, flashed
from fraese.cli.leaving import leave
from fraese.cli.options import ConfigOption, JsonOption, TraceOption
from fraese.cli.output import say
from fraese.cli.shared import MOTORS_OFF
from fraese.errors import UsageError
from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.session import greeting
from fraese.motor.bridge.stepwise import finish
from fraese.motor.bridge.trial import round_trips_s
from fraese.motor.clock import MonotonicClock
from fraese.phrases import phrase

app = typer.Typer()
bridge_app = typer.Typer(help="The microcontroller on a serial port.", no_args_is_help=True)
app.add_typer(bridge_app, name="bridge")

MoveOption = Annotated[
    int,
    typer.Option("--move", metavar="STEPS", min=0, help="Also move each motor there and back."),
]
YesOption = Annotated[bool, typer.Option("--yes", help="Do not ask before the board is written.")]

_RESET_REASONS: Final = {
    1: phrase("power on"),
    2: phrase("reset pin"),
    4: "brown-out",
    8: "watchdog",
}


# --- info ----------------------------------------------------------------------------------------


@bridge_app.command()
def info(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    device: DeviceOption = None,
    baud: BaudOption = None,
) -> None:
    """Say who is there: board, firmware, queue, and how fast it answers."""

    def go() -> int:
        place = place_of(language.load(config), device, baud)
        session = finish(greeting(place.line(), MonotonicClock(), place.device, place.baud))
        try:
            trips_s = round_trips_s(session)
        finally:
            session.close()
        facts = _facts(place, session.hello, trips_s)
        if as_json:
            say(json.dumps(facts))
        else:
            for name, value in facts.items():
                say(f"{name.replace('_', ' '):16} {value}")
        return 0

    leave(go, as_json)


def _facts(place: Place, hello: Hello, trips_s: list[float]) -> dict[str, object]:
    return {
        "device": place.device,
        "baud": place.baud,
        "board": hello.board,
        "firmware": f"{hello.firmware[0]}.{hello.firmware[1]}",
        "protocol": hello.version,
        "queue_bytes": hello.ring,
        "motors": hello.motors,
        "longest_table": hello.table_max,
        "last_reset": _RESET_REASONS.get(hello.reset_reason, "not known"),
        "answer_ms": round(statistics.median(trips_s) * 1000, 2),
        "slowest_ms": round(max(trips_s) * 1000, 2),
    }


# --- test, flash ----------------------------------------------------------------------------------


@bridge_app.command("test")
def try_out(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    device: DeviceOption = None,
    baud: BaudOption = None,
    move: MoveOption = 0,
    trace: TraceOption = None,
) -> None:
    """Try the bridge out; no motor moves without --move."""

    def go() -> int:
        if trace and not move:
            raise UsageError(phrase("--trace draws what --move moves: say --move STEPS too."))
        place = place_of(language.load(config), device, baud)
        return tried(place, move, trace, as_json=as_json)

    leave(go, as_json, MOTORS_OFF)


@bridge_app.command()
def flash(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    device: DeviceOption = None,
    board: BoardOption = None,
    yes: YesOption = False,
    dry_run: DryRunOption = False,
) -> None:
    """Put the firmware on a board, by avrdude, and try it out; nothing moves."""

    def go() -> int:
        place = place_of(language.load(config), device, None)
        return flashed(place, board, yes=yes, dry_run=dry_run, as_json=as_json)

    leave(go, as_json, HALF_WRITTEN)
