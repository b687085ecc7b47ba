"""What is answered to a program's questions where a script runs it, and nobody sits at a terminal.

    --answer "zero Z" --answer ""   what would be typed, in turn
    --yes                           to all others: go on

Rule 1: a question that nobody answers ends the job where the machine stands. A program that asks
        has a reason: the next tool, or work that is to be turned over.
"""

from collections.abc import Sequence
from typing import Final

from fraese.phrases import phrase

#: What is shown instead of an answer that is only "Enter".
GO_ON: Final = phrase("go on")


class Answers:
    """Answers that were given beforehand.

    Args:
        given: lines as they would be typed; an empty one goes on.
        yes: all further questions are answered, too.
    """

    def __init__(self, given: Sequence[str] = (), *, yes: bool = False) -> None:
        self._given = list(given)
        self._yes = yes

    def next(self) -> str | None:
        """The next answer; None: a person has to be asked."""
        if self._given:
            return self._given.pop(0).strip()
        return "" if self._yes else None
