"""Lifting the tool off the work while a program is held."""

from collections.abc import Sequence
from typing import Final

from fraese.blocks import Block
from fraese.planner.lines import plan_line
from fraese.straight import line_blocks, slack_after
from fraese.whereabouts import Whereabouts

_VERTICAL: Final = 2


class Lift:
    """Up by a distance, as far as the travel allows, and back down to the very step.

    Args:
        whereabouts: of the axes.
        height_mm: how far.
    """

    def __init__(self, whereabouts: Whereabouts, height_mm: float) -> None:
        self._whereabouts = whereabouts
        self._height_mm = height_mm
        self._height_steps = 0
        self._slack_steps: tuple[int, ...] = ()

    def away(self) -> Sequence[Block]:
        """Up, from where the hold came to rest."""
        where = self._whereabouts
        axis = where.machine.axes[_VERTICAL]
        height = axis.to_steps(self._height_mm)
        if where.referenced[_VERTICAL]:
            room = axis.to_steps(axis.high_mm) - where.position_steps[_VERTICAL]
            height = min(height, max(0, room))
        self._height_steps = height
        self._slack_steps = where.slack_steps
        return list(line_blocks(where, (0, 0, height)))

    def back(self) -> Sequence[Block]:
        """Down again, with the backlash on the side on which it was."""
        where, down = self._whereabouts, (0, 0, -self._height_steps)
        turned = tuple(
            after - before
            for after, before in zip(slack_after(where, down), self._slack_steps, strict=True)
        )
        restore = plan_line(where.machine, turned)
        return [*line_blocks(where, down), *([] if restore is None else [restore])]
