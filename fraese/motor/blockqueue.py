"""Blocks that wait for their turn, and whether they are enough to stop in.

Rule 1: a block that would not play as it says is refused, and nothing is taken.
Rule 2: path energy is ``weight * rate**2``, one unit for all blocks. What braking can shed in the
        queue is kept as a sum that changes with push and take, since it is asked for every tick.
Rule 3: a queue with a block that ends at rest cannot run dry: the plan itself stops there.
Rule 4: every block has a serial number, from 1 in the order of pushing.
"""

from collections import deque
from typing import Final

from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.motor.cursor import Cursor
from fraese.motor.throttle import SLICE_CYCLES

#: Squared rate, in (tick/s)**2 / 65536, that one tick of braking sheds per unit of ``accel_q``.
_SHED_PER_TICK: Final = 2 * CYCLES_PER_S // 256


def _shed(block: Block, ticks: int) -> int:
    """Path energy that braking can shed within so many ticks of a block."""
    return block.weight * (block.accel_q * _SHED_PER_TICK >> 16) * ticks


def _require_sound(block: Block, motors: int) -> None:
    """Refuse what would make more or fewer steps than it says, or in no time at all.

    Raises:
        ValueError: with what is wrong.
    """
    if len(block.steps) != motors:
        raise ValueError(f"a block for {len(block.steps)} motors on a card for {motors}")
    longest = max(abs(n) for n in block.steps)
    if longest and block.ticks() != longest:
        raise ValueError(f"a block of {longest} steps with a time law of {block.ticks()} ticks")
    shortest_q8 = Q8 if longest else 0
    if any(min(p.interval_q8, p.last_interval_q8()) < shortest_q8 for p in block.pieces if p.ticks):
        raise ValueError("a time law with an interval of nothing")


class BlockQueue:
    """The queue of a driver.

    Args:
        motors: how many the card drives.
        capacity: blocks that the queue takes.

    Attributes:
        serial: number of the last block that was taken or dropped.
        resting_blocks: blocks that end at rest, waiting or in hand.
    """

    def __init__(self, motors: int, capacity: int) -> None:
        self._motors = motors
        self._capacity = capacity
        self._blocks: deque[Block] = deque()
        self._shed = 0
        self.serial = 0
        self.resting_blocks = 0

    def __len__(self) -> int:
        return len(self._blocks)

    @property
    def free(self) -> int:
        """How many more blocks can be pushed."""
        return self._capacity - len(self._blocks)

    def push(self, block: Block) -> bool:
        """Take a block; False: full, nothing was taken.

        Raises:
            ValueError: if the block cannot be played as it says.
        """
        _require_sound(block, self._motors)
        if len(self._blocks) >= self._capacity:
            return False
        self._blocks.append(block)
        self._shed += _shed(block, block.ticks())
        self.resting_blocks += block.ends_at_rest
        return True

    def take(self) -> Block | None:
        """The next block, into the hand of the player."""
        if not self._blocks:
            return None
        block = self._blocks.popleft()
        self._shed -= _shed(block, block.ticks())
        self.serial += 1
        return block

    def ended(self, block: Block) -> None:
        """The block in hand was played, or was given up."""
        self.resting_blocks -= block.ends_at_rest

    def drop(self) -> None:
        """Forget all that waits; the block in hand is not touched."""
        self.serial += len(self._blocks)
        self.resting_blocks -= sum(block.ends_at_rest for block in self._blocks)
        self._blocks.clear()
        self._shed = 0

    def falls_short(self, cursor: Cursor, last_cycles: int) -> bool:
        """What is left no longer suffices to stop from the rate last played.

        Braking begins a little before it must: the throttle may be within a slice just now.
        """
        block = cursor.block
        rate_hz = CYCLES_PER_S // last_cycles
        jump_hz = block.jump_rate_q8 >> 8
        reserve = SLICE_CYCLES // last_cycles + 2
        left = max(0, cursor.ticks - cursor.done - reserve)
        return block.weight * (rate_hz**2 - jump_hz**2) > _shed(block, left) + self._shed
