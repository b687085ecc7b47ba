"""What is wired to what: card, port, outputs, switches, probe, and the current at standstill."""

from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator

from fraese.config.chosen import NameOf, known_port
from fraese.config.section import Section
from fraese.peers import CARDS, PORTS


class CardConfig(Section):
    """The electronics between port and motors."""

    kind: Annotated[str, NameOf(CARDS)] = Field(
        "smc1500",
        description=(
            'Phase-current card ("smc1500", also SMC800) or step/direction drives ("stepdir").'
        ),
    )
    table: str = Field(
        "motrun",
        description=("Phase table: motrun, field-60, field-20, full-step, or its bytes in hex."),
    )
    levels: Literal["field", "seed"] = Field(
        "field",
        description=(
            "What the middle current codes mean: field 01 = 60 %, 10 = 20 %; seed: vice versa."
        ),
    )
    holding_percent: int = Field(
        0,
        ge=0,
        le=100,
        description=(
            "Current at standstill when it is held, per cent of the running current; 0: off."
        ),
    )
    profile: Literal["x4step", "paper"] = Field(
        "x4step", description=("Pulse timing of step/direction drives.")
    )
    clock_idles_high: bool = Field(False, description="Resting level of the clock lines.")
    forward_high: bool = Field(True, description="Level of the direction lines for positive steps.")


class PortConfig(Section):
    """How the registers are reached."""

    kind: Annotated[str, NameOf(PORTS)] = Field(
        "simulation",
        description=(
            "The simulated mill; a parallel port by its driver, or by its address (root only); a"
            " bridge on a serial port."
        ),
    )
    device: str = Field(
        "",
        description=(
            'Full path, for "ppdev" and "bridge"; empty: /dev/parport0, or the only board that'
            " looks like an Arduino."
        ),
    )
    baud: int = Field(
        250_000,
        ge=9_600,
        le=2_000_000,
        description='Rate of the serial port, for "bridge": the one the firmware was built for.',
    )
    record: str = Field(
        "",
        description=(
            "Waveform file (.vcd) of all that goes over the port, of the latest command; empty:"
            " none is written. --trace comes before it."
        ),
    )
    base: int = Field(
        0x378,
        ge=0x100,
        le=0xFFFC,
        multiple_of=4,
        description=(
            'I/O address of the data register, for "devport"; 888 is 0x378, the first port of most'
            " machines."
        ),
    )

    @field_validator("device")
    @classmethod
    def _as_the_port_has_it(cls, value: str, info: ValidationInfo) -> str:
        kind = info.data.get("kind")  # none if that was refused already
        if kind is not None and (fault := known_port(kind).device_fault(value)):
            raise ValueError(fault)
        return value

    @property
    def parallel_device(self) -> str:
        """Device file for ppdev."""
        return self.device or "/dev/parport0"


class RealtimeConfig(Section):
    """The process that makes the steps on a parallel port."""

    core: int | None = Field(
        None,
        ge=0,
        description="Processor that it stays on; without one, the one that is disturbed least.",
    )
    silent_s: float = Field(
        2,
        ge=0.2,
        le=60,
        description=(
            "When the program hangs for so long while motors run, it brakes and switches off, s;"
            " so does a bridge."
        ),
    )
    bridge_silent_s: float = Field(
        0.5,
        ge=0.2,
        le=60,
        description=(
            "A bridge brakes when the program is dead or stopped for so long, s; not given, and"
            " silent_s is: the same."
        ),
    )
    heartbeat_hz: float = Field(
        100, gt=0, le=500, description="Periods a second of outputs.heartbeat."
    )

    @property
    def silence_of_bridge_s(self) -> float:
        """What a bridge is told: older configurations know one time for both."""
        given = self.model_fields_set
        if "silent_s" in given and "bridge_silent_s" not in given:
            return self.silent_s
        return self.bridge_silent_s

    @property
    def busy_s(self) -> float:
        """So long a bridge is told that the program lives, though nobody looks at the line."""
        return max(0.0, self.silent_s - self.silence_of_bridge_s)


class StandstillConfig(Section):
    """Current between jobs."""

    current: Literal["off", "hold"] = Field(
        "off", description=("Motors off at standstill, or on holding current.")
    )
    delay_s: float = Field(
        0,
        ge=0,
        le=3600,
        description=("Wait after the end of a run before the current is changed, s."),
    )
    settle_ms: float = Field(
        20,
        ge=0,
        le=5000,
        description=("Wait after switching the current on, before the first step, ms."),
    )
