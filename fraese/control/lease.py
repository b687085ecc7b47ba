"""For how long a record holds that bounds what is played: as short as the disk allows.

    record k   asked --- durable ----------------- over
                 |          from here on motors may play until "over", and brake then
    record k+1   |     asked --- durable ----------------- over
                 |<------- gap ------->|                  a lease must be longer than that

Rule 1: a lease begins when its record is asked for, since the record says where the motors are
        then; it is granted when the record is durable. So between two grants lies a gap.
Rule 2: it is twice the longest gap of late, which is forgotten by and by; never shorter than an
        ordinary disk needs, or than half of the lead that is configured. A slower disk or a busy
        computer costs wider bounds, and not a job that is held up.
Rule 3: where nothing lies in the driver's queue there is nothing to be limited: the record holds
        for ever, and what is handed over then must lie within its bounds.
"""

from typing import Final

from fraese.control.recordwriter import Done

_NS_PER_S: Final = 1_000_000_000
#: Two rounds of the run loop, and a disk that takes 0.1 s.
LEAST_S: Final = 0.15
MOST_S: Final = 2.0
#: A gap counts half as much after so long, s.
_HALF_LIFE_S: Final = 60.0
#: Of a record that holds for ever; fits a word of the shared memory.
FOR_EVER_NS: Final = 2**63 - 1


class Lease:
    """How long the next one is.

    Args:
        lead_s: motion that is to be in the driver's queue.

    Attributes:
        lapses: how often the motors had to brake, since the next record was late.
    """

    def __init__(self, lead_s: float = 0.0) -> None:
        self._least_s = max(LEAST_S, lead_s / 2)
        self._gap_s = 0.0
        self.lapses = 0
        self._before: Done | None = None

    @property
    def seconds(self) -> float:
        """As it is now."""
        return min(max(2 * self._gap_s, self._least_s), MOST_S)

    def over_ns(self, asked_ns: int) -> int:
        """When one is over that begins then."""
        return asked_ns + round(self.seconds * _NS_PER_S)

    def saw(self, done: Done) -> int:
        """A record became durable; ``lapses``."""
        before, self._before = self._before, done
        gap_ns = done.at_ns - done.asked.at_ns
        if before is not None:
            self._gap_s *= 0.5 ** ((done.at_ns - before.at_ns) / _NS_PER_S / _HALF_LIFE_S)
            if done.asked.runs and before.asked.over_ns != FOR_EVER_NS:
                gap_ns = done.at_ns - before.asked.at_ns
                self.lapses += done.at_ns > before.asked.over_ns
        self._gap_s = max(gap_ns / _NS_PER_S, self._gap_s)
        return self.lapses
