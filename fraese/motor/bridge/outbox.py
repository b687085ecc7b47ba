"""Blocks made into records: dry points, limits that go on, and whether there is room.

Rule 1: a record is made when its block is pushed, in the order in which it will be played.
Rule 2: where a queue was dropped, nobody needs to know which record the device saw last: the next
        one says all its limits.
"""

from typing import Final

from fraese.blocks import Block
from fraese.motor.bridge.constants import DRY_NONE
from fraese.motor.bridge.link import Link
from fraese.motor.bridge.records import Carried, Dry, body, carried_after, with_dry_point
from fraese.motor.horizon import DryPoint, Horizon

#: What is kept here when the device's ring is full, bytes.
BACKLOG: Final = 1024
#: What a block of a contour takes.
_USUAL_BYTES: Final = 24


class Outbox:
    """The way of a block into the stream.

    Args:
        link: to the device.
        ring: bytes that it stores.
        has_lamp: it sets the power of a lamp.
    """

    def __init__(self, link: Link, ring: int, *, has_lamp: bool = False) -> None:
        self._link = link
        self._ring = ring
        self._horizon = Horizon()
        # Values that no block has: whatever comes next is said in full.
        self._unknown = Carried(-1, -1, -1, (-1, -1) if has_lamp else None)
        self._carried = self._unknown

    @property
    def room_blocks(self) -> int:
        """How many usual blocks are taken, here and there; an estimate."""
        return max(0, self._room // _USUAL_BYTES)

    @property
    def is_full(self) -> bool:
        """Nothing more is taken until the device has played something."""
        return self._room <= 0

    @property
    def _room(self) -> int:
        return max(0, self._link.credit) + BACKLOG - self._link.backlog

    def record(self, block: Block, number: int) -> bytes:
        """The record of the block with that number, which is the next one.

        Raises:
            ValueError: if the device cannot hold it.
        """
        text = body(block, self._carried)
        if len(text) >= self._ring:
            raise ValueError(
                f"a block of {len(block.pieces)} pieces takes {len(text)} bytes; the bridge stores"
                f" {self._ring - 1}: cut the line in two"
            )
        dry = _dry(self._horizon.add(number, block), number)
        self._carried = carried_after(block, self._carried)
        return with_dry_point(text, dry)

    def restart(self) -> None:
        """The queue was dropped."""
        self._carried = self._unknown
        self.forget_horizon()

    def forget_horizon(self) -> None:
        """The motors stand and nothing waits: what comes next comes from standstill."""
        self._horizon.reset()


def _dry(point: DryPoint | None, number: int) -> Dry | None:
    """As the record says it. What lies too far back was played long ago, and so is any of that."""
    if point is None:
        return None
    back = number - point.serial
    return Dry(back, point.ticks_done) if back < DRY_NONE else Dry(DRY_NONE - 1, 0)
