"""What the frequency test is asked for: which stage, from where to where, who tells of a stall."""

from typing import Final

from fraese.control.calibration.sweep import Stage, Wish
from fraese.errors import UsageError
from fraese.phrases import spoken
from fraese.ui.calibrating import STAGES
from fraese.ui.dialogs.form import Field, Words, number_or_none
from fraese.ui.shape import AxisShape

_YES: Final = "yes"


def fields(axis: AxisShape) -> list[Field]:
    """What is asked."""
    return [
        Field("stage", spoken("start, cruise, acceleration, or all"), "all"),
        Field("low", spoken("from, steps/s (empty: as usual)")),
        Field("high", spoken("to")),
        Field("step", spoken("in steps of")),
        Field(
            "switch",
            spoken("the switch tells: yes or no"),
            "yes" if axis.has_switches else "no",
        ),
    ]


def asked(words: Words) -> tuple[Stage | None, Wish, bool]:
    """Which stage (None: all), which values, and whether the switch tells.

    Raises:
        UsageError: naming what is wrong.
    """
    if words["stage"] not in (*STAGES, "all", ""):
        raise UsageError(
            spoken(
                '"{words}" is no stage: {stages}, or all one by one.',
                words=words["stage"],
                stages=", ".join(STAGES),
            )
        )
    wish = Wish(
        number_or_none(words, "low", spoken("where to begin, or nothing")),
        number_or_none(words, "high", spoken("where to end, or nothing")),
        number_or_none(words, "step", spoken("from one value to the next, or nothing")),
    )
    stage = STAGES.get(words["stage"])
    if stage is None and wish != Wish():
        raise UsageError(spoken("From, to and step are of one stage: name it."))
    by_switch = words["switch"].lower() == _YES
    return stage, wish, by_switch
