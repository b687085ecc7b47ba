"""A jog that runs for as long as somebody holds it.

    hold ...... hold ...... hold ......            every so often, from the app
    start --> runs to the limit ........ cut: braked with ramp
                                          let go, or nobody has held it for ``DEAD_MAN_S``

Rule 1: who holds it says so again and again; silence ends it, whatever became of the app: the
        run loop looks, not the app.
Rule 2: it ends at the soft limit; on an axis that is not referenced it is no longer than a jog.
"""

from collections.abc import Callable
from typing import Final

from fraese.anythread import any_thread
from fraese.blocks import Watch
from fraese.control import lines, softlimits
from fraese.control.about import BY_HAND
from fraese.control.controller import Controller
from fraese.control.jobs import Job, Standstill
from fraese.log import logged
from fraese.machine import Steps
from fraese.phrases import phrase

#: Nobody has said for so long that he holds it: it brakes.
DEAD_MAN_S: Final = 0.4


class HeldJog:
    """One such jog.

    Args:
        now: tells the time, s.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._until_s = now() + DEAD_MAN_S
        self._is_over = False

    @any_thread
    def hold(self) -> None:
        """It is still held."""
        self._until_s = self._now() + DEAD_MAN_S

    @any_thread
    def let_go(self) -> None:
        """It is held no more, and will not be again."""
        self._is_over = True

    @property
    @any_thread
    def is_held(self) -> bool:
        """It may go on."""
        return not self._is_over and self._now() < self._until_s

    @logged
    def start(self, controller: Controller, axis: str, sign: int) -> None:
        """Set out, if it is still held; ``run`` makes the way.

        Raises:
            LimitError: if the axis stands at its limit.
            StateError: if the machine is not ready, or stands on the switch it would move into.
        """
        if not self.is_held:
            return
        controller.require_ready()
        where, motor = controller.position, controller.machine.index(axis)
        moved, longest_mm = controller.machine.axes[motor], controller.config.jog.max_mm
        if where.referenced[motor] and not moved.is_endless:
            longest_mm = max(longest_mm, moved.high_mm - moved.low_mm)
        way_steps = sign * moved.to_steps(longest_mm)
        target = softlimits.jog_target(where, motor, way_steps, longest_mm, clamp=True)
        watch = controller.switches.watch_for_jog(motor, way_steps)
        name = phrase("jog {axis}{what}, held", axis=axis.upper(), what="+" if sign > 0 else "-")
        controller.start(name, self._job(controller, target, watch), BY_HAND)

    def _job(self, controller: Controller, target: Steps, watch: Watch | None) -> Job:
        feed_mm_min = controller.config.jog.feed_mm_min
        yield from lines.line_to(controller.position, target, feed_mm_min, watch)
        yield Standstill(cut=lambda: not self.is_held)
