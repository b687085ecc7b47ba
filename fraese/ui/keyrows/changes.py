"""Keys that somebody has changed: what the configuration says under ``[keys]``.

Rule 1: whoever stands at a machine finds the stop keys where they always are. What works
        everywhere keeps its keys, and nothing else gets them.
Rule 2: in a view a key does one thing. Who takes a key from another action gives that another one.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from itertools import combinations
from typing import Final

from fraese.errors import ConfigError
from fraese.phrases import spoken
from fraese.ui.keyrows.everywhere import PALETTE, QUIT_AT_ONCE, STOP_KEYS
from fraese.ui.keyrows.naming import key_named, shown
from fraese.ui.keyrows.row import Area, Row

#: By the action's name, its keys.
Changes = Mapping[str, Sequence[str]]

_VIEWS: Final = (Area.EVERYWHERE, Area.VIEWS)
#: Which areas are seen at once: the keys of each view.
TOGETHER: Final = (
    frozenset({*_VIEWS, Area.MACHINE, Area.RUNNING}),
    frozenset({*_VIEWS, Area.PROGRAM, Area.RUNNING}),
    frozenset({*_VIEWS, Area.CALIBRATE}),
    frozenset({*_VIEWS, Area.BENCH}),
    frozenset({*_VIEWS, Area.LOG}),
    frozenset({*_VIEWS, Area.SETTINGS}),
)


def changing(rows: Iterable[Row], changes: Changes) -> Callable[[Row], Row]:
    """What makes of a row the one with its changed keys; rows without changes stay.

    Args:
        rows: all commands.
        changes: their keys.

    Raises:
        ConfigError: if an action or a key does not exist, or cannot be had.
    """
    known = {row.name: row for row in rows}
    changed = {known[name]: _with_keys(known[name], keys) for name, keys in _seen(known, changes)}
    return lambda row: changed.get(row, row)


def _seen(known: Mapping[str, Row], changes: Changes) -> Iterator[tuple[str, list[str]]]:
    fixed = {key for row in (QUIT_AT_ONCE, PALETTE) for key in row.each}
    for name, texts in changes.items():
        row = known.get(name)
        if row is None:
            raise ConfigError(_unknown(name, known))
        if row.area is Area.EVERYWHERE:
            raise ConfigError(
                spoken(
                    "{where}: what works everywhere keeps its keys ({keys}); take this line out.",
                    where=_where(name),
                    keys=" ".join(row.each),
                )
            )
        keys = []
        for text in texts:
            key = key_named(text)
            if key is None:
                raise ConfigError(
                    spoken(
                        '{where}: "{text}" is no key; write a character, such as "g", or a'
                        ' name: "f8", "left", "pageup", "ctrl+g".',
                        where=_where(name),
                        text=text[:20],
                    )
                )
            if key in STOP_KEYS:
                raise ConfigError(
                    spoken(
                        "{where}: {key} always stops; choose another key.",
                        where=_where(name),
                        key=key,
                    )
                )
            if key in fixed:
                raise ConfigError(
                    spoken(
                        "{where}: {key} works everywhere; choose another key.",
                        where=_where(name),
                        key=key,
                    )
                )
            keys.append(key)
        yield name, list(dict.fromkeys(keys))


def _unknown(name: str, known: Mapping[str, Row]) -> str:
    near = get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return spoken(
            "{where}: no action is called that, perhaps {near}; fraese config keys lists them all.",
            where=_where(name),
            near=near[0],
        )
    return spoken(
        "{where}: no action is called that; fraese config keys lists them all.", where=_where(name)
    )


def _where(name: str) -> str:
    """The place in the configuration that gives this action its keys."""
    return name if "." in name else f"keys.{name}"


def _with_keys(row: Row, keys: Sequence[str]) -> Row:
    return replace(row, keys=",".join(keys), shown=shown(keys[0]))


def check_each_means_one_thing(rows: Sequence[Row], changes: Changes) -> None:
    """Two actions of one view must not have the same key.

    Args:
        rows: all commands.
        changes: those that were changed are blamed.

    Raises:
        ConfigError: if a key is given twice.
    """
    for together in TOGETHER:
        here = [row for row in rows if row.area in together]
        for one, other in combinations(here, 2):
            for key in one.each:
                if key in other.each:
                    blamed, first = (one, other) if one.name in changes else (other, one)
                    raise ConfigError(
                        spoken(
                            "{where}: {key} is the key of {other} already; give that one"
                            " another key, too.",
                            where=_where(blamed.name),
                            key=shown(key),
                            other=first.name,
                        )
                    )
