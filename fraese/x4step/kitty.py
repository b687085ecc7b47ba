"""Kitty's keyboard protocol, as far as it is switched on and off.

    begin   known: push the flags         unknown: ask, and go on; the answer comes as a report
    heard   ESC [ ? flags u               it is known: push
            ESC [ ? ... c                 every terminal answers this; alone: it is not known
    end     pop; ask for the second of these: what comes before its answer was still typed before

Rule 1: nobody waits for an answer while axes begin to move.
Rule 2: a terminal that answers nothing is waited for once, a quarter of a second, at the end.

Asked for are all keys, as events, with the text and with the place of keys, and change of focus: a
key that is let go in another window is told to that window.
"""

import re
from collections.abc import Callable
from typing import Final, Literal

#: Disambiguate 1, event types 2, alternate keys 4, all keys 8, text 16.
_FLAGS: Final = 31
PUSH: Final = f"\x1b[>{_FLAGS}u\x1b[?1004h".encode()
POP: Final = b"\x1b[?1004l\x1b[<u"
ASK_FLAGS: Final = b"\x1b[?u"
ASK_DEVICE: Final = b"\x1b[c"
FOCUS_LOST: Final = "\x1b[O"
_FLAGS_ARE: Final = re.compile(r"\x1b\[\?[0-9]*u")
_DEVICE_IS: Final = re.compile(r"\x1b\[\?[0-9;]*c")
_PATIENCE_NS: Final = 250_000_000

#: Ask; or it knows the protocol; or it does not.
Wanted = Literal["auto", "kitty", "plain"]


class Kitty:
    """Switches the protocol of one terminal.

    Args:
        write: sends bytes to it.
        wanted: whether to ask.
        now_ns: the time.

    Attributes:
        is_on: the flags are pushed.
        is_known: the terminal knows the protocol; None: it has not been asked, or not answered.
    """

    def __init__(
        self, write: Callable[[bytes], None], wanted: Wanted, now_ns: Callable[[], int]
    ) -> None:
        self._write = write
        self._now_ns = now_ns
        self._due = 0
        self._until_ns = 0
        self._is_begun = False
        self.is_on = False
        self.is_known: bool | None = {"auto": None, "kitty": True, "plain": False}[wanted]

    def begin(self) -> None:
        """Keys are wanted."""
        self._is_begun = True
        if self.is_known:
            self._push()
        elif self.is_known is None and not self._due:
            self._ask(ASK_FLAGS + ASK_DEVICE)

    def heard(self, report: str) -> None:
        """The terminal answered something."""
        if _FLAGS_ARE.fullmatch(report) and self.is_known is None:
            self.is_known = True
            if self._is_begun:
                self._push()
        elif _DEVICE_IS.fullmatch(report):
            self._due = max(0, self._due - 1)
            self.is_known = bool(self.is_known)

    def end(self) -> None:
        """No more keys are wanted; those that were sent come until ``settled``."""
        self._is_begun = False
        if self.is_on:
            self.is_on = False
            self._ask(POP + ASK_DEVICE)

    def settled(self) -> bool:
        """Every answer is here, or will not come."""
        if self._due and self._now_ns() >= self._until_ns:
            self._due = 0
            self.is_known = bool(self.is_known)
        return not self._due

    def _push(self) -> None:
        if not self.is_on:
            self.is_on = True
            self._write(PUSH)

    def _ask(self, question: bytes) -> None:
        self._due += 1
        self._until_ns = self._now_ns() + _PATIENCE_NS
        self._write(question)
