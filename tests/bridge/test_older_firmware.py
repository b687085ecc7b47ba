"""What a device of older firmware cannot do is said before anything is told it."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts, Lamp
from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.connection import Connection
from fraese.motor.clock import VirtualClock
from fraese.motor.phases import MOTRUN
from fraese.motor.seams import SwitchMode

HELLO = Hello(3, 7, (1, 2), 872, 80, 4, 32, 192, True, True, 0, 1, False, "uno")
LIT = CardFacts(c.CARD_PHASES, 3, MOTRUN, lamp=Lamp(4))


def telling(hello: Hello, facts: CardFacts) -> list[int]:
    """The kinds of what a device is told that answered so."""
    told: list[int] = []

    def commanding(kind: int, payload: bytes) -> Any:
        told.append(kind)
        return iter(())

    def unopened() -> Any:
        raise AssertionError

    session: Any = SimpleNamespace(hello=hello, commanding=commanding)
    connection = Connection(unopened, VirtualClock(), facts, "ttyACM0", 250_000, 1.0)
    list(connection.telling(session, (0, 0, 0), SwitchMode.STOP, 256))
    return told


def test_a_laser_s_power_needs_firmware_that_knows_it() -> None:
    with pytest.raises(PortError, match=r"firmware 1\.2, which cannot set a laser's power") as seen:
        telling(HELLO, LIT)
    assert seen.value.kind == alarms.BRIDGE_UNFIT
    assert c.KIND_POWER not in telling(HELLO, replace(LIT, lamp=None))
    assert c.KIND_POWER in telling(replace(HELLO, powers=True), LIT)
