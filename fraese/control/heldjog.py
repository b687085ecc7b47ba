"""Somebody holds a jog key or a button: a dead man's switch.

    hold ...... hold ...... hold ......            every so often, from whoever sees that it is held
    it is held -----------------------> over: let go, or nobody has said so for ``silence_s``

Rule 1: who holds it says so again and again; silence ends it, whatever became of the app: the
        run loop looks, not the app (``jogging.py``).
Rule 2: what was said long ago and is heard only now counts from when it was said.
Rule 3: what is over stays over: late words set nothing in motion.
"""

from collections.abc import Callable
from typing import Final

from fraese.anythread import any_thread

#: Nobody has said for so long that he holds it: it is over.
DEAD_MAN_S: Final = 0.4


class Hold:
    """One such hold.

    Args:
        now: tells the time, s.
        silence_s: so long a silence ends it.
        since_s: when it was said first; None: now.
    """

    def __init__(
        self,
        now: Callable[[], float],
        silence_s: float = DEAD_MAN_S,
        since_s: float | None = None,
    ) -> None:
        self._now = now
        self._silence_s = silence_s
        self._until_s = (now() if since_s is None else since_s) + silence_s
        self._is_over = False

    @any_thread
    def hold(self, at_s: float | None = None) -> None:
        """It is still held.

        Args:
            at_s: when that was seen; None: now.
        """
        if self.is_held:
            said_s = self._now() if at_s is None else at_s
            self._until_s = max(self._until_s, said_s + self._silence_s)

    @any_thread
    def let_go(self) -> None:
        """It is held no more, and will not be again."""
        self._is_over = True

    @property
    @any_thread
    def is_held(self) -> bool:
        """It may go on."""
        if self._now() >= self._until_s:
            self._is_over = True
        return not self._is_over
