"""The configuration file: found, read, refused in one sentence, explained.

Rule 1: what is found first is used: the file named by the user, ``fraese.toml`` in the working
        directory, the user's configuration folder, the built-in defaults (a simulated mill).
Rule 2: numbers are read as decimals, so that steps per millimetre are exact.
Rule 3: a complaint names file and key, says what is wrong and what would be right.
"""

import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import platformdirs
from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from fraese.config.axes import AxesConfig
from fraese.config.axis import LinearAxis, RotaryAxis
from fraese.config.chosen import NameOf
from fraese.config.config import Config
from fraese.config.outputs import OwnOutput
from fraese.config.section import Section, Truth
from fraese.config.simulation import SimulatedAxis
from fraese.config.solid import SimulatedSolid
from fraese.config.switches import OwnInput
from fraese.config.work import ToolConfig
from fraese.errors import ConfigError
from fraese.phrases import Phrase, joined, phrase, reason

FILE_NAME = "fraese.toml"
#: Values in messages are cut behind this many characters.
_SHOWN_CHARACTERS = 60
_SCALARS = (int, float, str, Decimal, Truth)
#: What the checker says of its own types, and how one says it of a TOML file.
_TOML_WORDS: Mapping[str, str] = {
    r"^Value error, ": "",
    r"^Decimal input should be.*": phrase("must be a number"),
    r"^Input should be": "must be",
    r"^Field required": phrase("must be given"),
    r"^(Tuple|Value) should have": "must have",
    r" after validation|, (unable to|got a) [a-z ]+": "",
    r"a valid (tuple|list)": "a list",
    r"a valid integer|an? integer": "a whole number",
    r"a valid number|a valid decimal": "a number",
    r"a valid string": "a text in quotes",
    r"a valid boolean": "true or false",
    r"a valid dictionary( or instance of \w+)?": "a table",
    r"\.$": "",
}
#: The same of its complaints with a number or a choice in them.
_WITH_BOUND: Mapping[str, Callable[[str], Phrase]] = {
    "greater_than": lambda bound: phrase("must be greater than {bound}", bound=bound),
    "greater_than_equal": lambda bound: phrase(
        "must be greater than or equal to {bound}", bound=bound
    ),
    "less_than": lambda bound: phrase("must be less than {bound}", bound=bound),
    "less_than_equal": lambda bound: phrase("must be less than or equal to {bound}", bound=bound),
    "literal_error": lambda choices: phrase("must be {choices}", choices=_either(choices)),
}
_BEFORE_BOUND = re.compile(r"^must be ((greater|less) than (or equal to )?)?")
#: Kinds of a table that the place of a complaint names, but not the file.
_KINDS: Mapping[str, type[Section]] = {"linear": LinearAxis, "rotary": RotaryAxis}
#: By the name of a table of the whole file: what may stand in it, where its keys are no fixed ones.
_BY_EXAMPLE: Mapping[str, tuple[str, ...]] = {
    "macros": (
        "    [[macros]]",
        '    name = "Park"',
        '    key = "f9"',
        '    lines = ["G53 G0 Z-1", "G53 G0 X10 Y190"]',
    ),
    "keys": ("[keys]", 'go_to = "f8"', 'jog_x_plus = ["right", "d"]'),
}
#: Tables of which there may be several, and the name of one that serves as an example.
_NAMED_AT_WILL: Mapping[type[Section], str] = {
    ToolConfig: "1",
    SimulatedAxis: "x",
    SimulatedSolid: "plate",
    OwnOutput: "air",
    OwnInput: "x",
}


def find_file(named: Path | None = None) -> Path | None:
    """The configuration file that counts; None: built-in defaults.

    Raises:
        ConfigError: if a file was named and is not there.
    """
    if named is not None:
        if not is_plain_file(named):
            raise ConfigError(phrase("{named}: there is no such configuration file.", named=named))
        return named
    user = Path(platformdirs.user_config_dir("fraese")) / FILE_NAME
    return next((path for path in (Path(FILE_NAME), user) if is_plain_file(path)), None)


def is_plain_file(path: Path) -> bool:
    """Whether there is a file; what only looks like one never means that there is none.

    Raises:
        ConfigError: if that cannot be seen (a name too long, a folder that cannot be read), or
            if something else stands there: a folder, a pipe, a link to nowhere.
    """
    try:
        found = path.is_file()
        if found or not os.path.lexists(path):
            return found
    except OSError as error:
        raise ConfigError(
            phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
        ) from error
    raise ConfigError(
        phrase("{path}: is no plain file; a configuration is read from one.", path=path)
    )


