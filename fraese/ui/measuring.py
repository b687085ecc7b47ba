"""How the keys of this terminal repeat: measured while somebody holds one.

    press    repeat  repeat  repeat ...
      | delay  | gap   | gap   | gap           ``REPEATS`` gaps, then it is known

Rule 1: only what can be told from fingers is believed (``Manners.are_plausible``): short intervals
        behind a long delay. What else was seen is said, and everything stays as it was.
Rule 2: a gap that no repeat makes is the beginning of another try.
"""

import os
from collections.abc import Mapping
from statistics import median
from typing import Final

from fraese.errors import UsageError
from fraese.phrases import spoken
from fraese.ui.heldkeys import Manners

#: So many gaps between repeats are looked at: a second, at thirty of them a second.
REPEATS: Final = 30
#: In the middle of repeats nothing is silent for so long, and still held.
_ANEW_S: Final = 0.25
#: Nor before the first one.
_LATEST_S: Final = 2.0


class Measurement:
    """Strokes of one key, while it is held."""

    def __init__(self) -> None:
        self._at_s: list[float] = []
        self._last_s = 0.0

    def stroke(self, at_s: float) -> None:
        """It was pressed, or repeats; at this time. What is more than enough changes nothing."""
        if self._at_s and at_s - self._last_s >= self._patience_s:
            self._at_s.clear()
        self._last_s = at_s
        if not self.is_enough:
            self._at_s.append(at_s)

    @property
    def _patience_s(self) -> float:
        return _ANEW_S if len(self._at_s) > 1 else _LATEST_S

    @property
    def gaps(self) -> int:
        """So many gaps between repeats were seen."""
        return max(len(self._at_s) - 2, 0)

    @property
    def is_enough(self) -> bool:
        """It can be judged."""
        return self.gaps >= REPEATS

    def manners(self) -> Manners:
        """How the key repeats, when it is enough.

        Raises:
            UsageError: if that cannot be told from fingers.
        """
        delay_s, *gaps_s = (b - a for a, b in zip(self._at_s, self._at_s[1:], strict=False))
        interval_s = median(gaps_s)
        found = Manners(delay_s, interval_s, max(abs(gap_s - interval_s) for gap_s in gaps_s))
        if not found.are_plausible:
            raise UsageError(
                spoken(
                    "That cannot be told from fingers: {figures}. Nothing is kept; hold one key,"
                    " and see that the keyboard repeats after 0.12 s or more, and then at least"
                    " ten times a second and evenly.",
                    figures=figures(found),
                )
            )
        return found


def figures(manners: Manners) -> str:
    """What was measured, in words."""
    return spoken(
        "the first repeat after {delay} ms, then one every {interval} ms, at most {jitter} ms off",
        delay=round(manners.delay_s * 1000),
        interval=round(manners.interval_s * 1000),
        jitter=round(manners.jitter_s * 1000),
    )


def terminal_name(environment: Mapping[str, str] = os.environ) -> str:
    """By what terminals are told apart whose keys may repeat otherwise."""
    named = [environment.get(key, "") for key in ("TERM", "TERM_PROGRAM")]
    is_far = any(environment.get(key) for key in ("SSH_CONNECTION", "SSH_TTY"))
    is_browser = "web_driver" in environment.get("TEXTUAL_DRIVER", "")
    words = [*(ascii(name)[1:-1][:20] for name in named), "ssh" * is_far, "browser" * is_browser]
    return " ".join(filter(None, words)) or "terminal"
