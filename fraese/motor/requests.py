"""What is wanted of the run: to brake, to stop, and what for.

Rule 1: ``brake``, ``stop`` and ``override`` may be called from any thread. They set one flag, and
        then disturb the calm.
Rule 2: while it is calm, ticks are played as planned without a look at throttle and flags.
        Whoever makes it calm reads the flags after that: one may have been set in between.
Rule 3: a wish stands until the run has acted on it.
"""

from fraese.anythread import any_thread
from fraese.blocks import Q8
from fraese.motor.seams import Ended


class Requests:
    """Flags between those who want something and the run that acts on it.

    Attributes:
        calm: ticks may be played by the plan alone.
        brake_wanted: close the throttle.
        stop_wanted: play no further tick,
        stop_reason: and say that it was for this.
        override_q8: feed override wanted now, 256 for 100 %.
        drop_when_still: the queue is dropped when the throttle has closed: a watch was fulfilled
            above the start/stop rate.
    """

    __slots__ = (
        "brake_wanted", "calm", "drop_when_still", "override_q8", "stop_reason", "stop_wanted",
    )  # fmt: skip

    def __init__(self) -> None:
        self.calm = True
        self.brake_wanted = False
        self.override_q8 = Q8
        self.stop_wanted = False
        self.stop_reason = Ended.STOP
        self.drop_when_still = False

    @any_thread
    def brake(self) -> None:
        """Close the throttle."""
        self.brake_wanted = True
        self.calm = False

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest."""
        self.stop_wanted = True
        self.calm = False

    @any_thread
    def override(self, override_q8: int) -> None:
        """Limit what was planned with a higher one."""
        self.override_q8 = override_q8
        self.calm = False

    def stop_for(self, reason: Ended) -> None:
        """Stop, and remember what for."""
        self.stop_reason = reason
        self.stop()

    @property
    def is_pressing(self) -> bool:
        """Something is wanted that need not wait for the next tick."""
        return self.stop_wanted or self.brake_wanted

    def be_calm(self, calm: bool) -> None:
        """Choose whether the throttle is looked at; a flag that is set is looked at anyway."""
        self.calm = calm
        if self.is_pressing:
            self.calm = False

    def acted(self, ended: Ended) -> None:
        """The run is over. A brake outlives only a run that came to its target by itself."""
        if ended is not Ended.TARGET:
            self.brake_wanted = False
        self.stop_wanted = self.drop_when_still = False
        self.stop_reason = Ended.STOP
        self.be_calm(True)
