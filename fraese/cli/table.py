"""Commands by name, each with the module that has it: only the one that is given is imported.

Rule 1: a command costs what it imports, so ``fraese check`` does not pay for the bridge.
Rule 2: one more command is one more word here; its module has a typer app of that name or with a
        command of that name.
"""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, Final

import typer
from typer.core import TyperGroup

from fraese.cli.language import translated

#: Module of ``fraese.cli``, in the order of the help.
MODULES: Final[Mapping[str, str]] = {
    name: module
    for module, names in {
        "motion": "run resume move jog home frame switches zero trust where",
        "serve": "serve",
        "heights": "probe-map",
        "calibrate": "calibrate",
        "files": "check gcode config",
        "ports": "ports",
        "bridge": "bridge",
        "doctor": "doctor",
        "bench": "bench",
        "x4step": "x4step",
        "scancodes": "scancodes",
        "trace": "trace",
        "engrave": "engrave",
        "alarms": "alarms",
        "completion": "completion",
    }.items()
    for name in names.split()
}


#: A command of click, which typer brings along under a name of its own, or does not.
Command = Any


def commands_of(module: str) -> Mapping[str, Command]:
    """What a module of the command line has, by name."""
    # Within another app: one with a name of its own is one command there, with others in it.
    outer = typer.Typer(rich_markup_mode=None)
    outer.add_typer(import_module(f"fraese.cli.{module}").app)
    return typer.main.get_group(outer).commands


class Commands(TyperGroup):
    """Commands that are imported when they are asked for."""

    def list_commands(self, ctx: Any) -> list[str]:
        """All of them."""
        return list(MODULES)

    def get_command(self, ctx: Any, cmd_name: str) -> Command:
        """One of them."""
        module = MODULES.get(cmd_name)
        return translated(commands_of(module)[cmd_name]) if module else None
