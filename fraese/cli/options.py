"""Options and arguments that commands share. Nothing of the machine is imported for them."""

import dataclasses
import functools
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final, get_type_hints

import typer

ConfigOption = Annotated[
    Path | None,
    typer.Option(
        "--config", metavar="FILE", help="Configuration file; else ./fraese.toml, else the user's."
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Result as one JSON object on the last line.")
]
StateOption = Annotated[
    Path | None,
    typer.Option("--state", metavar="DIR", help="Folder in which the machine's state is kept."),
]
FreshOption = Annotated[bool, typer.Option("--fresh", help="Forget the state that was kept.")]
TraceOption = Annotated[
    Path | None,
    typer.Option(
        "--trace", metavar="FILE.vcd", help="Write a waveform of all lines, for fraese trace."
    ),
]
RealTimeOption = Annotated[
    bool, typer.Option("--real-time", help="Let the simulated mill take its time.")
]
KeysOption = Annotated[
    str | None,
    typer.Option(
        "--keys",
        metavar="SOURCE",
        help=(
            "Where keys come from: auto, kitty, plain, evdev, or evdev:/dev/input/event3; "
            "else as configured."
        ),
    ),
]
YesOption = Annotated[bool, typer.Option("--yes", help="Answer every question with yes: go on.")]
AnswerOption = Annotated[
    list[str] | None,
    typer.Option(
        "--answer",
        metavar="LINE",
        help='What would be typed at the next question, as in "zero Z"; "" goes on.',
    ),
]
HeightMapOption = Annotated[
    Path | None,
    typer.Option(
        "--height-map", metavar="MAP", help="Bend the moves to heights from fraese probe-map."
    ),
]
FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Program or coordinate list.")]

#: Words such as -1.5 or X-3 are values here, not options.
VALUES: Final = {"ignore_unknown_options": True}

_BY_NAME: Final = inspect.Parameter.KEYWORD_ONLY


def with_options(function: Callable[..., None]) -> Callable[..., None]:
    """Let typer see the fields of the parameter ``on`` as options of their own."""
    hints = get_type_hints(function, include_extras=True)
    on = hints["on"]
    types = get_type_hints(on, include_extras=True)
    shared = {
        field.name: inspect.Parameter(
            field.name, _BY_NAME, default=field.default, annotation=types[field.name]
        )
        for field in dataclasses.fields(on)
    }
    parameters: list[inspect.Parameter] = []
    for name, parameter in inspect.signature(function).parameters.items():
        seen = parameter.replace(kind=_BY_NAME, annotation=hints[name])
        parameters += shared.values() if name == "on" else [seen]

    @functools.wraps(function)
    def command(**values: Any) -> None:
        given = {name: values.pop(name) for name in shared}
        function(on=on(**given), **values)

    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    return command
