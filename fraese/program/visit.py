"""A person at the machine while a program waits for him: a new tool, touched off, and back again.

    before     place, and the work coordinates there
    meanwhile  jogs, moves by hand, another zero of the axis that lifts the tool
    back       up | over | down, to where the new tool stands as the old one did    shown first

Rule 1: the program goes on at the same place of the work. Where the tool's zero was changed that is
        another place of the machine; a travel that is too short for it is told.
Rule 2: the way is shown before it is gone, and shown anew if somebody moved since.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from fraese.control.controller import Controller
from fraese.gcode import canon
from fraese.machine import Millimetres, Steps
from fraese.phrases import joined, phrase
from fraese.program.context import Height, ProgramContext
from fraese.workframe import WorkFrame


@dataclass(frozen=True, slots=True)
class Back:
    """The way back.

    Attributes:
        legs: places on the way, with the feed; None: as fast as the axes can.
        question: shows it.
    """

    legs: tuple[tuple[Millimetres, float | None], ...]
    question: str


class Visit:
    """What a person does while one question waits.

    Args:
        controller: the machine, which stands.
        context: for the safe height.
    """

    def __init__(self, controller: Controller, context: ProgramContext) -> None:
        self._controller = controller
        self._context = context
        self._place, self._parameters = self._now()
        self._frame: WorkFrame = controller.position.frame
        self._shown: tuple[Steps, dict[int, float]] | None = None

    def _now(self) -> tuple[Steps, dict[int, float]]:
        where = self._controller.position
        return where.position_steps, where.offsets.parameters

    @property
    def changed(self) -> Mapping[int, float]:
        """Parameters that are others now."""
        before, now = self._parameters, self._now()[1]
        return {n: now.get(n, 0.0) for n in {*before, *now} if before.get(n) != now.get(n)}

    @property
    def is_nothing(self) -> bool:
        """All is as it was."""
        return self._now() == (self._place, self._parameters)

    def show(self) -> Back | None:
        """The way back, to be shown; None: it stands there, or this way was shown already."""
        there, here = self._target(), self._controller.position.position_steps
        if there == here or self._shown == self._now():
            return None
        self._shown = self._now()
        return self.way()

    def way(self) -> Back:
        """The way back from here."""
        machine = self._context.machine
        here = machine.to_mm(self._controller.position.position_steps)
        there = machine.to_mm(self._target())
        legs = self._legs(here, there)
        words = joined("; ", (self._leg_in_words(point, feed) for point, feed in legs))
        return Back(legs, phrase("Back to the work: {words} (machine): go?", words=words))

    def _leg_in_words(self, point: Millimetres, feed_mm_min: float | None) -> str:
        by = phrase("rapid") if feed_mm_min is None else _feed(feed_mm_min)
        return phrase("{by} to {place}", by=by, place=self._context.machine.in_words(point))

    def _legs(
        self, here: Millimetres, there: Millimetres
    ) -> tuple[tuple[Millimetres, float | None], ...]:
        """Up, over and down; what goes nowhere is left out."""
        height = self._context.safe_height()
        if height is None:
            return ((there, None),)
        axis = height.axis
        top = Height(axis, max(height.mm, here[axis], there[axis]))
        feed_mm_min = self._context.config.run.default_feed_mm_min
        legs = ((top.at(here), None), (top.at(there), None), (there, feed_mm_min))
        befores = (here, *(point for point, _ in legs))
        return tuple(leg for leg, before in zip(legs, befores, strict=False) if leg[0] != before)

    def _target(self) -> Steps:
        """Where the tool stands in the work as it did before."""
        where, machine = self._controller.position, self._context.machine
        vertical = machine.vertical
        if vertical is None or not self.changed:
            return self._place
        before_mm = machine.to_mm(self._place)
        moved_mm = where.frame.to_machine(self._frame.to_work(before_mm))[vertical]
        axis = machine.axes[vertical]
        if where.referenced[vertical] and not axis.is_endless:
            moved_mm = min(max(moved_mm, axis.low_mm), axis.high_mm)
        return tuple(
            axis.to_steps(moved_mm) if n == vertical else steps
            for n, steps in enumerate(self._place)
        )

    def facts(self) -> canon.Facts:
        """What the program is told: where it stands, and what was changed."""
        at_mm = self._context.machine.to_mm(self._controller.position.position_steps)
        return canon.Facts(position_mm=at_mm, parameters=dict(self.changed))


def _feed(feed_mm_min: float) -> str:
    return phrase("feed {feed:g} mm/min", feed=feed_mm_min)
