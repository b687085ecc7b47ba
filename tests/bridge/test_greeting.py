"""The first words on a line: who answers is believed only if he speaks this protocol."""

import struct

import pytest

from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Decoder, Frame, frame
from fraese.motor.bridge.session import Session, greeting
from fraese.motor.bridge.stepwise import finish
from fraese.motor.clock import VirtualClock

RING = 900


class Greeter:
    """A Line with somebody at its end who answers a HELLO, and nothing else.

    Attributes:
        baud: the rate of this end of the line.
        said: everything that was sent there.
    """

    def __init__(self, clock: VirtualClock, version: int, speaks_baud: int) -> None:
        self._clock = clock
        self._version = version
        self._speaks_baud = speaks_baud
        self._decoder = Decoder()
        self._coming = b""
        self.baud = c.DEFAULT_BAUD
        self.said = b""
        self.closed = False

    def read(self, timeout_s: float) -> bytes:
        self._clock.wait_until(self._clock.now_ns() + round(timeout_s * 1e9))
        data, self._coming = self._coming, b""
        return data

    def write(self, data: bytes) -> None:
        self.said += data
        if self.baud != self._speaks_baud:
            return
        for item in self._decoder.feed(data):
            if isinstance(item, Frame) and item.kind == c.KIND_HELLO:
                session = int.from_bytes(item.payload[-2:], "little")
                self._coming += frame(c.KIND_HELLO_REPLY, 0, self._reply(session))

    def _reply(self, session: int) -> bytes:
        numbers = (self._version, session, 1, 0, RING, c.PAYLOAD_MAX, 4, 32, c.WINDOW, 3, 1, 1, 0)
        return struct.pack("<BHBBHBBBBBBHB", *numbers) + b"model"

    def set_baud(self, baud: int) -> None:
        self.baud = baud

    def close(self) -> None:
        self.closed = True


def greeted(line: Greeter, clock: VirtualClock) -> Session:
    return finish(greeting(line, clock, "/dev/ttyX", c.DEFAULT_BAUD))


def test_a_bridge_of_this_version_is_taken() -> None:
    clock = VirtualClock()
    line = Greeter(clock, c.PROTOCOL_VERSION, c.DEFAULT_BAUD)
    assert greeted(line, clock).hello.ring == RING
    assert not line.closed


@pytest.mark.parametrize("version", [c.PROTOCOL_VERSION - 1, c.PROTOCOL_VERSION + 1])
def test_one_of_another_version_is_told_nothing_more(version: int) -> None:
    clock = VirtualClock()
    line = Greeter(clock, version, c.DEFAULT_BAUD)
    with pytest.raises(PortError, match=f"speaks version {version} of the protocol, this program"):
        greeted(line, clock)
    assert line.closed
    kinds = {item.kind for item in Decoder().feed(line.said) if isinstance(item, Frame)}
    assert kinds == {c.KIND_HELLO}


def test_one_of_another_rate_is_found_and_named() -> None:
    clock = VirtualClock()
    line = Greeter(clock, c.PROTOCOL_VERSION, 115_200)
    with pytest.raises(PortError, match="speaks 115200 baud, not 250000: write baud = 115200"):
        greeted(line, clock)
    assert line.closed
