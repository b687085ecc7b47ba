"""What the configuration should say: keys with their old and their new value."""

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from fraese.phrases import joined, phrase

Value = bool | int | float | Decimal | str | tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """One key.

    Attributes:
        key: its dotted name.
        old: what is in force.
        new: what is proposed.
    """

    key: str
    old: Value
    new: Value

    def words(self) -> str:
        """The key with both, for people."""
        return phrase(
            "{key}: {old} becomes {new}", key=self.key, old=shown(self.old), new=shown(self.new)
        )


@dataclass(frozen=True, slots=True)
class Proposal:
    """Keys that should be changed together.

    Attributes:
        changes: what differs from what is in force; empty: it is right as it is.
        why: a sentence with the figures that it comes from.
    """

    changes: tuple[Change, ...]
    why: str

    def values(self) -> Mapping[str, Value]:
        """New values by key, to be written."""
        return {change.key: change.new for change in self.changes}

    def words(self) -> str:
        """All of it, for people."""
        return joined("; ", (change.words() for change in self.changes)) or phrase(
            "nothing is to be changed"
        )


def proposal(why: str, *changes: Change) -> Proposal:
    """A proposal of what really changes something."""
    return Proposal(tuple(change for change in changes if change.old != change.new), why)


def shown(value: Value) -> str:
    """A value for people."""
    if isinstance(value, tuple):
        return "[" + ", ".join(shown(each) for each in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:f}" if isinstance(value, Decimal) else f"{value}".removesuffix(".0")
