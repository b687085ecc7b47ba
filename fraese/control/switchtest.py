"""Trying the end switches by hand: each one is pressed, seen and ticked off.

All switches hang on one input, so that nobody but the operator knows which one was pressed. The
test therefore asks for one switch after the other:

    asked xmin:  open -> closed: seen   -> open: asked xmax -> ...

Rule 1: only a change from open to closed counts. A switch that is closed from the start proves
        nothing but a stuck switch or a broken wire, and is said so.
Rule 2: the next one is asked for when the input is open again.
"""

from collections.abc import Sequence

from fraese.phrases import phrase


class SwitchTest:
    """The list of switches and how far it is ticked off.

    Args:
        axes: names; every one has a lower and an upper end.

    Attributes:
        names: all switches in the order in which they are asked for ("xmin", "xmax", ...).
        presses: how often each was seen.
    """

    def __init__(self, axes: Sequence[str]) -> None:
        self.names = tuple(axis + end for axis in axes for end in ("min", "max"))
        self.presses = dict.fromkeys(self.names, 0)
        self._asked = 0
        self._closed: bool | None = None
        self._seen_now = False

    @property
    def asked(self) -> str:
        """The switch to be pressed now."""
        return self.names[self._asked]

    @property
    def done(self) -> bool:
        """Every switch was seen."""
        return all(self.presses.values())

    @property
    def stuck(self) -> bool:
        """The input is closed and was never seen to close."""
        return bool(self._closed) and not self._seen_now

    def ask(self, name: str) -> None:
        """Ask for this one next, again if it was seen before.

        Raises:
            ValueError: if there is no such switch.
        """
        self._asked = self.names.index(name)

    def step(self, by: int) -> None:
        """Ask for another one: the next (+1) or the one before (-1)."""
        self._asked = (self._asked + by) % len(self.names)

    def look(self, closed: bool) -> str:
        """Take a reading of the input; the name of the switch that was seen by it, or ""."""
        before, self._closed = self._closed, closed
        if closed and before is False:
            self._seen_now = True
            self.presses[self.asked] += 1
            return self.asked
        if not closed and self._seen_now:
            self._seen_now = False
            self._advance()
        return ""

    def _advance(self) -> None:
        """On to the next that was not seen yet; stay if there is none."""
        count = len(self.names)
        for ahead in range(1, count + 1):
            index = (self._asked + ahead) % count
            if not self.presses[self.names[index]]:
                self._asked = index
                return

    def sentence(self) -> str:
        """What the operator should do or know now."""
        if self.stuck:
            return phrase(
                "The input is closed though nothing was pressed: look for a stuck"
                " switch, a broken wire, or a wrong switches.closed_reads."
            )
        if self._seen_now:
            return phrase("Seen: {asked}. Let go.", asked=self.asked)
        if self.done:
            return phrase("All {count} switches were seen.", count=len(self.names))
        return phrase("Press {asked} by hand and hold it for a moment.", asked=self.asked)
