"""Completion of commands and options in a shell.

eval "$(fraese completion bash)"    in ~/.bashrc
"""

from enum import StrEnum
from typing import Annotated, Final

import typer

from fraese.cli.leaving import leave
from fraese.cli.output import say

app = typer.Typer()


class Shell(StrEnum):
    """Shells that can complete."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"


#: A shell that asks for words says so here; as typer makes it of the program's name.
ASKED_BY: Final = "_FRAESE_COMPLETE"


def get_ready() -> None:
    """A shell asks: typer is to know the shells, which it learns only to install itself."""
    from typer._completion_classes import completion_init

    completion_init()


def script_for(shell: str) -> str:
    """What the shell has to be told; it asks ``fraese`` itself then."""
    from typer._completion_shared import get_completion_script

    return get_completion_script(prog_name="fraese", complete_var=ASKED_BY, shell=shell)


@app.command()
def completion(
    shell: Annotated[Shell, typer.Argument(metavar="SHELL", help="bash, zsh or fish.")],
) -> None:
    """Print what makes a shell complete commands and options."""

    def go() -> int:
        say(script_for(shell.value))
        return 0

    leave(go)
