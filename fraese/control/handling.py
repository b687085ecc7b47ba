"""How the operator wants things to run: overrides and switches, changed at any moment.

Two overrides, one ceiling. A driver knows one word: what was planned with more than that is played
slower. So the word follows what lies in its queue:

    queue   feed planned with 100 % | rapid planned with 100 % | feed planned with 50 %
    wanted  feed 50 %, rapid 100 %
    word    50 %                     -> 100 %                    -> 100 %

Rule 1: set from any thread. A raised override is told to the driver at once, before blocks come
        that were planned with it; a lowered one at the next look at the queue, 20 ms later at most.
        What is pushed into an empty queue is looked at before it begins.
Rule 2: nothing that was planned with no more than is wanted is slowed down by a word for others.
Rule 3: where nothing queued was planned with too much, the word is the higher of both.
"""

import threading
from collections.abc import Sequence
from typing import Final

from fraese.anythread import any_thread
from fraese.blocks import OVERRIDES, Q8, RAPID_OVERRIDES, Block
from fraese.errors import LimitError
from fraese.motor.seams import StepDriver
from fraese.phrases import phrase

#: Blocks that are looked at; more do not begin before the next look.
_NEXT: Final = 8
SWITCHES: Final = ("single_block", "optional_stop", "block_delete")


class Handling:
    """What the operator chose.

    Args:
        driver: told how fast queued blocks may be played.
        optional_stop: M1 stops, to begin with.
        block_delete: lines that begin with a slash are left out, likewise.

    Attributes:
        feed: override, a factor.
        rapid: override of rapids, a factor.
        single_block: a program waits after every line that moves.
        optional_stop: M1 stops.
        block_delete: lines that begin with a slash are left out; acts on what is begun next.
        may_be_over: something in the queue may have been planned with more than is wanted.
    """

    def __init__(
        self, driver: StepDriver, *, optional_stop: bool = False, block_delete: bool = False
    ) -> None:
        self._driver = driver
        self.feed = self.rapid = 1.0
        self.single_block = False
        self.optional_stop = optional_stop
        self.block_delete = block_delete
        self._word_q8 = Q8
        # What is known of the word is what the driver was told last.
        self._lock = threading.Lock()
        self.may_be_over = False

    @any_thread
    def set_feed(self, factor: float) -> None:
        """Override of feeds.

        Raises:
            LimitError: if it is outside ``OVERRIDES``.
        """
        _require("feed", factor, OVERRIDES)
        before, self.feed = self.feed, factor
        self._changed(raised=factor > before)

    @any_thread
    def set_rapid(self, factor: float) -> None:
        """Override of rapids.

        Raises:
            LimitError: if it is outside ``RAPID_OVERRIDES``.
        """
        _require("rapid", factor, RAPID_OVERRIDES)
        before, self.rapid = self.rapid, factor
        self._changed(raised=factor > before)

    @any_thread
    def switch(self, name: str) -> None:
        """Turn a switch of this name: single_block, optional_stop or block_delete."""
        if name not in SWITCHES:
            raise ValueError(name)
        setattr(self, name, not getattr(self, name))

    def _changed(self, *, raised: bool) -> None:
        self.may_be_over = True
        if raised and self._resting_q8 > self._word_q8:
            self._say(self._resting_q8)

    @property
    def _resting_q8(self) -> int:
        return round(max(self.feed, self.rapid) * Q8)

    def follow(self, queued: Sequence[Block]) -> None:
        """Look at what the driver plays and is to play next; in the machine's thread."""
        # First, so that what is changed meanwhile counts at the next look.
        self.may_be_over = False
        word_q8 = self._resting_q8
        least_q8 = 0
        for block in queued[:_NEXT]:
            planned_q8 = block.override_q8
            wanted_q8 = round((self.rapid if block.is_rapid else self.feed) * Q8)
            if planned_q8 <= wanted_q8:
                if planned_q8 > word_q8:
                    break
                least_q8 = max(least_q8, planned_q8)
            else:
                self.may_be_over = True
                if wanted_q8 < least_q8:
                    break
                word_q8 = min(word_q8, wanted_q8)
        else:
            self.may_be_over |= any(self._is_over(block) for block in queued)
        if word_q8 != self._word_q8:
            self._say(word_q8)

    def expect(self, block: Block, *, is_first: bool) -> None:
        """This block is pushed next, first or behind others; in the machine's thread."""
        if self._is_over(block):
            if is_first:
                self.follow([block])
            self.may_be_over = True

    def _is_over(self, block: Block) -> bool:
        return block.override_q8 > round((self.rapid if block.is_rapid else self.feed) * Q8)

    def _say(self, word_q8: int) -> None:
        with self._lock:
            self._word_q8 = word_q8
            self._driver.set_override(word_q8 / Q8)


def _require(what: str, factor: float, bounds: tuple[float, float]) -> None:
    low, high = bounds
    if not low <= factor <= high:
        raise LimitError(
            phrase(
                "A {what} override is {low:g} to {high:g} %, not {factor:g} %.",
                what=what,
                low=low * 100,
                high=high * 100,
                factor=factor * 100,
            )
        )
