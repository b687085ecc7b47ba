"""The block in hand: where in its path and in its time law the player is.

Path and law are walked side by side and know nothing of each other. The core copies the few
numbers of its inner loop into locals and stores them back when it leaves the loop.
"""

from fraese.blocks import Block, leader_of, steps_done


class Cursor:
    """Position within one block.

    Attributes:
        block: the block in hand.
        ticks: its number of ticks.
        done: ticks played.
        leader_bit: bit mask of the leading motor, 0 in a dwell.
        minors: [accumulator, steps, bit] of every other motor that moves.
        piece_left: ticks left of the piece in hand, with ``interval_q8`` and ``add_q8``.
        entry_cycles: its first interval as planned.
        outputs: the block's change of outputs, until it is made.
    """

    def __init__(self, block: Block) -> None:
        self.block = block
        self.ticks = block.ticks()
        self.done = 0
        self.directions = tuple((n > 0) - (n < 0) for n in block.steps)
        self.leader = leader_of(block.steps) if any(block.steps) else 0
        self.leader_bit = 1 << self.leader if block.steps[self.leader] else 0
        half = self.ticks // 2
        self.minors = [
            [half, abs(n), 1 << motor]
            for motor, n in enumerate(block.steps)
            if n and motor != self.leader
        ]
        self.entry_cycles = next((p.interval_q8 >> 8 for p in block.pieces if p.ticks), 0)
        self.outputs = block.outputs
        self._pieces = iter(block.pieces)
        self.piece_left = 0
        self.interval_q8 = 0
        self.add_q8 = 0

    def next_piece(self) -> bool:
        """Take up the next piece; False when the law is at its end."""
        for piece in self._pieces:
            if piece.ticks:
                self.piece_left, self.interval_q8, self.add_q8 = piece
                return True
        return False

    def steps_at(self, done: int) -> tuple[int, ...]:
        """Signed steps of every motor after ``done`` ticks of this block."""
        return tuple(
            direction * steps_done(abs(n), self.ticks, done) if n else 0
            for n, direction in zip(self.block.steps, self.directions, strict=True)
        )

    def steps_within_tick(self, last_motor: int) -> tuple[int, ...]:
        """The same in the middle of a tick: motors up to ``last_motor`` have made their step.

        The order is the leader first, then motor order; ``EVERY_MOTOR`` (-1) means all have.
        """
        before, after = self.steps_at(self.done), self.steps_at(self.done + 1)
        if last_motor < 0:
            return after
        return tuple(
            after[motor]
            if motor == self.leader or (last_motor != self.leader and motor <= last_motor)
            else before[motor]
            for motor in range(len(before))
        )
