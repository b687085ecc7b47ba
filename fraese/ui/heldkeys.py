"""What a stroke of a key means: a tap, or a key that is held.

    told by the terminal   down ... repeat   repeat   repeat    up          (kitty's protocol)
                           TAP      REPEAT   HOLD     STILL     let go
    guessed, measured      TAP      REPEAT   HOLD     STILL     silence
    guessed                TAP      TAP      REPEAT   REPEAT    HOLD    STILL   silence
                              delay    interval

Rule 1: a key that is held sends its repeats after one long delay and then in short intervals, as no
        finger does. Where it was measured what this terminal sends, its delay is known as the first
        repeat, and the second one is enough; else there must be more.
Rule 2: strokes that come all at once waited somewhere: they are neither taps nor a key that is held
        now.
Rule 3: when a hold has ended, by another key or otherwise, and its key goes on repeating, that sets
        nothing in motion: it is spent until it is let go.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final

from fraese.control.heldjog import DEAD_MAN_S

#: Closer together strokes come out of a queue and not from a keyboard.
_AT_ONCE_S: Final = 0.008
#: Slower ones are a keyboard's in any terminal: one that was measured may have been set anew since.
_QUICK_S: Final = 0.06
#: Repeats come more often than this, also where a line is uneven; no finger does.
_SLOWEST_S: Final = 0.12
#: Of a terminal that was measured: its first repeat comes after so long, and so many intervals,
_DELAYS_S: Final = (0.12, 2.0)
_DELAY_INTERVALS: Final = 2
#: and its others are off by no more. Else fingers look like it.
_MOST_JITTER_S: Final = 0.04
#: Nobody who holds a key is silent for less.
_LEAST_SILENCE_S: Final = 0.08
#: After less a stroke is no first repeat, where nobody has measured it;
_LEAST_DELAY_S: Final = 0.15
#: where somebody has, it is off by so much more than an interval at most.
_OFF_S: Final = 0.01
#: So many quick repeats in a row, and it is held. Less may be a line that has stalled.
_QUICK_ONES: Final = 3
#: A key that has been silent for so long was let go, whether or not that was told.
_LOST_S: Final = 2.0
#: From this repeat on it is held, where the terminal tells repeats.
_REPEATS: Final = 2


class Stroke(Enum):
    """What one stroke is."""

    TAP = "one press"
    REPEAT = "a repeat that may yet be a long press"
    HOLD = "held from now on"
    STILL = "still held"
    SPENT = "a repeat of a key whose hold is over"
    QUEUED = "one of several that came all at once"


@dataclass(frozen=True, slots=True)
class Manners:
    """How the keys of a terminal repeat.

    Attributes:
        delay_s: from a press to its first repeat; 0: nobody has measured it.
        interval_s: between two repeats.
        jitter_s: what an interval was off at most.
    """

    delay_s: float = 0.0
    interval_s: float = 0.04
    jitter_s: float = 0.02

    @property
    def is_measured(self) -> bool:
        """Somebody has held a key here."""
        return self.delay_s > 0

    @property
    def are_plausible(self) -> bool:
        """A keyboard repeats so, and no finger."""
        low_s, high_s = _DELAYS_S
        return (
            max(low_s, _DELAY_INTERVALS * self.interval_s) <= self.delay_s <= high_s
            and self.interval_s >= _AT_ONCE_S
            and 0 <= self.jitter_s <= _MOST_JITTER_S
            and self._latest_s <= _SLOWEST_S
        )

    @property
    def quick_s(self) -> float:
        """Repeats come at least so often; a finger does not."""
        return min(max(self._latest_s, _QUICK_S), _SLOWEST_S)

    @property
    def _latest_s(self) -> float:
        """A repeat comes so late at most; what was measured in a second is not the worst."""
        return self.interval_s + max(self.jitter_s, _OFF_S)

    @property
    def silence_s(self) -> float:
        """After so long a silence the key was let go."""
        silence_s = 2 * self.interval_s + 3.5 * self.jitter_s
        return min(max(silence_s, _LEAST_SILENCE_S), DEAD_MAN_S)

    def is_delay(self, gap_s: float) -> bool:
        """So long is it, measured, from a press to its first repeat."""
        return self.is_measured and abs(gap_s - self.delay_s) <= self.jitter_s + _OFF_S


class HeldKeys:
    """Looks at every stroke.

    Attributes:
        manners: of the terminal.
        tells: the terminal tells when a key comes up.
        stroke: what is being done about,
        at_s: and when it came.
    """

    def __init__(self) -> None:
        self.manners = Manners()
        self.tells = False
        self.stroke = self._stroke = Stroke.TAP
        self.at_s = self._at_s = 0.0
        self._key = ""
        self._downs: set[str] = set()
        self._repeats = self._quick = 0
        self._first_gap_s = 0.0
        self._spent = ""

    @property
    def holds(self) -> str:
        """The key that is held; empty: none."""
        return self._key if self._stroke in (Stroke.HOLD, Stroke.STILL) else ""

    def press(self, key: str, at_s: float) -> Stroke:
        """A key went down or repeats, any key; at this time."""
        gap_s, self._at_s = at_s - self._at_s, at_s
        before = self._stroke
        if self.holds and key != self._key:
            self._spent = self._key
        is_again = key == self._key and before is not Stroke.SPENT
        self._key = key
        if key == self._spent and self._goes_on(gap_s):
            self._stroke = Stroke.SPENT
        else:
            if key == self._spent:
                self._spent = ""
            judge = self._told if self.tells else self._guessed
            self._stroke = judge(key, gap_s, before if is_again else None)
        if self._stroke is Stroke.SPENT:
            self._spent = key
        return self._stroke

    def is_done(self, stroke: Stroke = Stroke.TAP, at_s: float = 0.0) -> None:
        """What a key is for is being done, now: not always before the next one is pressed."""
        self.stroke, self.at_s = stroke, at_s

    def up(self, key: str) -> bool:
        """A key was let go, as the terminal tells; whether it was held."""
        was_held = self.holds == key != ""
        self._downs.discard(key)
        if key == self._spent:
            self._spent = ""
        if key == self._key:
            self._key, self._stroke = "", Stroke.TAP
        return was_held

    def end(self) -> None:
        """A stop, the mouse, another size: what is held counts no more."""
        if self.holds:
            self._spent = self._key
        self._key, self._stroke = "", Stroke.TAP

    def all_up(self) -> None:
        """Another window has the keys: nobody will tell when they come up."""
        self.end()
        self._downs.clear()

    def _goes_on(self, gap_s: float) -> bool:
        """It has not been let go since it was spent."""
        return self._spent in self._downs if self.tells else gap_s < self.manners.silence_s

    def _told(self, key: str, gap_s: float, before: Stroke | None) -> Stroke:
        if key not in self._downs or gap_s > _LOST_S:
            self._downs.add(key)
            self._repeats = 0
            return Stroke.TAP
        if before is None:
            # Another key came in between, and ended what it was held for.
            return Stroke.SPENT
        self._repeats += 1
        if before in (Stroke.HOLD, Stroke.STILL):
            return Stroke.STILL if gap_s < self.manners.silence_s else Stroke.SPENT
        return Stroke.HOLD if self._repeats >= _REPEATS else Stroke.REPEAT

    def _guessed(self, key: str, gap_s: float, before: Stroke | None) -> Stroke:
        if before is None:
            self._quick, self._first_gap_s = 0, 0.0
            return Stroke.TAP
        if before in (Stroke.HOLD, Stroke.STILL) and gap_s < self.manners.silence_s:
            return Stroke.STILL
        if gap_s < _AT_ONCE_S:
            return Stroke.QUEUED
        if gap_s > self.manners.quick_s:
            self._quick, self._first_gap_s = 0, gap_s
            return Stroke.REPEAT if self.manners.is_delay(gap_s) else Stroke.TAP
        self._quick += 1
        if self.manners.is_delay(self._first_gap_s) or self._quick >= _QUICK_ONES:
            return Stroke.HOLD
        return Stroke.REPEAT if self._first_gap_s >= _LEAST_DELAY_S else Stroke.TAP
