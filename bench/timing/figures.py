"""What a measurement gives: rows of a table, sentences, curves."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from fraese.motor.realtime.measure import Lateness

Samples = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """One line of a table.

    Attributes:
        name: what was measured.
        late_us: how late each tick was.
        interval_us: from tick to tick, as wanted.
        played_hz: ticks a second that were made.
        slipped: edges after which all that follows was moved; None: not known.
    """

    name: str
    late_us: Samples
    interval_us: float
    played_hz: float
    slipped: int | None = None

    def percentiles_us(self) -> Samples:
        """Median, p99, p99.9, longest."""
        return np.percentile(self.late_us, (50, 99, 99.9, 100))

    def later_than_a_quarter(self) -> int:
        """Ticks that were."""
        return int(np.count_nonzero(self.late_us > self.interval_us / 4))

    def cells(self) -> list[str]:
        """For the table."""
        return [
            self.name,
            *(f"{value:.2f}" for value in self.percentiles_us()),
            str(self.later_than_a_quarter()),
            "" if self.slipped is None else str(self.slipped),
            str(len(self.late_us)),
            f"{self.played_hz:.0f}",
        ]


HEAD = (
    "late by, us", "median", "p99", "p99.9", "longest", "> 1/4", "slipped", "ticks", "ticks/s",
)  # fmt: skip


@dataclass(frozen=True)
class Section:
    """One measurement, ready for the page.

    Attributes:
        key: of the picture's file name.
        title: heading.
        rows: of the table; each is a curve of the picture, too.
        said: sentences under it.
        load: load average before and after.
    """

    key: str
    title: str
    rows: Sequence[Row]
    said: Sequence[str] = ()
    load: str = field(default="")

    def table(self) -> list[str]:
        """In Markdown."""
        lines = [f"| {' | '.join(HEAD)} |", f"|---|{'---:|' * (len(HEAD) - 1)}"]
        return lines + [f"| {' | '.join(row.cells())} |" for row in self.rows]


def row_of(name: str, result: Lateness) -> Row:
    """From a measurement of the step process."""
    return Row(name, result.late_us, result.duty.interval_us, result.played_hz, result.late_ticks)


def together(name: str, rows: Sequence[Row]) -> Row:
    """Several slices of one thing as one."""
    first = rows[0]
    slipped = [row.slipped for row in rows if row.slipped is not None]
    return Row(
        name,
        np.concatenate([row.late_us for row in rows]),
        first.interval_us,
        float(np.mean([row.played_hz for row in rows])),
        sum(slipped) if len(slipped) == len(rows) else None,
    )
