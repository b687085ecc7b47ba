"""What of jogs is being done, and what is to run for as long as it is held."""

from dataclasses import dataclass

from fraese.blocks import Watch
from fraese.control.heldjog import Hold
from fraese.machine import Steps


@dataclass(frozen=True, slots=True)
class Hand:
    """What is being done.

    Attributes:
        motor: which axis.
        sign: which way.
        ends_steps: where each of its presses ends, and
        ends_mm: the same, not rounded.
        target: where the line ends.
        watch: what the line needs to leave a closed switch.
        hold: it is made for as long as this is held.
    """

    motor: int
    sign: int
    ends_steps: tuple[int, ...]
    ends_mm: tuple[float, ...]
    target: Steps
    watch: Watch | None
    hold: Hold | None = None


@dataclass(frozen=True, slots=True)
class Held:
    """What is to run for as long as it is held."""

    motor: int
    sign: int
    hold: Hold
