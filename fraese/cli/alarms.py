"""The list of alarms, for people and for programs."""

import json
import textwrap
from typing import Annotated

import typer

from fraese.alarms import ALARMS, BY_NUMBER, AlarmKind
from fraese.cli.leaving import leave
from fraese.cli.options import JsonOption
from fraese.cli.output import say
from fraese.errors import UsageError
from fraese.phrases import phrase, shown

app = typer.Typer()


@app.command()
def alarms(
    number: Annotated[
        int | None, typer.Argument(metavar="[NUMBER]", help="One of them; all by default.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Say what an alarm means, what the position is worth after it, and what to do."""

    def go() -> int:
        wanted = ALARMS if number is None else (_numbered(number),)
        if as_json:
            say(json.dumps([_as_dict(kind) for kind in wanted]))
        else:
            say("\n\n".join(_in_words(kind) for kind in wanted))
        return 0

    leave(go, as_json)


def _numbered(number: int) -> AlarmKind:
    kind = BY_NUMBER.get(number)
    if kind is None:
        known = ", ".join(str(known) for known in BY_NUMBER)
        raise UsageError(
            phrase("There is no alarm {number}; there are {known}.", number=number, known=known)
        )
    return kind


def _as_dict(kind: AlarmKind) -> dict[str, object]:
    return {
        "number": kind.number,
        "name": kind.name,
        "what": kind.what,
        "trust": kind.trust.name.lower(),
        "position": kind.trust.value,
        "remedy": kind.remedy,
    }


def _in_words(kind: AlarmKind) -> str:
    lines = [f"{kind.number}  {shown(kind.what)}"]
    for text in (kind.trust.value, kind.remedy):
        lines += textwrap.wrap(shown(text), 92, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines)


def page() -> str:
    """The table of docs/alarms.md."""
    rows = [
        "| alarm | `--json` | what happened | the position | what to do now |",
        "|---:|---|---|---|---|",
    ]
    rows += [
        f"| {kind.number} | `{kind.name}` | {kind.what} | {kind.trust.value} | {kind.remedy} |"
        for kind in ALARMS
    ]
    return "\n".join(rows) + "\n"
