"""Numbers of grbl 1.1: what a refusal and an alarm are called there.

Rule 1: what is said in words here has one number there, the nearest; the words follow as a message,
        so that nothing is lost. What has no counterpart is 20, unsupported.

Source: the tables of grbl's own documentation, "Grbl v1.1 Interface".
"""

import re
from collections.abc import Mapping
from enum import IntEnum
from typing import Final

from fraese.errors import (
    Alarm,
    ConfigError,
    FraeseError,
    HomingError,
    LimitError,
    ProgramError,
    StateError,
)


class Code(IntEnum):
    """Numbers behind ``error:``."""

    OK = 0
    LETTER = 1
    NUMBER = 2
    STATEMENT = 3
    NEGATIVE = 4
    DISABLED = 5
    NOT_IDLE = 8
    LOCKED = 9
    OVERFLOW = 11
    TRAVEL = 15
    JOG = 16
    UNSUPPORTED = 20
    MODAL_GROUP = 21
    NO_FEED = 22
    NOT_WHOLE = 23
    AXIS_CONFLICT = 24
    REPEATED = 25
    NO_AXIS = 26
    LINE_NUMBER = 27
    NO_VALUE = 28
    G53 = 30
    AXIS_UNUSED = 31
    NO_AXIS_IN_PLANE = 32
    TARGET = 33
    RADIUS = 34
    NO_OFFSETS = 35
    UNUSED = 36
    TOOL = 38


class Alarmed(IntEnum):
    """Numbers behind ``ALARM:``."""

    HARD_LIMIT = 1
    SOFT_LIMIT = 2
    ABORT = 3
    PROBE_INITIAL = 4
    PROBE_CONTACT = 5
    HOMING_RESET = 6
    HOMING_PULL_OFF = 8
    HOMING_APPROACH = 9


#: After these a reset has to come before anything else.
CRITICAL: Final = frozenset({Alarmed.HARD_LIMIT, Alarmed.SOFT_LIMIT})

#: What a refused line says, in the order in which it is looked for.
REFUSALS: Final[tuple[tuple[str, Code], ...]] = (
    (r"is no G-code|numbers without letters|a remark stands", Code.LETTER),
    (r"contradict each other|is given twice on one line", Code.MODAL_GROUP),
    (r"both use axis words", Code.AXIS_CONFLICT),
    (r"there are two .* words on one line", Code.REPEATED),
    (r"needs an axis word", Code.NO_AXIS),
    (r"N has to be followed", Code.LINE_NUMBER),
    (r"axis words need a motion code", Code.AXIS_UNUSED),
    (r"needs a feed: give an F word|needs its own F word", Code.NO_FEED),
    (r"G53 needs G", Code.G53),
    (r"the .* word needs .* on its line|has no meaning in plane|takes either R or", Code.UNUSED),
    (r"takes no (axis )?words|take no I and J|takes no R word", Code.UNUSED),
    (r"an arc needs R or a centre", Code.NO_OFFSETS),
    (r"an arc with R needs its end", Code.NO_AXIS_IN_PLANE),
    (r"is too small: the end", Code.RADIUS),
    (r"cannot end where it starts|has no radius|does not close|has no way to go", Code.TARGET),
    (r"needs an? . word|needs a P word|G10 needs", Code.NO_VALUE),
    (r"must not be negative", Code.NEGATIVE),
    (r"whole number", Code.NOT_WHOLE),
    (r"is longer than", Code.OVERFLOW),
    (r"is not in the tool table", Code.TOOL),
    (r"is not a number|number is missing|is neither a number|is no word of G-code", Code.NUMBER),
)
_REFUSALS: Final = tuple((re.compile(pattern), code) for pattern, code in REFUSALS)

#: Alarms of this program, by their numbers.
ALARMS: Final[Mapping[int, Alarmed]] = {
    10: Alarmed.HARD_LIMIT,
    22: Alarmed.HOMING_PULL_OFF,
    23: Alarmed.HOMING_PULL_OFF,
    30: Alarmed.PROBE_INITIAL,
    31: Alarmed.PROBE_CONTACT,
}
_KINDS: Final[tuple[tuple[type[FraeseError], Code], ...]] = (
    (LimitError, Code.TRAVEL),
    (StateError, Code.LOCKED),
    (ConfigError, Code.STATEMENT),
    (Alarm, Code.LOCKED),
)


def code_of(error: FraeseError) -> Code:
    """The number of a refusal."""
    if isinstance(error, ProgramError):
        found = (code for pattern, code in _REFUSALS if pattern.search(error.message))
        return next(found, Code.UNSUPPORTED)
    return next((code for kind, code in _KINDS if isinstance(error, kind)), Code.UNSUPPORTED)


def alarm_of(error: FraeseError | None) -> Alarmed:
    """The number of what ended a job."""
    if isinstance(error, LimitError):
        return Alarmed.SOFT_LIMIT
    if isinstance(error, Alarm) and error.kind.number in ALARMS:
        return ALARMS[error.kind.number]
    return Alarmed.HOMING_APPROACH if isinstance(error, HomingError) else Alarmed.ABORT
