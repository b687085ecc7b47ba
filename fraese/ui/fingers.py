"""Fingers on keys: when a key is pressed, held and let go, whoever says so."""

from collections import deque
from collections.abc import Callable
from typing import Any, Final

from textual.events import Key
from textual.timer import Timer

from fraese.ui.heldkeys import HeldKeys, Stroke
from fraese.ui.widths import PAUSE_S, RepeatRule

#: More keys than may wait to be done.
_WAITING: Final = 300


class Fingers:
    """Hears every key, and silence.

    Args:
        repeats: told of every key,
        held: and of every stroke.
        set_timer: as the app's.
        let_go: called when a key that was held has been let go,
        unsure: and when a press that may have been a repeat was followed by none.
        rest: called when the next press counts as a first one.
    """

    def __init__(
        self,
        repeats: RepeatRule,
        held: HeldKeys,
        set_timer: Callable[[float, Callable[[], Any]], Timer],
        let_go: Callable[[], object],
        unsure: Callable[[], object],
        rest: Callable[[], object],
    ) -> None:
        self._repeats = repeats
        self._held = held
        self._set_timer = set_timer
        self._let_go = let_go
        self._unsure = unsure
        self._rest = rest
        self._timers: list[Timer] = []
        self._seen: deque[tuple[Key, Stroke, int]] = deque(maxlen=_WAITING)

    def press(self, event: Key) -> None:
        """This key was pressed, or repeats."""
        key, at_s = event.key, event.time
        held_before = self._held.holds
        factor = self._repeats.press(key, at_s)
        stroke = self._held.press(key, at_s)
        self._seen.append((event, stroke, factor))
        if held_before and self._held.holds != held_before:
            self._let_go()
        for timer in self._timers:
            timer.stop()
        self._timers = [self._set_timer(PAUSE_S, self._over)]
        silence_s = self._held.manners.silence_s
        if stroke in (Stroke.HOLD, Stroke.STILL):
            self._timers.append(self._set_timer(silence_s, self._let_go))
        elif stroke is Stroke.REPEAT and not self._held.tells:
            self._timers.append(self._set_timer(silence_s, self._unsure))

    def does(self, event: Key) -> None:
        """What this key is for is done next."""
        found = ((stroke, factor) for seen, stroke, factor in self._seen if seen is event)
        stroke, factor = next(found, (Stroke.TAP, 1))
        self._repeats.does(factor)
        self._held.is_done(stroke, event.time)

    def up(self, key: str) -> None:
        """This key was let go, as the terminal tells."""
        if self._held.up(key):
            self._let_go()

    def off(self, *, all_up: bool = False) -> None:
        """What is held counts no more.

        Args:
            all_up: nobody will tell when keys come up.
        """
        if self._held.holds:
            self._let_go()
        (self._held.all_up if all_up else self._held.end)()

    def _over(self) -> None:
        self._repeats.forget()
        self._rest()
