"""Numbers of the X4Step manual: return codes, ports, signals (sections 4.1, X4Init, X4SetOut)."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Final

from fraese.errors import StateError
from fraese.phrases import phrase


class X4Error(IntEnum):
    """What a function answers; 0 is success."""

    X4NoErr = 0
    X4ErrNoSteps = 1
    X4ErrFreqTooHigh = 2
    X4ErrFreqTooLow = 3
    X4ErrRampTooHigh = 4
    X4ErrRampFreq = 5
    X4ErrLPTNotFound = 6
    X4ErrNotActive = 7
    X4ErrParamFail = 8
    X4ErrInitNotDone = 9
    X4ErrIsActive = 10
    X4ErrNotLoaded = 11
    X4ErrIsLoaded = 12
    X4ErrStepsTooHigh = 13

    @property
    def sentence(self) -> str:
        """What it means, for a person."""
        return _SENTENCES[self]


X4NoErr: Final = X4Error.X4NoErr
X4ErrNoSteps: Final = X4Error.X4ErrNoSteps
X4ErrFreqTooHigh: Final = X4Error.X4ErrFreqTooHigh
X4ErrFreqTooLow: Final = X4Error.X4ErrFreqTooLow
X4ErrRampTooHigh: Final = X4Error.X4ErrRampTooHigh
X4ErrRampFreq: Final = X4Error.X4ErrRampFreq
X4ErrLPTNotFound: Final = X4Error.X4ErrLPTNotFound
X4ErrNotActive: Final = X4Error.X4ErrNotActive
X4ErrParamFail: Final = X4Error.X4ErrParamFail
X4ErrInitNotDone: Final = X4Error.X4ErrInitNotDone
X4ErrIsActive: Final = X4Error.X4ErrIsActive
X4ErrNotLoaded: Final = X4Error.X4ErrNotLoaded
X4ErrIsLoaded: Final = X4Error.X4ErrIsLoaded
X4ErrStepsTooHigh: Final = X4Error.X4ErrStepsTooHigh

LPT1: Final = 1
LPT2: Final = 2
LPT3: Final = 3
LPT4: Final = 4

SIGNAL1ON: Final = 1
SIGNAL1OFF: Final = 2
SIGNAL2ON: Final = 3
SIGNAL2OFF: Final = 4

PORTS: Final = (LPT1, LPT2, LPT3, LPT4)
AXES: Final = (1, 2, 3, 4)
#: In the order of X4GetIn's bits, from 4 down.
INPUT_PINS: Final = (11, 10, 12, 13, 15)
SIGNALS: Final = (SIGNAL1ON, SIGNAL1OFF, SIGNAL2ON, SIGNAL2OFF)
MOST_STEPS: Final = 16_777_216
FREQ_HZ: Final = (10, 20_000)
RAMP_MS: Final = (0, 1000)
MOST_CODES: Final = 20
#: The make code of ESC, which brakes without being asked for.
ESC_CODE: Final = 1

_SENTENCES: Final[Mapping[X4Error, str]] = {
    X4NoErr: phrase("No error."),
    X4ErrNoSteps: phrase("At least one axis must have at least one step to make."),
    X4ErrFreqTooHigh: phrase("The step rate is above {freq_hz} Hz.", freq_hz=FREQ_HZ[1]),
    X4ErrFreqTooLow: phrase("The step rate is below {freq_hz} Hz.", freq_hz=FREQ_HZ[0]),
    X4ErrRampTooHigh: phrase("The ramp is longer than {ramp_ms} ms.", ramp_ms=RAMP_MS[1]),
    X4ErrRampFreq: phrase("The ramp in ms is above the step rate in Hz."),
    X4ErrLPTNotFound: phrase("The parallel port is not there, or somebody else has it."),
    X4ErrNotActive: phrase("No axis moves."),
    X4ErrParamFail: phrase("A parameter is out of range."),
    X4ErrInitNotDone: phrase("X4Init was not called."),
    X4ErrIsActive: phrase("One or more axes move; wait until they stand."),
    X4ErrNotLoaded: phrase("No path is loaded."),
    X4ErrIsLoaded: phrase("A path is loaded already; start it first."),
    X4ErrStepsTooHigh: phrase("A path has at most {most_steps} steps.", most_steps=MOST_STEPS),
}


class X4Failure(StateError):
    """A refused call of ``X4Step``; nothing was loaded or moved.

    Attributes:
        code: what the function of the manual answers.
    """

    def __init__(self, code: X4Error) -> None:
        self.code = code
        super().__init__(f"{code.name} ({code:d}): {code.sentence}")
