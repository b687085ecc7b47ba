"""Moves of a program by their numbers, as tags of blocks carry them."""

from fraese.control.jobs import MOVE_BITS


class Numbers:
    """The number of the move in hand, as a block's tag carries it.

    Attributes:
        high: the number of the last move, where it is in a tag; 0: before the first.
        stride: what the next move adds; 0 on a way that is no part of the program.
    """

    def __init__(self) -> None:
        self.high = 0
        self.stride = 1 << MOVE_BITS

    @property
    def is_on_a_way(self) -> bool:
        """What comes is no part of the program."""
        return not self.stride

    def pass_by(self) -> None:
        """A move of the program that is not made."""
        self.high += 1 << MOVE_BITS

    def leave(self) -> None:
        """A way begins; it counts as the move to which it leads."""
        self.pass_by()
        self.stride = 0

    def come_back(self) -> None:
        """The way is over; the next move is that to which it led."""
        self.stride = 1 << MOVE_BITS
        self.high -= self.stride
