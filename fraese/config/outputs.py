"""What hangs on the free outputs, and when each goes off.

Rule 1: how an output behaves is a row; who switches it off asks for bits, and knows no name.
Rule 2: outputs of one's own have the same row, in the file.
"""

import re
from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

from pydantic import Field, field_validator

from fraese.config.section import Section
from fraese.phrases import phrase

_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,20}")

#: The only pin behind which a board has a timer for it.
PULSED_PIN: Final = 14


class OutputConfig(Section):
    """One free output on a control pin."""

    in_one_line = "{ pin = 14, active_high = true }"

    pin: Literal[1, 14, 16, 17] = Field(description="DB25 pin of the control register.")
    active_high: bool = Field(True, description="Whether a high pin means on.")


class LaserConfig(OutputConfig):
    """A laser on a free output, and whether S sets its power."""

    pwm: bool = Field(
        False,
        description=(
            "S sets the power by pulses (on a bridge, pin 14), with M4 in proportion to the speed;"
            " else the laser is on or off."
        ),
    )
    power_max_s: float = Field(1000, gt=0, le=1e6, description="The S word of full power.")
    pwm_hz: float = Field(
        1000,
        ge=61,
        le=62_500,
        description=(
            "Pulses a second; the nearest of 61, 122, 244, 488, 977, 1953, 7812 and 62500 is taken."
        ),
    )


class OwnOutput(OutputConfig):
    """A free output that a word of one's own switches."""

    pin: Literal[1, 14, 16, 17] = Field(16, description="DB25 pin of the control register.")
    off_when_cancelled: bool = Field(
        True, description="Whether it goes off when a job is cancelled or fails."
    )
    off_at_rest: bool = Field(False, description="Whether it is off whenever the motors stand.")


class OutputRow(NamedTuple):
    """How an output behaves.

    Attributes:
        off_when_cancelled: it goes off when a job is cancelled or fails,
        off_when_done: and also when it has come to its end.
        off_at_rest: it is off whenever the motors stand, also within a job.
    """

    off_when_cancelled: bool = False
    off_when_done: bool = False
    off_at_rest: bool = False


#: Outputs that fraese itself switches.
ROWS: Final[Mapping[str, OutputRow]] = {
    "spindle": OutputRow(off_when_cancelled=True),
    "coolant": OutputRow(off_when_cancelled=True),
    "laser": OutputRow(off_when_cancelled=True, off_when_done=True, off_at_rest=True),
    "enable": OutputRow(),
    "heartbeat": OutputRow(),
}


class OutputsConfig(Section):
    """What hangs on the free outputs; what is not named is switched by hand."""

    spindle: OutputConfig | None = Field(None, description="Spindle relay.")
    coolant: OutputConfig | None = Field(None, description="Coolant or extraction relay.")
    laser: LaserConfig | None = Field(
        None,
        description=(
            "Laser: follows M3, M4, M5 and S0 without a stop, dark along rapids and whenever the"
            " motors stand."
        ),
    )
    enable: OutputConfig | None = Field(
        None,
        description=(
            "Enable line of step/direction drives; without it their current cannot be switched off."
        ),
    )

    heartbeat: OutputConfig | None = Field(
        None,
        description=(
            "Charge pump: toggles while the step loop of a parallel port lives, for drives that"
            " switch off without it."
        ),
    )

    own: dict[str, OwnOutput] = Field(
        default_factory=dict,
        description="Outputs of one's own, by a name of one's own, for M-codes of one's own.",
    )

    @field_validator("own")
    @classmethod
    def _are_names(cls, value: dict[str, OwnOutput]) -> dict[str, OwnOutput]:
        for name in value:
            if not _NAME.fullmatch(name) or name in ROWS:
                raise ValueError(
                    phrase(
                        "outputs are named in small letters, as in [outputs.own.air], and not like"
                        ' one of fraese; "{name}" is no such name',
                        name=name[:40],
                    )
                )
        return value

    def configured(self) -> list[tuple[str, OutputConfig]]:
        """Names and pins of the outputs there are; the place is the bit that a driver knows."""
        ours = [(name, getattr(self, name)) for name in ROWS]
        return [(name, output) for name, output in (*ours, *self.own.items()) if output is not None]

    @property
    def rows(self) -> Mapping[str, OutputRow]:
        """How the outputs that there are behave, by name."""
        own = {
            name: OutputRow(output.off_when_cancelled, off_at_rest=output.off_at_rest)
            for name, output in self.own.items()
        }
        return {name: own.get(name) or ROWS[name] for name, _ in self.configured()}

    def off_after(self, *, done: bool) -> int:
        """Bits of those that are off after a job that has come to its end, or has not."""
        rows = self.rows.items()
        return self.mask(
            *(
                name
                for name, row in rows
                if row.off_when_done or (row.off_when_cancelled and not done)
            )
        )

    @property
    def off_at_rest(self) -> int:
        """Bits of those that are off whenever the motors stand."""
        return self.mask(*(name for name, row in self.rows.items() if row.off_at_rest))

    def bit(self, name: str) -> int | None:
        """Bit of an output, or None where nothing hangs on it."""
        names = [name for name, _ in self.configured()]
        return names.index(name) if name in names else None

    def mask(self, *names: str) -> int:
        """Bits of those of these outputs that there are."""
        bits = (self.bit(name) for name in names)
        return sum(1 << bit for bit in bits if bit is not None)
