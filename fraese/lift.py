"""Lifting the tool off the work while a program is held."""

from collections.abc import Sequence
from typing import Final

from fraese.blocks import Block
from fraese.controller import Controller
from fraese.planner.lines import plan_line

_VERTICAL: Final = 2


class Lift:
    """Up by a distance, as far as the travel allows, and back down to the very step.

    Args:
        controller: whose vertical axis.
        height_mm: how far.
    """

    def __init__(self, controller: Controller, height_mm: float) -> None:
        self._controller = controller
        self._height_mm = height_mm
        self._height_steps = 0
        self._slack_steps: tuple[int, ...] = ()

    def away(self) -> Sequence[Block]:
        """Up, from where the hold came to rest."""
        controller = self._controller
        axis = controller.machine.axes[_VERTICAL]
        height = axis.to_steps(self._height_mm)
        if controller.is_referenced(axis.name):
            room = axis.to_steps(axis.high_mm) - controller.position_steps()[_VERTICAL]
            height = min(height, max(0, room))
        self._height_steps = height
        self._slack_steps = controller.slack_steps
        return list(controller.line_blocks((0, 0, height), None))

    def back(self) -> Sequence[Block]:
        """Down again, with the backlash on the side on which it was."""
        controller = self._controller
        down = (0, 0, -self._height_steps)
        blocks = list(controller.line_blocks(down, None))
        slack_after = controller.slack_after(down)
        turned = tuple(
            after - before for after, before in zip(slack_after, self._slack_steps, strict=True)
        )
        restore = plan_line(controller.machine, turned)
        return blocks if restore is None else [*blocks, restore]
