"""Which boot loader is behind a serial port: greeted in its own words it answers, or does not.

    reset by DTR --> STK500v1: get sync          0x30 0x20       --> 0x14 0x10
                     STK500v2: sign on           0x1B ... 0x01   --> 0x1B ...

Rule 1: greetings only: nothing is read from a chip, or written. avrdude would find out as well, but
        takes a minute for each one that does not answer.

The words are those of Atmel's application notes AVR061 and AVR068.
"""

import functools
import operator
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Final

import serial

from fraese.motor.bridge.boards import Try

#: How long the reset line is low, and how long a boot loader takes to begin.
_RESET_S: Final = 0.05
_BEGINS_S: Final = 0.1
#: So often it is greeted, and so long an answer takes: optiboot listens for a second.
_GREETINGS: Final = 5
_ANSWERS_S: Final = 0.2

_SIGN_ON: Final = bytes((0x1B, 1, 0, 1, 0x0E, 1))
#: What is said, and what an answer holds, by avrdude's name of the protocol.
_WORDS: Final[Mapping[str, tuple[bytes, bytes]]] = {
    "arduino": (b"\x30\x20", b"\x14\x10"),
    "wiring": (_SIGN_ON + bytes([functools.reduce(operator.xor, _SIGN_ON)]), b"AVRISP"),
}


def answers(device: str, attempt: Try) -> bool:
    """A boot loader of this kind is there; the board is reset.

    Args:
        device: its serial port.
        attempt: how it would be written.
    """
    greeting, answer = _WORDS[attempt.board.programmer]
    try:
        with serial.Serial(device, attempt.baud, timeout=_ANSWERS_S, exclusive=True) as port:
            _reset(port)
            heard = b""
            for _ in range(_GREETINGS):
                port.write(greeting)
                heard += port.read(len(answer))
                heard += port.read(port.in_waiting)
                if answer in heard:
                    return True
    except (OSError, ValueError):
        # Whoever writes it will be told why.
        return False
    return False


def _reset(port: serial.Serial) -> None:
    # What is no serial port in earnest has no such lines.
    with suppress(OSError):
        port.dtr = port.rts = False
        time.sleep(_RESET_S)
        port.dtr = port.rts = True
    time.sleep(_BEGINS_S)
    port.reset_input_buffer()
