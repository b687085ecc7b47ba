r"""Look-ahead: how fast each segment of a bounded window may be entered and left.

    speed  |        limit of each corner          o
           |   o        ___o___o___         o
           |  / \      /           \       / \      forward: as fast as acceleration reaches
           | /   \____/             \     /   \     backward: as slow as braking needs
           |/     o                  \___o     \__  the end of the window is always at rest
           +-----------------------------------------> path
             |<-- settled ---------------->|<-- may still be raised by what follows -->|

Rule 1: what is squared here is speed along the path; 2 a L is what a segment adds or sheds.
Rule 2: the last segment in the window ends at rest, whatever comes later: so whatever is final can
        be followed by a stop.
Rule 3: an exit speed is settled when not braking but its own corner or the acceleration before it
        is what limits it. Only then does its segment become a block; if the window is full, the
        oldest ones become blocks as they are.
Rule 4: after a segment was made final, a lower feed or a sharp corner can ask for less than can be
        braked to. Braking then goes on as hard as allowed, across corners if need be: never
        harder. By rule 2 the machine's limits hold nevertheless.
Rule 5: short segments. Eight of them take eight times ``min_block_s`` in the mean; a single short
        one between longer ones is not slowed down.

The window is worked through in batches, so that a segment is looked at a few times only, however
many there are.
"""

from collections import deque
from typing import Final

from fraese.blocks import Block
from fraese.planner.segments import UNLIMITED, Limits, Segment
from fraese.planner.timing import BlockMaker

#: Segments that arrive between two passes over the window, if there is not motion enough before.
_BATCH: Final = 32
#: Short segments are judged in runs of this many.
_RUN: Final = 8
#: What goes before the first segment, as far as short segments are concerned.
_LONG_MM: Final = 1000.0
_SAME: Final = 1 + 1e-9


