"""End switches, switches for referencing, and the probe: which input each is on.

Rule 1: all end switches share one input, unless some have one of their own.
Rule 2: an input that does not stop is for referencing only: a contact there is looked for, and
        means nothing else.
"""

import re
from collections.abc import Sequence
from typing import Final, Literal, NamedTuple

from pydantic import Field, field_validator

from fraese.config.section import Section
from fraese.phrases import phrase

#: DB25 pins of the status register.
StatusPin = Literal[10, 11, 12, 13, 15]

_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,20}")


class SwitchLine(NamedTuple):
    """One input with switches on it.

    Attributes:
        name: empty: the shared one.
        pin: DB25 pin of the status register.
        closed_reads: how its register bit reads with contact.
        ends: names of the ends whose switches are on it.
        stops: contact stops the motors; else it is for referencing only.
    """

    name: str
    pin: int
    closed_reads: int
    ends: frozenset[str]
    stops: bool


class OwnInput(Section):
    """An input of its own for some switches."""

    pin: StatusPin = Field(10, description="DB25 pin of the status register.")
    closed_reads: Literal[0, 1] = Field(
        0, description="How the pin's register bit reads with contact."
    )
    ends: tuple[str, ...] = Field(
        (), examples=[["xmin", "xmax"]], description="Ends whose switches are on it, as in xmin."
    )
    stops: bool = Field(
        True,
        description="Whether contact stops the motors; false: it is for referencing only.",
    )


class SwitchesConfig(Section):
    """The shared end-switch input."""

    mode: Literal["stop", "ignore"] = Field(
        "stop",
        description=("What a contact does: stop the motors, or nothing (for trying things out)."),
    )
    pin: StatusPin = Field(11, description="DB25 pin of the status register.")
    closed_reads: Literal[0, 1] = Field(
        0, description=("How the pin's register bit reads with contact.")
    )
    readings: int = Field(
        3,
        ge=1,
        le=100,
        description=(
            "Equal readings in a row that make or end a contact; 1 is the original's behaviour."
        ),
    )

    own: dict[str, OwnInput] = Field(
        default_factory=dict,
        description=(
            "Inputs of their own for some ends, or for referencing, by a name of one's own; what is"
            " not named there is on the shared one."
        ),
    )

    @field_validator("own")
    @classmethod
    def _are_names(cls, value: dict[str, OwnInput]) -> dict[str, OwnInput]:
        for name in value:
            if not _NAME.fullmatch(name):
                raise ValueError(
                    phrase(
                        'inputs are named in small letters, as in [switches.own.x]; "{name}" is no'
                        " such name",
                        name=name[:40],
                    )
                )
        return value

    def lines(self, ends: Sequence[str]) -> tuple[SwitchLine, ...]:
        """Every input, the shared one first where an end is left for it.

        Args:
            ends: names of all ends that have a switch.
        """
        own = tuple(
            SwitchLine(name, each.pin, each.closed_reads, frozenset(each.ends), each.stops)
            for name, each in self.own.items()
        )
        taken = [line.ends for line in own if line.stops]
        left = frozenset(ends).difference(*taken)
        if taken and not left:
            return own
        return (SwitchLine("", self.pin, self.closed_reads, left, True), *own)


class ProbeConfig(Section):
    """The probe of G38.2 to G38.5."""

    pin: StatusPin | None = Field(
        None,
        description=(
            "DB25 pin of the status register; without one the probe shares the end switches' input."
        ),
    )
    closed_reads: Literal[0, 1] = Field(
        0, description="How the register bit of a pin of its own reads with contact."
    )
