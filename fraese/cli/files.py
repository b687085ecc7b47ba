"""Commands about files, without motion: programs looked through, the configuration."""

import json
from pathlib import Path

import typer

from fraese.assembly import assemble
from fraese.assembly.misfits import described
from fraese.cli import appkeys, configinit, language
from fraese.cli.leaving import leave
from fraese.cli.looking import Looking
from fraese.cli.options import ConfigOption, FileArgument, HeightMapOption, with_options
from fraese.cli.output import note, say, write
from fraese.cli.shared import StartingPlace
from fraese.config import file as configuration
from fraese.errors import ProgramError, StateError, UsageError, placed
from fraese.gcode.jsonl import as_dict
from fraese.machine import Machine, three_decimals
from fraese.phrases import joined, phrase
from fraese.program.check import Facts, check_program
from fraese.program.context import ProgramContext
from fraese.program.mapped import TakenMap, heights_of, said_of, take_map
from fraese.program.program import require_reference
from fraese.program.source import ProgramSource
from fraese.program.taken import take_program

app = typer.Typer()
config_app = typer.Typer(help="Begin, or look at, a configuration.", no_args_is_help=True)
app.add_typer(config_app, name="config")
config_app.command("keys")(appkeys.keys)
config_app.command("init")(configinit.init)


# --- programs ----------------------------------------------------------------------------------


@app.command()
@with_options
def check(
    file: FileArgument,
    *,
    on: StartingPlace,
    height_map: HeightMapOption = None,
) -> None:
    """Look a program through: everything but the motors."""

    def go() -> int:
        taken = None if height_map is None else take_map(height_map)
        plant = on.plant(at_desk=True)
        context = ProgramContext.of(plant.controller, heights_of(taken))
        facts = _looked_through(file, context)
        plant.controller.close()
        if on.as_json:
            say(json.dumps(_facts_as_dict(facts, plant.controller.machine) | _map_as_dict(taken)))
        else:
            if taken is not None:
                note(said_of(taken))
            _print_facts(file, facts, plant.controller.machine)
        return 0 if facts.ok else UsageError.exit_code

    leave(go, on.as_json)


def _looked_through(file: Path, context: ProgramContext) -> Facts:
    """What is known of a file; that there is nothing to read is known, too."""
    looking = Looking(file.name)
    try:
        require_reference(context)
        return check_program(take_program(file), context, draw=False, tell=looking)
    except ProgramError as error:
        return Facts.refused(error.message)
    except StateError as error:
        return Facts.refused(str(error))
    finally:
        looking.done()


def _facts_as_dict(facts: Facts, machine: Machine) -> dict[str, object]:
    bounds = None
    if facts.low_mm is not None and facts.high_mm is not None:
        bounds = {
            name: [low, high]
            for name, low, high in zip(machine.names, facts.low_mm, facts.high_mm, strict=True)
        }
    return {
        "ok": facts.ok,
        "errors": [{"line": e.line, "message": e.message} for e in facts.errors],
        "warnings": [{"line": w.line, "message": w.message} for w in facts.outside],
        "notes": [{"line": n.line, "message": n.message} for n in facts.notes],
        "bounds_mm": bounds,
        "duration_s": round(facts.duration_s, 3),
        "length_mm": round(facts.length_mm, 3),
        "lines": facts.lines,
        "blocks": facts.blocks,
    }


def _map_as_dict(taken: TakenMap | None) -> dict[str, object]:
    if taken is None:
        return {}
    heights = taken.heights
    return {
        "height_map": {
            "file": str(taken.path),
            "x_mm": [heights.x_mm[0], heights.x_mm[-1]],
            "y_mm": [heights.y_mm[0], heights.y_mm[-1]],
            "heights_mm": [heights.lowest_mm, heights.highest_mm],
            "reference_mm": list(heights.reference_mm),
        }
    }


def _print_facts(file: Path, facts: Facts, machine: Machine) -> None:
    for error in facts.errors:
        note(str(ProgramError(error.message, error.line, str(file))))
    for warning in facts.warnings:
        note(joined(", ", (str(file), warning)))
    for told in facts.notes:
        note(placed(told.message, told.line, str(file)))
    if facts.low_mm is not None and facts.high_mm is not None:
        for axis, low, high in zip(machine.axes, facts.low_mm, facts.high_mm, strict=True):
            reach = axis.with_unit(
                phrase(
                    "{low:>10} to {high:>10}", low=three_decimals(low), high=three_decimals(high)
                )
            )
            say(phrase("{name} {reach} (machine)", name=axis.name.upper(), reach=reach))
    minutes, seconds = divmod(facts.duration_s, 60)
    say(
        phrase(
            "{lines} lines, {blocks} blocks, {length_mm:.1f} mm, {minutes:.0f} min"
            " {seconds:04.1f} s",
            lines=facts.lines,
            blocks=facts.blocks,
            length_mm=facts.length_mm,
            minutes=minutes,
            seconds=seconds,
        )
    )
    say(phrase("ok") if facts.ok else phrase("refused"))


@app.command()
def gcode(file: FileArgument, config: ConfigOption = None) -> None:
    """Print the canonical moves of a program, one JSON object a line; starts at zero."""

    def go() -> int:
        taken = take_program(file)
        settings = language.load(config)
        machine = Machine.from_config(settings)
        nowhere = (0,) * len(machine.axes)
        context = ProgramContext(
            settings, machine, nowhere, nowhere, (True,) * len(machine.axes), {}
        )
        for canonical in ProgramSource(taken, context).moves():
            values = as_dict(canonical)
            if values is not None:
                write(json.dumps(values) + "\n")
        return 0

    leave(go)


# --- configuration -----------------------------------------------------------------------------


@config_app.command("check")
def config_check(config: ConfigOption = None) -> None:
    """See whether the configuration makes sense."""

    def go() -> int:
        settings = language.load(config)
        plant = assemble(settings, at_desk=True)
        plant.controller.close()
        if settings.keys:
            appkeys.table_of(plant.controller, settings, config)
        for text in plant.notes:
            note(text)
        if described(settings):
            note(described(settings))
        found = configuration.find_file(config)
        say(
            phrase("{found}: ok", found=found)
            if found
            else phrase("No configuration file: built-in defaults. ok")
        )
        return 0

    leave(go)


@config_app.command("schema")
def config_schema() -> None:
    """Print the JSON schema of the configuration, for editors."""
    leave(lambda: _printed(json.dumps(configuration.schema(), indent=2) + "\n"))


@config_app.command("default")
def config_default() -> None:
    """Print a configuration file with every key at its default."""
    leave(lambda: _printed(configuration.annotated()))


def _printed(text: str) -> int:
    write(text)
    return 0
