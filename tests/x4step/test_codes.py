"""Names, numbers and signatures, as the manual has them."""

import inspect
from typing import Any

import pytest

import fraese.x4step as x4

CODES = {
    "X4NoErr": 0,
    "X4ErrNoSteps": 1,
    "X4ErrFreqTooHigh": 2,
    "X4ErrFreqTooLow": 3,
    "X4ErrRampTooHigh": 4,
    "X4ErrRampFreq": 5,
    "X4ErrLPTNotFound": 6,
    "X4ErrNotActive": 7,
    "X4ErrParamFail": 8,
    "X4ErrInitNotDone": 9,
    "X4ErrIsActive": 10,
    "X4ErrNotLoaded": 11,
    "X4ErrIsLoaded": 12,
    "X4ErrStepsTooHigh": 13,
}
OTHERS = {
    "LPT1": 1, "LPT2": 2, "LPT3": 3, "LPT4": 4,
    "SIGNAL1ON": 1, "SIGNAL1OFF": 2, "SIGNAL2ON": 3, "SIGNAL2OFF": 4,
}  # fmt: skip
FUNCTIONS = {
    "X4Init": ["lpt"],
    "X4ReInit": [],
    "X4Load": ["weg1", "weg2", "weg3", "weg4", "freq", "ramp"],
    "X4Start": [],
    "X4Brake": [],
    "X4Stop": [],
    "X4GetState": [],
    "X4GetSteps": ["achse"],
    "X4MovePos": ["achse", "freq", "ramp"],
    "X4MoveNeg": ["achse", "freq", "ramp"],
    "X4BrakeCodes": ["codes"],
    "X4LastBrakeCode": [],
    "X4ClearTimer": [],
    "X4GetTimer": [],
    "X4GetIn": [],
    "X4SetOut": ["sig"],
}


@pytest.mark.parametrize(("name", "value"), [*CODES.items(), *OTHERS.items()])
def test_constants(name: str, value: int) -> None:
    assert getattr(x4, name) == value


def test_every_code_has_its_name_and_a_sentence() -> None:
    assert {code.name: code.value for code in x4.X4Error} == CODES
    assert all(code.sentence.endswith(".") for code in x4.X4Error)
    assert f"{x4.X4ErrRampFreq} {x4.X4ErrRampFreq:d}" == "5 5"


@pytest.mark.parametrize(("name", "parameters"), FUNCTIONS.items())
def test_functions_take_what_the_manual_says(name: str, parameters: list[str]) -> None:
    function: Any = getattr(x4, name)
    assert list(inspect.signature(function).parameters) == parameters


def test_all_is_told() -> None:
    assert {*CODES, *OTHERS, *FUNCTIONS, "X4Error", "X4Failure", "X4Step"} <= set(x4.__all__)
