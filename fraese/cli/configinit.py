"""``fraese config init``: a configuration to begin with, of an example machine or of answers."""

import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from fraese.cli.leaving import leave
from fraese.cli.newfile import check_new, new_file
from fraese.cli.output import say, write
from fraese.config import file as configuration
from fraese.config import machines
from fraese.errors import ConfigError, UsageError
from fraese.peers import CARDS
from fraese.phrases import joined, phrase

#: Answers to a question, and what each sets.
_Choices = Mapping[str, tuple[str, Mapping[str, Mapping[str, Any]]]]
_PORTS: Final[_Choices] = {
    "1": (phrase("not at all yet: a simulated mill"), {"port": {"kind": "simulation"}}),
    "2": (phrase("to a parallel port of this computer"), {"port": {"kind": "ppdev"}}),
    "3": (phrase("to a USB bridge (Arduino)"), {"port": {"kind": "bridge"}}),
}
_AXES: Final = "x y z"


def init(
    machine: Annotated[
        str | None,
        typer.Argument(metavar="[MACHINE]", help="An example machine; without one it is asked."),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="The file; - is standard output.")
    ] = Path(configuration.FILE_NAME),
    force: Annotated[bool, typer.Option("--force", help="Overwrite a file that is there.")] = False,
    names: Annotated[bool, typer.Option("--list", help="List the example machines.")] = False,
) -> None:
    """Write a configuration to begin with, every key with its sentence."""

    def go() -> int:
        if names:
            for name in machines.names():
                say(f"{name:16} {machines.about(name)}")
            return 0
        to_file = str(output) != "-"
        if to_file:
            check_new(output, force=force)
        text = machines.whole(machine) if machine else _asked()
        if not to_file:
            write(text)
            return 0
        with new_file(output) as file:
            file.write(text.encode())
        say(phrase("{path}: written; fraese config check looks it through.", path=output))
        return 0

    leave(go)


def _asked() -> str:
    """What comes of the answers.

    Raises:
        UsageError: if nobody is there to ask, or the answers do not go together.
    """
    if not sys.stdin.isatty():
        raise UsageError(
            phrase(
                "Without a terminal name an example machine: {names}.",
                names=joined(", ", machines.names()),
            )
        )
    card = _chosen(phrase("Which electronics drive the motors?"), _cards())
    port = _chosen(phrase("How are they connected?"), _PORTS)
    axes = typer.prompt(phrase("Which axes are there, in the order of the sockets?"), _AXES)
    raw = {**card, **port, "axes": {"names": axes.lower().replace(",", " ").split()}}
    about = phrase("Configuration from answers")
    return configuration.annotated(configuration.from_table(raw, phrase("your answers")), about)


def _cards() -> _Choices:
    """Every card that there is."""
    found: dict[str, str] = {}
    for kind in CARDS.names:
        with suppress(ConfigError):  # One that cannot be used is no choice.
            found[kind] = CARDS.record(kind).about
    return {
        str(number): (about, {"card": {"kind": kind}})
        for number, (kind, about) in enumerate(found.items(), 1)
    }


def _chosen(question: str, choices: _Choices) -> Mapping[str, Mapping[str, Any]]:
    """What is asked until an answer is one of the choices."""
    for number, (text, _) in choices.items():
        say(f"  {number}  {text}")
    while (answer := typer.prompt(question, next(iter(choices)))) not in choices:
        say(phrase("One of: {choices}.", choices=joined(", ", choices)))
    return choices[answer][1]
