"""X4Step: up to four stepper motors with clock and direction at a parallel port.

The library of B. Lewetz (X4Step 1.0, 1995), for Python: its sixteen functions under their own
names, and one class behind them.

    from fraese.x4step import X4GetState, X4Init, X4Load, X4ReInit, X4Start

    X4Init(2)
    X4Load(1000, 500, 0, 0, 2000, 50)      # steps of axes 1 to 4, Hz, ms
    X4Start()
    while X4GetState():
        pass
    X4ReInit()

Steps are made in the background. Nothing is known here of millimetres, soft limits or end
switches: a motion ends at its target, by X4Brake, X4Stop or a key.
"""

from fraese.x4step.codes import (
    LPT1,
    LPT2,
    LPT3,
    LPT4,
    SIGNAL1OFF,
    SIGNAL1ON,
    SIGNAL2OFF,
    SIGNAL2ON,
    X4ErrFreqTooHigh,
    X4ErrFreqTooLow,
    X4ErrInitNotDone,
    X4ErrIsActive,
    X4ErrIsLoaded,
    X4ErrLPTNotFound,
    X4ErrNoSteps,
    X4ErrNotActive,
    X4ErrNotLoaded,
    X4Error,
    X4ErrParamFail,
    X4ErrRampFreq,
    X4ErrRampTooHigh,
    X4ErrStepsTooHigh,
    X4Failure,
    X4NoErr,
)
from fraese.x4step.functions import (
    X4Brake,
    X4BrakeCodes,
    X4ClearTimer,
    X4GetIn,
    X4GetState,
    X4GetSteps,
    X4GetTimer,
    X4Init,
    X4LastBrakeCode,
    X4Load,
    X4MoveNeg,
    X4MovePos,
    X4ReInit,
    X4SetOut,
    X4Start,
    X4Stop,
    getch,
    kbhit,
    last_scan_code,
)
from fraese.x4step.machine import X4Step

__all__ = [
    "LPT1",
    "LPT2",
    "LPT3",
    "LPT4",
    "SIGNAL1OFF",
    "SIGNAL1ON",
    "SIGNAL2OFF",
    "SIGNAL2ON",
    "X4Brake",
    "X4BrakeCodes",
    "X4ClearTimer",
    "X4ErrFreqTooHigh",
    "X4ErrFreqTooLow",
    "X4ErrInitNotDone",
    "X4ErrIsActive",
    "X4ErrIsLoaded",
    "X4ErrLPTNotFound",
    "X4ErrNoSteps",
    "X4ErrNotActive",
    "X4ErrNotLoaded",
    "X4ErrParamFail",
    "X4ErrRampFreq",
    "X4ErrRampTooHigh",
    "X4ErrStepsTooHigh",
    "X4Error",
    "X4Failure",
    "X4GetIn",
    "X4GetState",
    "X4GetSteps",
    "X4GetTimer",
    "X4Init",
    "X4LastBrakeCode",
    "X4Load",
    "X4MoveNeg",
    "X4MovePos",
    "X4NoErr",
    "X4ReInit",
    "X4SetOut",
    "X4Start",
    "X4Step",
    "X4Stop",
    "getch",
    "kbhit",
    "last_scan_code",
]
