"""Fingers on keys: when no key comes any more, one that was held has been let go."""

from collections.abc import Callable
from typing import Any

from textual.timer import Timer

from fraese.ui.widths import LET_GO_S, PAUSE_S, RepeatRule


class Fingers:
    """Hears every key, and silence.

    Args:
        repeats: told of every key.
        set_timer: as the app's.
        let_go: called when a key that was held has been let go.
        rest: called when the next press counts as a first one.
    """

    def __init__(
        self,
        repeats: RepeatRule,
        set_timer: Callable[[float, Callable[[], Any]], Timer],
        let_go: Callable[[], object],
        rest: Callable[[], object],
    ) -> None:
        self._repeats = repeats
        self._set_timer = set_timer
        self._let_go = let_go
        self._rest = rest
        self._timers: list[Timer] = []

    def press(self, key: str, at_s: float) -> None:
        """This key was pressed."""
        self._repeats.press(key, at_s)
        for timer in self._timers:
            timer.stop()
        self._timers = [self._set_timer(PAUSE_S, self._over)]
        if self._repeats.held:
            self._timers.append(self._set_timer(LET_GO_S, self._let_go))

    def _over(self) -> None:
        self._repeats.forget()
        self._rest()
