"""How fast jogs go: as the configuration says, or as somebody has chosen.

Rule 1: it counts from the next line on; what is being made keeps its rate, and the feed override
        acts on both.
Rule 2: an axis that cannot go so fast goes as fast as it can; what none of them can is refused.
"""

from fraese.anythread import any_thread
from fraese.control import softlimits
from fraese.control.controller import Controller
from fraese.errors import LimitError
from fraese.phrases import phrase

#: A rate is rounded to whole cycles.
_NEARLY = 1.001


class JogRate:
    """The rate of jogs, mm/min; on a rotary axis read degrees for mm.

    Args:
        controller: its configuration says it as long as nobody has chosen.

    Attributes:
        chosen: by a person; None: as the configuration says.
    """

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self.chosen: float | None = None

    @property
    @any_thread
    def feed_mm_min(self) -> float:
        """What jogs go with from now on."""
        chosen = self.chosen
        return self.configured_mm_min if chosen is None else chosen

    @property
    @any_thread
    def configured_mm_min(self) -> float:
        """What they go with as long as nobody has chosen."""
        return self._controller.config.jog.feed_mm_min

    @any_thread
    def choose(self, feed_mm_min: float | None) -> None:
        """Let jogs go with this; None: as the configuration says.

        Raises:
            LimitError: if nothing goes so slow or so fast; what was chosen before holds.
        """
        softlimits.require_feed(feed_mm_min)
        axes = self._controller.machine.axes
        fastest = max(axis.max_rate_hz * axis.step_mm * 60 for axis in axes)
        if feed_mm_min is not None and feed_mm_min > fastest * _NEARLY:
            raise LimitError(
                phrase(
                    "No axis goes with {feed_mm_min:g} mm/min: the fastest one can {fastest:.0f}.",
                    feed_mm_min=feed_mm_min,
                    fastest=fastest,
                )
            )
        self.chosen = feed_mm_min