def load(named: Path | None = None) -> Config:
    """Read and check the configuration.

    Raises:
        ConfigError: one sentence with file, key and what would be right.
    """
    path = find_file(named)
    return Config() if path is None else from_table(_read(path), str(path))


def check_text(text: str, place: str) -> Config:
    """Check what a file holds, or would hold.

    Raises:
        ConfigError: one sentence with place, key and what would be right.
    """
    return from_table(_parsed(text, place), place)


def _read(path: Path) -> dict[str, Any]:
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise ConfigError(
            phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
        ) from error
    except UnicodeDecodeError as error:
        raise ConfigError(phrase("{path}: is not a text file in UTF-8.", path=path)) from error
    return _parsed(text, str(path))


def _parsed(text: str, place: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(
            phrase("{place}: is not valid TOML: {error}.", place=place, error=error)
        ) from error
    except (RecursionError, ValueError) as error:
        # Of these the reader says no more: brackets in brackets, a number of thousands of digits.
        raise ConfigError(
            phrase(
                "{place}: is no configuration: brackets are nested too deep, or a number is"
                " too long.",
                place=place,
            )
        ) from error


def from_table(raw: dict[str, Any], place: str) -> Config:
    """Check a table that was read already.

    Raises:
        ConfigError: one sentence with place, key and what would be right.
    """
    try:
        return Config.model_validate(raw)
    except ValidationError as error:
        raise ConfigError(joined(": ", (place, _sentence(error)))) from error


def _sentence(error: ValidationError) -> str:
    """The first complaint as one sentence; how many more there are."""
    complaints = error.errors(include_url=False)
    first = complaints[0]
    place = [part for part in first["loc"] if part not in _KINDS]
    key = ".".join(str(part) for part in place)
    if first["type"] == "extra_forbidden":
        parent = _section_at(first["loc"][:-1])
        known = ", ".join(sorted(parent.model_fields)) if parent else ""
        text = phrase("unknown key {key}", key=key) + (
            phrase("; known here: {known}", known=known) if known else ""
        )
    else:
        said = _complaint(first)
        given = first["input"]
        if isinstance(given, _SCALARS):
            said = phrase("{said}, not {given}", said=said, given=_short(given))
        text = joined(": ", (key, said)) if key else said
    more = len(complaints) - 1
    return text + (phrase(" (and {more} more)", more=more) if more else "") + "."


def _complaint(details: ErrorDetails) -> Phrase:
    """What the checker complains of, as one says it of a TOML file."""
    own = details.get("ctx", {}).get("error")
    if isinstance(own, ValueError) and isinstance(own.args[0], Phrase):
        return own.args[0]
    said = details["msg"]
    for theirs, ours in _TOML_WORDS.items():
        said = re.sub(theirs, ours, said)
    with_bound = _WITH_BOUND.get(details["type"])
    return with_bound(_BEFORE_BOUND.sub("", said)) if with_bound else Phrase(said, said)


def _either(choices: str) -> str:
    others, either, last = choices.rpartition(" or ")
    return phrase("{others} or {last}", others=others, last=last) if either else choices


def _short(value: object) -> str:
    """A value on one line of bounded length."""
    text = " ".join(str(value).split())
    return text if len(text) <= _SHOWN_CHARACTERS else text[:_SHOWN_CHARACTERS] + "..."


def _section_at(location: tuple[int | str, ...]) -> type[Section] | None:
    """The model behind a dotted place in the file."""
    section: Any = Config
    for part in location:
        if section in _NAMED_AT_WILL:
            break  # the name of one of them: its keys are those of every other
        if section is AxesConfig and part in section.model_fields and part != "names":
            continue  # which keys an axis has, its kind says
        if part in _KINDS:
            section = _KINDS[str(part)]
            continue
        field = section.model_fields.get(part)
        if field is None:
            return None
        options = [field.annotation, *getattr(field.annotation, "__args__", ())]
        section = next((o for o in options if isinstance(o, type) and issubclass(o, Section)), None)
        if section is None:
            return None
    return section  # type: ignore[no-any-return]


def schema() -> dict[str, Any]:
    """JSON schema for editors."""
    return Config.model_json_schema()


def annotated(config: Config | None = None, about: str = "") -> str:
    """A configuration as a file, every key with its sentence, unit and bounds.

    Args:
        config: its values; by default all are the defaults.
        about: what machine it is.
    """
    lines = [
        "# Configuration of fraese. Every key is optional; what stands here is the default."
        if config is None
        else f"# {about}. Every key of fraese stands here, with its value.",
        "# Found in the working directory, else in the user's configuration folder.",
    ]
    _annotate(config or Config(), "", lines)
    return "\n".join(lines) + "\n"


def _annotate(section: Section, path: str, lines: list[str]) -> None:
    tables: list[tuple[str, Section]] = []
    if path:
        lines += ["", f"# {(type(section).__doc__ or '').strip()}", f"[{path}]"]
    for key, field in type(section).model_fields.items():
        value = getattr(section, key)
        if isinstance(value, Section):
            tables.append((key, value))
            continue
        if value is None and isinstance(section, AxesConfig):
            continue  # one of the letters that this machine has not
        if type(section) in _NAMED_AT_WILL and key not in section.model_fields_set:
            continue  # the example above it has every key
        lines.append(f"# {field.description}{_one_of(field)}{bounds_of(field.metadata)}")
        if not path and key in _BY_EXAMPLE:
            lines += [f"#{line}" for line in _BY_EXAMPLE[key]]
            continue
        if isinstance(value, dict):
            lines += _example_table(f"{path}.{key}" if path else key, field.annotation)
            tables += [(f"{key}.{name}", named) for name, named in value.items()]
            continue
        lines.append(_entry(key, value, field.annotation))
    if isinstance(section, AxesConfig):
        lines += [f"# {line}" for line in section.example]
    for key, value in tables:
        _annotate(value, f"{path}.{key}" if path else key, lines)


def _entry(key: str, value: Any, annotation: Any) -> str:
    if value is None:
        return f"#{key} = {_example(annotation)}"
    if isinstance(value, Decimal):
        return f"{key} = {value}"
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return f"{key} = {_as_toml(value)}"


def _example_table(path: str, annotation: Any) -> list[str]:
    """A table of which there is none by default, as a remark."""
    section = next(kind for kind in get_args(annotation) if kind in _NAMED_AT_WILL)
    lines = [f"#[{path}.{_NAMED_AT_WILL[section]}]"]
    for key, field in section.model_fields.items():
        if key.endswith("_deg"):
            continue  # the example is a linear axis
        lines.append(f"# {field.description}{bounds_of(field.metadata)}")
        value = field.examples[0] if field.examples else field.default
        lines.append("#" + _entry(key, value, field.annotation).removeprefix("#"))
    return lines


def _example(annotation: Any) -> str:
    """A value for a key that has none by default."""
    if choices := choices_of(annotation):
        return _as_toml(choices[-1])
    kinds = get_args(annotation)
    if any(get_origin(kind) is tuple for kind in kinds):
        return '["z", "x", "y"]'
    tables = (
        kind.in_one_line for kind in kinds if isinstance(kind, type) and issubclass(kind, Section)
    )
    examples = {Decimal: "360", float: "-2.0", int: "1"}
    numbers = (text for kind, text in examples.items() if kind in kinds)
    return next(iter([*tables, *numbers]))


def choices_of(annotation: Any, metadata: Sequence[Any] = ()) -> tuple[Any, ...]:
    """What a field may be, if that is a list; also one that may be left out."""
    for item in metadata:
        if isinstance(item, NameOf):
            return item.seam.names
    may_be_left_out = type(None) in get_args(annotation)
    for option in get_args(annotation) if may_be_left_out else (annotation,):
        if get_origin(option) is Literal:
            return get_args(option)
    return ()


def _one_of(field: FieldInfo) -> str:
    choices = ", ".join(str(each) for each in choices_of(field.annotation, field.metadata))
    return f" One of: {choices}." if ", " in choices else ""


_SIGNS: Mapping[str, Callable[[float], Phrase]] = {
    "gt": lambda bound: phrase("above {bound:.12g}", bound=bound),
    "ge": lambda bound: phrase("from {bound:.12g}", bound=bound),
    "lt": lambda bound: phrase("below {bound:.12g}", bound=bound),
    "le": lambda bound: phrase("up to {bound:.12g}", bound=bound),
}


def bounds_of(metadata: list[Any]) -> str:
    """What the field's limits are, in brackets; nothing without limits."""
    found = [
        _SIGNS[name](getattr(item, name))
        for item in metadata
        for name in _SIGNS
        if getattr(item, name, None) is not None
    ]
    return joined("", (" (", joined(", ", found), ")")) if found else ""


def _as_toml(value: Any) -> str:
    import tomlkit  # Nobody needs it who only reads.

    return str(tomlkit.item(value).as_string())
