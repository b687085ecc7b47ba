"""Figures of a number of readings: mean, spread, and how often each was met."""

import math
from dataclasses import dataclass
from typing import Any, Final

#: A histogram is no longer than this.
_MOST_BINS: Final = 16


@dataclass(frozen=True, slots=True)
class Bin:
    """One bar of a histogram.

    Attributes:
        low: from here,
        high: to here, both in the unit of the readings.
        count: readings in it.
    """

    low: float
    high: float
    count: int


@dataclass(frozen=True, slots=True)
class Figures:
    """Readings, all in one unit.

    Attributes:
        readings: in the order in which they came.
    """

    readings: tuple[float, ...]

    @property
    def mean(self) -> float:
        """Their mean; 0 without one."""
        return sum(self.readings) / len(self.readings) if self.readings else 0.0

    @property
    def spread(self) -> float:
        """From the least to the greatest."""
        return max(self.readings) - min(self.readings) if self.readings else 0.0

    @property
    def deviation(self) -> float:
        """Standard deviation of one reading; 0 of fewer than two."""
        if len(self.readings) < 2:
            return 0.0
        mean = self.mean
        squares = sum((reading - mean) ** 2 for reading in self.readings)
        return math.sqrt(squares / (len(self.readings) - 1))

    @property
    def drift(self) -> float:
        """By how much the later half is above the earlier one in the mean."""
        half = len(self.readings) // 2
        if not half:
            return 0.0
        return Figures(self.readings[-half:]).mean - Figures(self.readings[:half]).mean

    def bins(self, finest: float) -> tuple[Bin, ...]:
        """A histogram about the mean: as many bars as needed, none finer than this.

        Args:
            finest: what can be told apart.
        """
        if not self.readings:
            return ()
        low = min(self.readings)
        width = finest * max(1, math.ceil((self.spread / finest + 1) / _MOST_BINS))
        places = [
            math.floor((reading - low) / width + 0.5 * finest / width) for reading in self.readings
        ]
        first, mean = low - finest / 2, self.mean
        return tuple(
            Bin(
                first + place * width - mean,
                first + (place + 1) * width - mean,
                places.count(place),
            )
            for place in range(max(places) + 1)
        )

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {
            "mean_mm": round(self.mean, 6),
            "spread_mm": round(self.spread, 6),
            "deviation_mm": round(self.deviation, 6),
            "drift_mm": round(self.drift, 6),
            "readings_mm": [round(reading, 6) for reading in self.readings],
        }
