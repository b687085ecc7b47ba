"""The command line: the composition root."""

import os
import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperGroup

from fraese.cli import completion
from fraese.cli.language import LanguageOption, as_the_system, named_in, translated
from fraese.cli.options import ConfigOption, FreshOption, StateOption, TraceOption
from fraese.cli.output import open_standard_files
from fraese.cli.table import MODULES, Commands, commands_of
from fraese.compiled import FORM
from fraese.phrases import shown

app = typer.Typer(
    cls=Commands,
    name="fraese",
    help="Machine control for stepper-driven mills, in the terminal. Without a command: the app.",
    no_args_is_help=False,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _say_version(wanted: bool) -> None:
    """The version, and in which form it runs."""
    if wanted:
        from importlib.metadata import version  # Nobody else pays for it.

        typer.echo(f"fraese {version('fraese')}, {shown(FORM.in_words())}")
        raise typer.Exit


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
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            help="Say which version this is, compiled or plain.",
            is_eager=True,
            callback=_say_version,
        ),
    ] = False,
) -> None:
    """Without a command, start the app."""
    if context.invoked_subcommand is not None:
        # What was said in front of the command holds for it.
        given = {"config": config, "state": state, "fresh": fresh or None, "trace": trace}
        given = {name: value for name, value in given.items() if value is not None}
        inner = dict.fromkeys(_names_within(context.invoked_subcommand), given)
        context.default_map = {context.invoked_subcommand: {**given, **inner}}
        return

    # Textual takes a quarter of a second to import; headless commands do not pay for it.
    from fraese.cli import theapp
    from fraese.cli.leaving import leave
    from fraese.cli.shared import Drive

    on = Drive(config=config, state=state, fresh=fresh, trace=trace)
    leave(lambda: theapp.run(on, file))


def _names_within(command: str) -> list[str]:
    """Commands of a command."""
    module = MODULES.get(command)
    found = commands_of(module)[command] if module else None
    return list(found.commands) if isinstance(found, TyperGroup) else []


def main() -> None:
    """Entry point."""
    open_standard_files()
    named_in(sys.argv[1:])
    as_the_system()
    if completion.ASKED_BY in os.environ:
        completion.get_ready()
    translated(typer.main.get_command(app))()
