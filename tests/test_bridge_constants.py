"""The numbers of the bridge protocol are the same in the firmware and in Python."""

import re
from enum import IntFlag
from pathlib import Path

from fraese.motor.bridge import constants as c
from fraese.motor.seams import Ended

_HEADER = Path(__file__).resolve().parents[1] / "firmware" / "protocol.h"
_FLAGS: dict[str, type[IntFlag]] = {"STATE": c.State, "MORE": c.More}


def _header() -> dict[str, int]:
    text = _HEADER.read_text()
    return {name: int(value, 0) for name, value in re.findall(r"#define (\w+) (\w+)\n", text)}


def _python(name: str) -> int | None:
    prefix, _, rest = name.partition("_")
    if prefix in _FLAGS:
        return _FLAGS[prefix][rest]
    value = getattr(c, name, None)
    return value if isinstance(value, int) else None


def test_every_number_of_the_header() -> None:
    header = _header()
    assert len(header) > 80
    assert {name: _python(name) for name in header} == header


def test_every_number_of_python_is_in_the_header() -> None:
    own = {"DEFAULT_BAUD", "MOST_TICKS", "MOST_PIECES", "TABLE_DRIVE", "TABLE_HOLD"}
    names = {n for n, value in vars(c).items() if n.isupper() and isinstance(value, int)}
    assert names - own <= _header().keys()


def test_reasons_have_one_order() -> None:
    known = {ended.value for ended in Ended}
    for number, name in enumerate(c.ENDED_NAMES):
        assert getattr(c, f"ENDED_{name.upper()}") == number
        assert name in known | {"silence"}
