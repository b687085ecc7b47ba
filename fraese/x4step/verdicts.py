"""What a call is refused for, as tables: the first row that applies is the answer.

The manual prints a set of codes for every function and no order. Here the order is: before X4Init;
then the state (moving, then loaded, then whatever is missing); then the parameters, as its lists
have them. X4Start, X4Brake and X4Stop have no code for "before X4Init" in their lists: they
answer with what is true as well, not loaded and not active.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

from fraese.x4step.codes import (
    AXES,
    FREQ_HZ,
    MOST_STEPS,
    RAMP_MS,
    SIGNALS,
    X4ErrFreqTooHigh,
    X4ErrFreqTooLow,
    X4ErrInitNotDone,
    X4ErrIsActive,
    X4ErrIsLoaded,
    X4ErrNoSteps,
    X4ErrNotActive,
    X4ErrNotLoaded,
    X4Error,
    X4ErrParamFail,
    X4ErrRampFreq,
    X4ErrRampTooHigh,
    X4ErrStepsTooHigh,
    X4NoErr,
)


class Asked(NamedTuple):
    """A call, and the state that it meets; what a function has not, is what does no harm.

    Attributes:
        ready: X4Init was done.
        moving: one or more axes move.
        loaded: a path waits for its start.
        axis: 1 to 4.
        freq_hz: step rate of the leader.
        ramp_ms: time of each ramp.
        steps: of all four axes.
        signal: of X4SetOut.
    """

    ready: bool = False
    moving: bool = False
    loaded: bool = False
    axis: int = AXES[0]
    freq_hz: int = FREQ_HZ[0]
    ramp_ms: int = RAMP_MS[0]
    steps: tuple[int, ...] = (1, 0, 0, 0)
    signal: int = SIGNALS[0]


Row = tuple[X4Error, Callable[[Asked], bool]]
Rows = tuple[Row, ...]

_NO_INIT: Final[Row] = (X4ErrInitNotDone, lambda asked: not asked.ready)
_MOVING: Final[Row] = (X4ErrIsActive, lambda asked: asked.moving)
_STANDING: Final[Row] = (X4ErrNotActive, lambda asked: not asked.moving)
_LOADED: Final[Row] = (X4ErrIsLoaded, lambda asked: asked.loaded)
_NOT_LOADED: Final[Row] = (X4ErrNotLoaded, lambda asked: not asked.loaded)
_AXIS: Final[Row] = (X4ErrParamFail, lambda asked: asked.axis not in AXES)
_SIGNAL: Final[Row] = (X4ErrParamFail, lambda asked: asked.signal not in SIGNALS)
_RATE: Final[Rows] = (
    (X4ErrFreqTooHigh, lambda asked: asked.freq_hz > FREQ_HZ[1]),
    (X4ErrFreqTooLow, lambda asked: asked.freq_hz < FREQ_HZ[0]),
    (X4ErrRampTooHigh, lambda asked: asked.ramp_ms > RAMP_MS[1]),
    (X4ErrParamFail, lambda asked: asked.ramp_ms < RAMP_MS[0]),
    (X4ErrRampFreq, lambda asked: asked.ramp_ms > asked.freq_hz),
)
_STEPS: Final[Rows] = (
    (X4ErrNoSteps, lambda asked: not any(asked.steps)),
    (X4ErrStepsTooHigh, lambda asked: max(map(abs, asked.steps)) > MOST_STEPS),
)

LOAD: Final[Rows] = (_NO_INIT, _LOADED, *_RATE, *_STEPS)
MOVE: Final[Rows] = (_NO_INIT, _MOVING, _LOADED, _AXIS, *_RATE)
START: Final[Rows] = (_MOVING, _NOT_LOADED)
BRAKE: Final[Rows] = (_STANDING,)
BRAKE_CODES: Final[Rows] = (_NO_INIT,)
SET_OUT: Final[Rows] = (_NO_INIT, _SIGNAL)


def verdict(rows: Rows, asked: Asked) -> X4Error:
    """The first code whose reason applies; X4NoErr if none does."""
    return next((code for code, applies in rows if applies(asked)), X4NoErr)
