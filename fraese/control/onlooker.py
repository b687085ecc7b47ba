"""An onlooker: somebody who sees what no driver can know, on a simulated mill.

    controller --"where are the carriages?"--> onlooker --> the simulated mill
    at metal nobody looks on: there are no answers

Rule 1: what an onlooker sees is shown and told, never used: on metal the machine does without.
Rule 2: lost steps are counted from the beginning of a job.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from fraese.anythread import any_thread
from fraese.phrases import joined, phrase


@dataclass(frozen=True, slots=True)
class Seen:
    """What an onlooker saw; everything is empty where nobody looks on.

    Attributes:
        carriages_mm: where the carriages really are, in machine coordinates whose zero lies where
            a reference run at the true switches would put it; on an axis without switches where
            its carriage stood when the machine was new. Degrees on a rotary axis. So a referenced
            axis that lost nothing, and is configured as it is built, has here its ``position_mm``.
        lost_steps: steps of this job that were asked for and not made: by so much a position is
            ahead of its carriage, in steps of the card and in the direction of the axis.
        lost_why: why, half a sentence for each axis; empty: nothing was lost.
    """

    carriages_mm: tuple[float, ...] = ()
    lost_steps: tuple[float, ...] = ()
    lost_why: tuple[str, ...] = ()


class Onlooker(Protocol):
    """Somebody who looks on; all but ``look`` is called from the run loop's thread."""

    def begin(self) -> None:
        """A job begins: what was lost so far is old."""

    def rest(self) -> None:
        """The motors stand: no step follows the last one for a while."""

    @any_thread
    def look(self) -> Seen:
        """What is to be seen now."""


class Nobody:
    """Nobody looks on."""

    def begin(self) -> None:
        """Nobody takes note."""

    def rest(self) -> None:
        """Nobody takes note."""

    @any_thread
    def look(self) -> Seen:
        """Nothing."""
        return Seen()


def lost_in_words(names: Sequence[str], seen: Seen, made_steps: Sequence[int]) -> str:
    """What was lost, a sentence; empty if nothing.

    Args:
        names: of the axes.
        seen: what was lost and why.
        made_steps: steps that were given out in the same time, per axis.
    """
    lost = [
        phrase(
            "{name} {steps:g} of {made} steps ({why})",
            name=name.upper(),
            steps=abs(steps),
            made=made,
            why=why,
        )
        for name, steps, why, made in zip(
            names, seen.lost_steps, seen.lost_why, made_steps, strict=False
        )
        if why
    ]
    return phrase("Lost on the simulated mill: {lost}.", lost=joined(", ", lost)) if lost else ""
