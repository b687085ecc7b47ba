"""The test program of X4Step as a command."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from fraese.assembly.drivers import ClockName
from fraese.cli import language
from fraese.cli.leaving import leave
from fraese.cli.options import VALUES, ConfigOption, KeysOption, RealTimeOption, TraceOption
from fraese.cli.output import tell
from fraese.cli.shared import MOTORS_OFF
from fraese.errors import PortError, UsageError
from fraese.phrases import phrase
from fraese.x4step import X4Init, X4NoErr, X4ReInit
from fraese.x4step.bench import Bench, Console
from fraese.x4step.codes import PORTS
from fraese.x4step.consoles import ScriptConsole, TerminalConsole
from fraese.x4step.keys import Keyboard
from fraese.x4step.surroundings import (
    WantedKeys,
    around,
    in_place,
    terminal_keyboard,
    wanted_keys,
)

app = typer.Typer()


@app.command(context_settings=VALUES)
def bench(
    lpt: Annotated[str, typer.Argument(metavar="[LPT]", help="Parallel port, 1 to 4.")] = "1",
    config: ConfigOption = None,
    real_time: RealTimeOption = False,
    trace: TraceOption = None,
    keys: KeysOption = None,
) -> None:
    """Try four motors with clock and direction from a prompt, as X4Step's TEST did."""
    leave(lambda: _bench(lpt, config, real_time, trace, keys), cancelled=MOTORS_OFF)


def _bench(
    lpt: str, file: Path | None, real_time: bool, trace: Path | None, keys: str | None
) -> int:
    if lpt not in map(str, PORTS):
        raise UsageError(
            phrase('"{lpt}" is no parallel port: it is 1 to 4, as in fraese bench 2.', lpt=lpt)
        )
    config = language.load(file)
    wanted = wanted_keys(config.x4step, keys)
    console, keyboard, clock = _spoken_with(wanted, real_time)
    with in_place(around(config, keyboard, clock, trace=trace)):
        if X4Init(int(lpt)) is not X4NoErr:
            raise PortError(phrase("LPT{lpt} cannot be used.", lpt=lpt))
        try:
            Bench(console).run()
        finally:
            X4ReInit()
    return 0


def _spoken_with(wanted: WantedKeys, real_time: bool) -> tuple[Console, Keyboard, ClockName]:
    """A person at a terminal, in real time; or a script, as fast as it goes."""
    if sys.stdin.isatty():
        keyboard = terminal_keyboard(wanted)
        return TerminalConsole(keyboard, sys.stdin, _say, _prompt), keyboard, "paced"
    script = ScriptConsole(sys.stdin.read(), _say, _prompt)
    return script, Keyboard(script.keys), "paced" if real_time else "virtual"


def _say(text: str) -> None:
    tell(text)


def _prompt(text: str) -> None:
    tell(text, end="")
