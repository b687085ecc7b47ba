"""Everything in the configuration file, one key after the other, to be looked at and changed.

Rule 1: what is typed is checked as the file will be, at every key press, by the same sentences.
Rule 2: a file that has changed since somebody looked at it is not written over unseen. The next
        attempt is made with open eyes.
Rule 3: the file stays the one that was found first, also when it is gone meanwhile.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any, Final, get_args, get_origin

import tomlkit
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined
from tomlkit.exceptions import TOMLKitError

from fraese.config.axes import AxesConfig
from fraese.config.config import Config
from fraese.config.edit import AsTyped, as_toml, file_to_write, set_keys, text_of
from fraese.config.file import bounds_of, check_text, choices_of, from_table
from fraese.config.section import Section
from fraese.errors import ConfigError
from fraese.phrases import phrase

#: 10,5 as people write it who have a comma there.
_DECIMAL_COMMA: Final = re.compile(r"([+-]?\d+),(\d+)")
#: Tables whose keys are names that somebody else knows.
_NAMED_ELSEWHERE: Final = frozenset({"keys"})


@dataclass(frozen=True, slots=True)
class Setting:
    """One key of the file.

    Attributes:
        key: with its dots: ``axes.x.pitch_mm``.
        sentence: what it means, with its unit.
        bounds: what it may be, in words; may be empty.
        choices: where there are only some.
        value: what counts from the next start, as it stands in the file; empty: nothing.
        default: the same, where the file does not say.
        given: the file says it.
        is_text: a text, which may be typed without quotes.
        at_once: it counts as soon as it is written.
    """

    key: str
    sentence: str
    bounds: str = ""
    choices: tuple[str, ...] = ()
    value: str = ""
    default: str = ""
    given: bool = False
    is_text: bool = False
    at_once: bool = False

    @property
    def table(self) -> str:
        """Where it stands; empty: above all tables."""
        return self.key.rpartition(".")[0]

    @property
    def name(self) -> str:
        """In its table."""
        return self.key.rpartition(".")[2]


def settings_of(config: Config, raw: Mapping[str, Any]) -> tuple[Setting, ...]:
    """Every key, in the order of the file that explains itself.

    Args:
        config: what was read,
        raw: and what it was read from.
    """
    return tuple(_of_section(config, Config(), "", raw))


def _of_section(section: Section, usual: Any, path: str, raw: Any) -> Iterator[Setting]:
    tables: list[tuple[str, Section, Any]] = []
    for name, field in type(section).model_fields.items():
        value, key = getattr(section, name), f"{path}.{name}" if path else name
        if (value is None and isinstance(section, AxesConfig)) or key in _NAMED_ELSEWHERE:
            continue
        inner = dict(_sections(key, value))
        if inner:
            tables += [(at, each, None) for at, each in inner.items()]
        elif isinstance(value, Section):
            tables.append((key, value, getattr(usual, name, None)))
        else:
            yield _setting(key, field, value, _default(field, usual, name), _at(raw, name))
    for key, each, its_usual in tables:
        below = _at(raw, key.removeprefix(f"{path}." if path else ""))
        yield from _of_section(each, its_usual, key, below)


def _sections(key: str, value: Any) -> Iterator[tuple[str, Section]]:
    """Tables in a table or list of them, by their keys."""
    if isinstance(value, dict | tuple):
        pairs = value.items() if isinstance(value, dict) else enumerate(value)
        yield from ((f"{key}.{at}", each) for at, each in pairs if isinstance(each, Section))


def _at(raw: Any, place: str) -> Any:
    for part in place.split("."):
        if isinstance(raw, list):
            raw = raw[int(part)]
        else:
            raw = raw.get(part) if isinstance(raw, Mapping) else None
    return raw


def _default(field: FieldInfo, usual: Any, name: str) -> Any:
    if usual is not None and hasattr(usual, name):
        return getattr(usual, name)
    found = field.get_default(call_default_factory=True, validated_data={})
    return None if found is PydanticUndefined else found


def _setting(key: str, field: FieldInfo, value: Any, usual: Any, raw: Any) -> Setting:
    found = choices_of(field.annotation, field.metadata)
    choices = tuple(str(each) for each in found)
    kinds = {type(each) for each in found} or _kinds(field.annotation)
    return Setting(
        key,
        field.description or "",
        bounds_of(field.metadata).strip(" ()"),
        choices,
        _written(value),
        _written(usual),
        given=raw is not None,
        is_text=str in kinds,
    )


def _kinds(annotation: Any) -> set[Any]:
    """Those of a value that may be of one or the other."""
    return (
        {annotation}
        if get_origin(annotation) in (dict, tuple)
        else {annotation, *get_args(annotation)}
    )


def _written(value: Any) -> str:
    if value is None or isinstance(value, Section | dict):
        return ""
    return as_toml(value)


class SettingsFile:
    """The file that counts, or the one that would be made.

    Args:
        named: by the user; None: the one that is found.
        is_at_once: whether a key counts as soon as it is written.
        also: what else is looked at in a whole configuration; raises ``ConfigError``.
        more: settings that somebody else knows.
    """

    def __init__(
        self,
        named: Path | None = None,
        *,
        is_at_once: Callable[[str], bool] = lambda key: False,
        also: Callable[[Config], object] = lambda config: None,
        more: Callable[[Config], Sequence[Setting]] = lambda config: (),
    ) -> None:
        self._path = file_to_write(named)
        self._is_at_once = is_at_once
        self._also = also
        self._more = more
        self._known = ""
        self._raw: dict[str, Any] = {}

    @property
    def path(self) -> str:
        """Of the file."""
        return str(self._path)

    @property
    def is_there(self) -> bool:
        """There is such a file; else it is made with the first change."""
        return self._path.exists()

    def read(self) -> tuple[Setting, ...]:
        """Everything, as the file says now.

        Raises:
            ConfigError: if it cannot be read, or is refused.
        """
        self._known = text_of(self._path)
        config = check_text(self._known, self.path)
        self._raw = tomllib.loads(self._known, parse_float=Decimal)
        found = (*settings_of(config, self._raw), *self._more(config))
        return tuple(replace(each, at_once=self._is_at_once(each.key)) for each in found)

    def other(self, key: str) -> Setting:
        """One that ``read`` does not have, such as a key of a new tool."""
        return Setting(key, "", at_once=self._is_at_once(key))

    def check(self, setting: Setting, typed: str) -> None:
        """See whether this would do.

        Raises:
            ConfigError: what is wrong with it, and what would be right.
        """
        value = tomllib.loads(f"value = {as_meant(setting, typed)}", parse_float=Decimal)["value"]
        raw = deepcopy(self._raw)
        place: Any = raw
        *tables, name = setting.key.split(".")
        try:
            for table in tables:
                place = (
                    place[int(table)] if isinstance(place, list) else place.setdefault(table, {})
                )
            place[name] = value
        except (TypeError, AttributeError, ValueError, IndexError) as error:
            raise ConfigError(phrase("{key}: there is no such place.", key=setting.key)) from error
        self._also(from_table(raw, self._path.name))

    def write(self, setting: Setting, typed: str | None) -> Config:
        """Change one key; None: take it out, so that its default holds.

        Returns:
            the whole configuration as it stands now.

        Raises:
            ConfigError: if the file cannot be written, has changed, or would be refused.
        """
        value = None if typed is None else AsTyped(as_meant(setting, typed))
        if typed is not None:
            self.check(setting, typed)
        try:
            set_keys(self._path, {setting.key: value}, self._known)
        finally:
            # Whoever is told that it has changed knows it by then.
            with suppress(ConfigError):
                self.read()
        return check_text(self._known, self.path)


def as_meant(setting: Setting, typed: str) -> str:
    """What somebody has typed, as it stands in a file: texts without quotes, numbers with comma.

    Raises:
        ConfigError: if nothing was typed.
    """
    text = typed.strip()
    if not text and not setting.is_text:
        raise ConfigError(phrase("{key}: type a value.", key=setting.key))
    if comma := _DECIMAL_COMMA.fullmatch(text):
        return f"{comma[1]}.{comma[2]}"
    if not setting.is_text or text.startswith(('"', "'")):
        with suppress(TOMLKitError, ValueError):
            tomlkit.value(text)
            return text
    return tomlkit.item(text).as_string()
