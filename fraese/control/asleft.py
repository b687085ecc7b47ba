"""After a crash: what is known of the position, and whether it may be taken as it was left.

    the last record            position                 a person may
    at rest                    as it was left           reference again
    in motion, near            not trusted              take it as it was left, or reference again
    in motion, or damaged      not trusted              reference again

Rule 1: a motor without current stands in a detent near its last step. The first current pulls it
        to that step from less than half an electrical turn, since the phases are kept with the
        position: so near is as good as at rest, if nobody has pushed the axis meanwhile.
Rule 2: only a person can know that nobody has. Nothing is taken as it was left by itself but what
        was at rest.
"""

from dataclasses import dataclass

from fraese.control.controller import Controller
from fraese.control.position import Position
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.phrases import joined, phrase


@dataclass(frozen=True, slots=True)
class Left:
    """What a crash has left.

    Attributes:
        sentence: what is known, and what to do.
        known: what is known.
        nearness: what "as it was left" rests on; empty: it may not be taken so.
    """

    sentence: str
    known: str
    nearness: str

    @property
    def may_be_taken(self) -> bool:
        """The position may be taken as it was left."""
        return bool(self.nearness)


def left_by_crash(controller: Controller) -> Left | None:
    """What the crash before this start has left; None: there was none, or it is settled."""
    where = controller.position
    pushed = phrase("If an axis was pushed by {reach} or more, reference it.", reach=_reach(where))
    if where.doubt is not None:
        nearness = (
            phrase("The motors find back to where they were. {pushed}", pushed=pushed)
            if where.finds_back
            else ""
        )
        return Left(where.doubt_in_words(), where.doubted() + ".", nearness)
    if where.was_abandoned:
        known = phrase(
            "The program before was not closed, and the machine stood: the position is"
            " as it was left."
        )
        return Left(joined(" ", (known, pushed)), known, pushed)
    return None


def take_as_left(controller: Controller) -> None:
    """The position is where the machine was left; nothing moves.

    Raises:
        StateError: if nobody can say so, or the machine runs.
    """
    if controller.status is Status.RUN:
        raise StateError(phrase("The machine runs; nothing was done."))
    left, where = left_by_crash(controller), controller.position
    if left is None:
        raise StateError(
            phrase("No crash has put the position in doubt: there is nothing to take.")
        )
    if not left.may_be_taken:
        raise StateError(
            phrase(
                "{sentence}. Motors find back to where they were from less than {reach}, and"
                " it may be further; nothing was done.",
                sentence=left.sentence.rstrip("."),
                reach=_reach(where),
            )
        )
    where.take_as_left()


def _reach(where: Position) -> str:
    """Half an electrical turn of every motor, in words."""
    half = [steps // 2 for steps in where.turn_steps]
    return where.machine.in_words(where.machine.to_mm(tuple(half)))
