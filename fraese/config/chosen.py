"""Keys whose choices are records: of ours, or of packages of their own.

Rule 1: what is asked of a record here is little, and said here; its class is on a higher floor.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Protocol, cast

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from fraese.peers import CARDS, PORTS, Seam
from fraese.phrases import phrase


class KnownCard(Protocol):
    """What the configuration asks of a card.

    Attributes:
        sockets: motors that it drives at most.
        taken_pins: control pins that it has for itself.
    """

    @property
    def sockets(self) -> int: ...  # noqa: D102 (above)
    @property
    def taken_pins(self) -> Collection[int]: ...  # noqa: D102


class KnownPort(Protocol):
    """What the configuration asks of a port.

    Attributes:
        sets_power: it can set a laser's power by pulses.
    """

    @property
    def sets_power(self) -> bool: ...  # noqa: D102
    def device_fault(self, device: str) -> str:
        """Why ``port.device`` will not do, half a sentence; empty: it will."""


def known_card(kind: str) -> KnownCard:
    """The card of that name.

    Raises:
        ConfigError: if its package cannot be used.
    """
    return cast(KnownCard, CARDS.record(kind))


def known_port(kind: str) -> KnownPort:
    """The port of that name.

    Raises:
        ConfigError: if its package cannot be used.
    """
    return cast(KnownPort, PORTS.record(kind))


@dataclass(frozen=True)
class NameOf:
    """The name of a record of that seam."""

    seam: Seam

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """A text, and one of these."""
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """For editors: those that there are here."""
        return {**handler(schema), "enum": list(self.seam.names)}

    def _checked(self, name: str) -> str:
        if self.seam.has(name):
            return name
        *others, last = (f"'{each}'" for each in self.seam.names)
        choices = phrase("{others} or {last}", others=", ".join(others), last=last)
        raise ValueError(phrase("must be {choices}", choices=choices))
