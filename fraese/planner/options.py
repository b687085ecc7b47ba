"""What can be chosen in planning: by the configuration, by the program."""

from dataclasses import dataclass
from enum import StrEnum

from fraese.config.work import PlannerConfig


class PathMode(StrEnum):
    """How closely the path is followed."""

    #: Every corner is passed exactly; the speed there is what the axes can jump by.
    EXACT_PATH = "G61"
    #: The same, and no corner is passed above the start/stop rates.
    EXACT_STOP = "G61.1"
    #: Points on a straight line within a tolerance are merged.
    BLEND = "G64"


@dataclass(frozen=True, slots=True)
class Options:
    """What can be chosen.

    Attributes:
        chord_tolerance_mm: greatest distance of chords from an arc.
        min_block_s: time of a block at least, in the mean of eight.
        max_block_s: longer moves are cut.
        window: segments that the look-ahead holds at most.
        batch_s: motion, as planned, that arrives between two passes over the window.
        rate_factor: part of the axes' rates that may be used (a machine not referenced).
    """

    chord_tolerance_mm: float = 0.005
    min_block_s: float = 0.004
    max_block_s: float = 1.0
    window: int = 200
    batch_s: float = 0.05
    rate_factor: float = 1.0

    @classmethod
    def from_config(cls, config: PlannerConfig, rate_factor: float = 1.0) -> "Options":
        """Options as configured."""
        return cls(
            chord_tolerance_mm=config.chord_tolerance_mm,
            min_block_s=config.min_block_ms / 1000,
            max_block_s=config.max_block_s,
            window=config.window,
            rate_factor=rate_factor,
        )
