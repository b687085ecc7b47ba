"""What programs that use the X4Step library find behind LPT1 to LPT4."""

from typing import Literal

from pydantic import Field

from fraese.config.section import Section
from fraese.config.switches import StatusPin
from fraese.config.wiring import PortConfig

KeysName = Literal["auto", "kitty", "plain", "evdev"]


class LptConfig(PortConfig):
    """One port of X4Step programs."""

    in_one_line = '{ kind = "ppdev", device = "/dev/parport0" }'

    clock_idles_high: bool = Field(False, description="Resting level of the clock lines.")
    forward_high: bool = Field(True, description="Level of the direction lines for positive steps.")
    low_pins: tuple[StatusPin, ...] = Field(
        (), description="Inputs that are low on a simulated port; the others rest high."
    )


class X4StepConfig(Section):
    """Ports of X4Step programs; without any table all four are simulated."""

    keyboard: Literal["us", "de"] = Field(
        "us", description="Where characters lie on the keyboard, if a terminal sends no scan codes."
    )
    keys: KeysName = Field(
        "auto",
        description="Where keys come from: a terminal, with or without releases; or Linux itself.",
    )
    event_devices: tuple[str, ...] = Field(
        (), description='Keyboards, for "evdev", by full path; empty: all that may be read.'
    )
    lpt1: LptConfig | None = Field(None, description="LPT1.")
    lpt2: LptConfig | None = Field(None, description="LPT2.")
    lpt3: LptConfig | None = Field(None, description="LPT3.")
    lpt4: LptConfig | None = Field(None, description="LPT4.")
