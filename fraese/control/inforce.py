"""Which bounds hold: those of every record that a power cut may leave just now.

durable: A       asked for: B   -->  what both bound, and the lease that is over later
durable: B                      -->  what B bounds, and its lease
"""

from typing import NamedTuple

from fraese.control.bounds import Box, common


class Asked(NamedTuple):
    """A record that is wanted.

    Attributes:
        box: what it bounds; None: nothing, the machine stands.
        at_ns: when it was asked for.
        over_ns: when its lease is over, see ``Lease``.
        runs: the motors ran then.
    """

    box: Box | None
    at_ns: int
    over_ns: int
    runs: bool


_NOTHING = Asked(None, 0, 0, runs=False)


class InForce:
    """The last record that was asked for, and the last durable one.

    Attributes:
        asked: the former,
        durable: the latter.
        box: what holds; None: nothing, or nothing is bounded.
        over_ns: no lease is longer.
    """

    def __init__(self) -> None:
        self.asked = self.durable = _NOTHING
        self.box: Box | None = None
        self.over_ns = 0

    def ask(self, asked: Asked) -> None:
        """Until it is durable a cut may leave the old one or the new one: both must hold."""
        self.box = common(self.box, asked.box)
        self.asked = asked
        self.over_ns = max(self.durable.over_ns, asked.over_ns)

    def take(self, durable: Asked) -> None:
        """This one became durable; an older one than was asked for bounds only what both do."""
        is_last = durable is self.asked
        self.box = durable.box if is_last else common(durable.box, self.asked.box)
        self.over_ns = durable.over_ns if is_last else max(self.over_ns, durable.over_ns)
        self.durable = durable
