"""Blocks that wait for their turn, and how far the motors may go on if nothing more comes.

Rule 1: a block that would not play as it says is refused, and nothing is taken.
Rule 2: where braking must begin is known when a block is pushed; a tick only compares counts.
Rule 3: a queue whose last block ends at rest cannot run dry: the plan itself stops there.
Rule 4: every block has a serial number, from 1 in the order of pushing.
"""

from collections import deque

from fraese.blocks import Q8, Block
from fraese.motor.horizon import DryPoint, Horizon


def require_sound(block: Block, motors: int) -> None:
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
        dry_point: where braking must begin if no further block comes; None: nowhere.
    """

    def __init__(self, motors: int, capacity: int) -> None:
        self._motors = motors
        self._capacity = capacity
        self._blocks: deque[Block] = deque()
        self._horizon = Horizon()
        self.serial = 0
        self.dry_point: DryPoint | None = None

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
        require_sound(block, self._motors)
        if len(self._blocks) >= self._capacity:
            return False
        self.accept(block, self._horizon.add(self.next_serial, block))
        return True

    def accept(self, block: Block, dry_point: DryPoint | None) -> None:
        """Take a block that somebody else has looked at, and knows to be sound; there is room.

        Args:
            block: what to play.
            dry_point: where braking must begin if it stays the last one; None: nowhere.
        """
        self._blocks.append(block)
        self.dry_point = dry_point

    @property
    def next_serial(self) -> int:
        """The number that the next block will get."""
        return self.serial + len(self._blocks) + 1

    def take(self) -> Block | None:
        """The next block, into the hand of the player."""
        if not self._blocks:
            return None
        block = self._blocks.popleft()
        self.serial += 1
        return block

    def drop(self) -> None:
        """Forget all that waits; the block in hand is not touched."""
        self.serial += len(self._blocks)
        self._blocks.clear()
        self._horizon.reset()
        self.dry_point = None

    @property
    def may_run_dry(self) -> bool:
        """Braking must begin within the block in hand, if no further block comes."""
        return self.dry_point is not None and self.serial >= self.dry_point.serial

    def is_dry(self, ticks_done: int) -> bool:
        """So far into the block in hand, braking must begin if no further block comes."""
        point = self.dry_point
        if point is None or self.serial < point.serial:
            return False
        return self.serial > point.serial or ticks_done >= point.ticks_done
