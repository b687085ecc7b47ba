"""Which work offsets hold where: an interpreter reads ahead of the motors.

    read     G54 .......... G55 ...... G92 ......
    blocks   1  2  3  4  5  6  7  8  9  10           entries: (0, G54) (5, G55) (9, G92)
    played   ---------^                              in force: G54

Rule 1: what was read ahead but not reached does not count: a program that is cancelled leaves the
        offsets of the block at which it ended.
"""

from collections.abc import Mapping

from fraese.control.controller import Controller
from fraese.control.workoffsets import InForce
from fraese.gcode import canon
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves, Translation
from fraese.workframe import WorkFrame


class OffsetHistory:
    """Which offsets hold where: what was read ahead but not reached does not count.

    Args:
        controller: knows how many blocks were played.
        source: where the offsets come from.
        translation: what lies between.
    """

    def __init__(
        self, controller: Controller, source: ProgramSource, translation: Translation
    ) -> None:
        self._controller = controller
        self._source = source
        self._planner = translation.planner
        # Blocks before a change, and what holds from there on; replaced whole.
        self._entries: tuple[tuple[int, InForce], ...] = ((0, self._now()),)

    def _now(self) -> InForce:
        return self._source.parameters(), self._source.frame

    def watch(self, moves: Moves) -> Moves:
        """Pass everything on, both ways; note changes."""
        facts: canon.Facts | None = None
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            facts = yield move
            if type(move) is canon.Offsets:
                # Now no line waits to be merged: every segment is one block.
                self._note(self._controller.blocks_pushed() + self._planner.pending)

    def _note(self, blocks: int) -> None:
        self._entries = (*self._from_here(), (blocks, self._now()))

    def _from_here(self) -> tuple[tuple[int, InForce], ...]:
        """What holds now, and what will."""
        entries, finished = self._entries, self._controller.blocks_finished()
        passed = sum(blocks <= finished for blocks, _ in entries[1:])
        return entries[passed:]

    def put(self, parameters: Mapping[int, float]) -> None:
        """A person has changed something while the program waits: nothing was read ahead."""
        axes = self._source.frame.axes
        self._entries = ((0, (dict(parameters), WorkFrame.of(parameters, axes))),)

    def close(self) -> None:
        """The program was played to its end."""
        self._entries = ((0, self._now()),)

    def in_force(self) -> InForce:
        """Parameters and frame where the machine stands. From any thread."""
        return self._from_here()[0][1]