class Window:
    """Segments whose blocks are not final yet.

    Args:
        limits: of the machine.
        maker: what makes blocks of settled segments.
        most: segments held at most.
        min_block_s: time of a block at least, in the mean.
        batch_s: motion that arrives between two passes.
    """

    def __init__(
        self,
        limits: Limits,
        maker: BlockMaker,
        most: int,
        min_block_s: float,
        batch_s: float = 0.05,
    ) -> None:
        self._limits = limits
        self._maker = maker
        self._most = most
        self._batch_s = batch_s
        self._per_run_s = 1 / (_RUN * min_block_s) if min_block_s else UNLIMITED
        self._run_mm = deque([_LONG_MM] * _RUN, _RUN)
        self._override = 1.0
        self._rapid2 = 1.0
        # Parallel to the segments: squared speeds, of the machine's limit, of the wanted cruise,
        # of the corner before the segment by the machine's limits, and with the wanted speeds.
        self._segments: list[Segment] = []
        self._top: list[float] = []
        self._cruise: list[float] = []
        self._corner: list[float] = []
        self._entry: list[float] = []
        # What was made final last, its squared exit speed, and how the next one is entered.
        self._last: Segment | None = None
        self._last_exit = 0.0
        self._first_entry = 0.0
        self._fresh = 0
        self._fresh_s = 0.0

    @property
    def due(self) -> bool:
        """Enough has arrived for another pass."""
        return self._fresh >= _BATCH or self._fresh_s >= self._batch_s

    def ramp_mm(self, segment: Segment) -> float:
        """Length at either end of a long line that is not to be cut; 0: it may be cut anywhere."""
        return 0.0

    def __len__(self) -> int:
        return len(self._segments)

    def set_override(self, factor: float, rapid: float = 1.0) -> None:
        """Scale the feeds and the rapids of all that is not final, and of what comes."""
        self._override = factor
        self._rapid2 = rapid * rapid
        self._cruise = [
            self._wanted(segment, top)
            for segment, top in zip(self._segments, self._top, strict=True)
        ]
        self._entry = [
            min(corner, here, before)
            for corner, here, before in zip(
                self._corner, self._cruise, [UNLIMITED, *self._cruise], strict=False
            )
        ]

    def stand(self) -> None:
        """The machine comes to a real standstill here: what follows starts from nothing."""
        self._last = None

    def _wanted(self, segment: Segment, top: float) -> float:
        """Square of the cruise speed."""
        feed_mm_s = segment.feed_mm_s
        wanted = feed_mm_s * self._override
        wanted *= wanted
        if wanted > top:
            wanted = top if feed_mm_s != UNLIMITED else top * self._rapid2
        if self._limits.has_bands:
            wanted = self._limits.outside_bands_mm_s(segment, wanted**0.5) ** 2
        return wanted

    def append(self, segment: Segment, exact_stop: bool = False) -> None:
        """Take the next segment.

        Args:
            segment: connects to the one before.
            exact_stop: no faster than the start/stop rates at the corner before it.
        """
        run_mm = self._run_mm
        run_mm.append(segment.length_mm)
        top = segment.top_mm_s
        calm = sum(run_mm) * self._per_run_s
        if calm < top:
            top = calm
        top *= top
        cruise = self._wanted(segment, top)
        segments = self._segments
        corner = entry = UNLIMITED
        if segments:
            before = segments[-1]
            corner = self._limits.corner_mm2_s2(before, segment)
            if exact_stop:
                corner = min(corner, before.rest_mm_s**2, segment.rest_mm_s**2)
            corner = min(corner, top, self._top[-1])
            entry = min(corner, cruise, self._cruise[-1])
        else:
            exit_mm_s = self._last_exit**0.5
            self._first_entry = min(
                cruise, self._limits.restart_mm_s(self._last, exit_mm_s, segment) ** 2
            )
        segments.append(segment)
        self._top.append(top)
        self._cruise.append(cruise)
        self._corner.append(corner)
        self._entry.append(entry)
        self._fresh += 1
        self._fresh_s += segment.length_mm / (cruise**0.5)

    def settle(self, everything: bool = False) -> list[Block]:
        """One pass over the window: blocks of the segments that are final now.

        Args:
            everything: make all of them final, the last one ending at rest.
        """
        self._fresh, self._fresh_s = 0, 0.0
        segments = self._segments
        count = len(segments)
        if not count:
            return []
        entries, exits, settled = self._speeds()
        if everything:
            settled = count
        elif count - settled > self._most:
            settled = count - self._most
        if not settled:
            return []
        make, cruise = self._maker.block, self._cruise
        blocks = [make(segments[k], entries[k], cruise[k], exits[k]) for k in range(settled)]
        self._last, self._last_exit = segments[settled - 1], exits[settled - 1]
        self._first_entry = entries[settled] if settled < count else 0.0
        for column in (segments, self._top, cruise, self._corner, self._entry):
            del column[:settled]
        return blocks

    def _speeds(self) -> tuple[list[float], list[float], int]:
        """Squared entry and exit speeds of all segments, and how many of them are settled."""
        segments, limits = self._segments, self._entry
        last = len(segments) - 1
        speed = min(segments[last].rest_mm_s ** 2, self._cruise[last])
        gains = [segment.twice_mm_s2 * segment.length_mm for segment in segments]
        # Backward: the highest exit of each segment from which all that follows can still brake.
        braking = [speed] * (last + 1)
        for k in range(last, 0, -1):
            speed += gains[k]
            if speed > limits[k]:
                speed = limits[k]
            braking[k - 1] = speed
        # Forward: what acceleration reaches.
        entries, exits = [], []
        settled = 0
        speed = self._first_entry
        for k in range(last + 1):
            entries.append(speed)
            gain = gains[k]
            reached = speed + gain
            slowest = speed - gain
            bound = braking[k]
            if k < last:
                corner = limits[k + 1]
                if corner < reached:
                    reached = corner
                if reached <= bound:
                    settled = k + 1
            speed = reached if reached < bound else bound
            if speed < slowest:
                speed = slowest
            exits.append(speed)
            if k < last and speed > self._corner[k + 1] * _SAME:
                speed = self._restart(k, speed)
        return entries, exits, settled

    def _restart(self, k: int, exit_mm2_s2: float) -> float:
        """Squared entry speed of segment ``k + 1`` after an exit that is too fast to go on with."""
        before, after = self._segments[k], self._segments[k + 1]
        entry_mm_s = self._limits.restart_mm_s(before, exit_mm2_s2**0.5, after)
        return min(entry_mm_s**2, self._corner[k + 1])
