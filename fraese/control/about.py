"""What is said of a job when it is started, besides its name and what it does."""

from typing import NamedTuple

from fraese.control.jobs import Note, Plan
from fraese.control.retract import Detour


class About(NamedTuple):
    """Of one job.

    Attributes:
        lines: how many lines it has, for the progress.
        expected_s: planned duration, likewise.
        detour: where to go while it is held; None: stay.
        note: says what must be known to go on with it; None: nobody can.
        plan: when it comes to which move; None: nobody knows.
        height_map: name of the one to which its moves are bent; empty: none.
        guest: it may be done while another one waits for an answer.
    """

    lines: int = 0
    expected_s: float = 0.0
    detour: Detour | None = None
    note: Note | None = None
    plan: Plan | None = None
    height_map: str = ""
    guest: bool = False


#: Nothing is.
PLAIN = About()
#: A move that somebody makes by hand.
BY_HAND = About(guest=True)
