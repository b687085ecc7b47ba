r"""Where a step process was when it died: noted with every wait, worked out by its parent.

    child    tick, wait: word = (block, ticks done) ... tick, wait: word ... killed
    parent   last report: block 7, tick 40, counts    word: block 9, tick 3
             counts + rest of block 7 + block 8 + 3 ticks of block 9, and at most one tick more

Rule 1: the note is made at the begin of a wait, so it is behind by one tick at most: what was
        written since then is the motors' step of that tick, or a part of it.
Rule 2: report and note are each of one moment; the later of the two counts.
"""

from collections import deque
from typing import Final, NamedTuple

from fraese.blocks import Block, steps_done
from fraese.motor.seams import Report
from fraese.phrases import joined, phrase

DONE_BITS: Final = 32
_DONE_MASK: Final = (1 << DONE_BITS) - 1


def noted(serial: int, done: int) -> int:
    """A place as one word."""
    return serial << DONE_BITS | done


class Bounds(NamedTuple):
    """Between which counts every motor is, the ends included.

    Attributes:
        at_steps: as noted,
        low_steps: and with what may have been made since then: not below this,
        high_steps: and not above that.
    """

    at_steps: tuple[int, ...]
    low_steps: tuple[int, ...]
    high_steps: tuple[int, ...]

    def after(self, base_steps: tuple[int, ...]) -> "Bounds":
        """The same, counted from further back; empty: from here."""
        if not base_steps:
            return self
        return Bounds(*(tuple(map(sum, zip(base_steps, steps, strict=True))) for steps in self))

    def in_words(self) -> str:
        """A part of a sentence."""
        return joined(
            ", ",
            (
                phrase("motor {motor} {low} to {high}", motor=motor, low=low, high=high)
                if low != high
                else phrase("motor {motor} {low}", motor=motor, low=low)
                for motor, (low, high) in enumerate(
                    zip(self.low_steps, self.high_steps, strict=True), start=1
                )
            ),
        )


class Sent:
    """The blocks that a child was given and has not finished, as far as is known."""

    def __init__(self) -> None:
        self._blocks: deque[tuple[int, tuple[int, ...], int]] = deque()

    def add(self, number: int, block: Block) -> None:
        """It is on its way."""
        self._blocks.append((number, block.steps, block.ticks()))

    def forget(self, playing: int) -> None:
        """A later block is in hand."""
        while self._blocks and self._blocks[0][0] < playing:
            self._blocks.popleft()

    def bounds(self, last: Report, word: int, base_steps: tuple[int, ...]) -> Bounds:
        """Where the motors were at the child's death.

        Args:
            last: its last report, with counts and numbers of its own.
            word: its last note.
            base_steps: what the blocks before the one in hand came to, in that report.
        """
        serial, done = word >> DONE_BITS, word & _DONE_MASK
        is_later = (serial, done) > (last.playing, last.tick)
        # A report may be of the middle of a tick: the note counts from the begin of the block.
        at = list(base_steps if is_later else last.position_steps)
        reach = [(0, 0)] * len(at)
        for number, steps, ticks in self._blocks:
            if number < last.playing or not is_later or number > serial:
                continue
            if number == last.playing and not last.queued:
                continue
            until = min(done, ticks) if number == serial else ticks
            for motor, n in enumerate(steps):
                at[motor] += _signed(n, ticks, until)
        if last.running:
            reach = self._next_tick(max((serial, done), (last.playing, last.tick)), reach)
        return Bounds(
            tuple(at),
            tuple(n + low for n, (low, _) in zip(at, reach, strict=True)),
            tuple(n + high for n, (_, high) in zip(at, reach, strict=True)),
        )

    def _next_tick(
        self, place: tuple[int, int], reach: list[tuple[int, int]]
    ) -> list[tuple[int, int]]:
        """What one tick more, of this block or the next one, may add."""
        serial, _ = place
        for number, steps, _ in self._blocks:
            if serial <= number <= serial + 1:
                for motor, n in enumerate(steps):
                    low, high = reach[motor]
                    reach[motor] = (low - 1, high) if n < 0 else (low, high + (n > 0))
        return [(max(-1, low), min(1, high)) for low, high in reach]


def _signed(n: int, ticks: int, done: int) -> int:
    return (1 if n > 0 else -1) * steps_done(abs(n), ticks, done) if n else 0
