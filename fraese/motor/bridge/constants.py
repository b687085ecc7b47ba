"""Numbers of the bridge protocol; ``docs/bridge-protocol.md`` explains them.

The firmware has the same names in ``firmware/protocol.h``; a test compares the two.
"""

from enum import IntFlag
from typing import Final

from fraese.blocks import WatchAction
from fraese.motor.seams import Ended
from fraese.phrases import phrase

PROTOCOL_VERSION: Final = 3
DEFAULT_BAUD: Final = 250_000

# Bytes on the line.
RESERVED_MASK: Final = 0xF8
RESERVED: Final = 0xB0
FLAG: Final = 0xB0
URGENT_STATUS: Final = 0xB3
URGENT_BRAKE: Final = 0xB5
ESCAPE: Final = 0xB7
URGENT_STOP: Final = 0xB6
ESCAPE_XOR: Final = 0x20

# Frames.
CRC_START: Final = 0xFFFF
PAYLOAD_MAX: Final = 80
WINDOW: Final = 192

# Host to device.
KIND_HELLO: Final = 0x01
KIND_TABLE: Final = 0x02
KIND_CARD: Final = 0x03
KIND_BLOCKS: Final = 0x04
KIND_START: Final = 0x05
KIND_RESUME: Final = 0x06
KIND_FLUSH: Final = 0x07
KIND_IDLE: Final = 0x08
KIND_OUTPUTS: Final = 0x09
KIND_MODE: Final = 0x0A
KIND_OVERRIDE: Final = 0x0B
KIND_PHASES: Final = 0x0C
KIND_PING: Final = 0x0D
KIND_CLOSE: Final = 0x0E
KIND_POWER: Final = 0x0F

# Device to host.
KIND_HELLO_REPLY: Final = 0x41
KIND_ACK: Final = 0x42
KIND_STATUS: Final = 0x43

# HELLO reply: capabilities.
ABLE_PHASES: Final = 0x01
ABLE_CLOCKS: Final = 0x02
ABLE_POWER: Final = 0x04

# Why a command was refused.
REFUSED_NO_HELLO: Final = 1
REFUSED_NO_CARD: Final = 2
REFUSED_PAYLOAD: Final = 3
REFUSED_MOVING: Final = 4
REFUSED_KIND: Final = 5
REFUSED_BLOCK: Final = 6
REFUSED_EPOCH: Final = 7

#: What to say to a user about each of them.
REFUSALS: Final = {
    REFUSED_NO_HELLO: phrase("nobody has said hello"),
    REFUSED_NO_CARD: phrase("no card was uploaded"),
    REFUSED_PAYLOAD: phrase("a length or value is out of range"),
    REFUSED_MOVING: phrase("only at standstill"),
    REFUSED_KIND: phrase("unknown command"),
    REFUSED_BLOCK: phrase("a block cannot be played as it says"),
    REFUSED_EPOCH: phrase("sent before the queue was known to be dropped"),
}

ACK_GAP: Final = 0x01


class State(IntFlag):
    """Byte ``state`` of a STATUS."""

    MOVING = 0x01
    HELD = 0x02
    ENERGISED = 0x04
    BRAKING = 0x08
    SWITCH = 0x10
    LATCHED = 0x20
    TORN = 0x40
    DRY = 0x80


class More(IntFlag):
    """Byte ``more`` of a STATUS."""

    IN_HAND = 0x01
    CARD = 0x02
    CONTACT = 0x04


ENDED_NOT: Final = 0
ENDED_TARGET: Final = 1
ENDED_SWITCH: Final = 2
ENDED_WATCH: Final = 3
ENDED_STOP: Final = 4
ENDED_FLUSH: Final = 5
ENDED_SILENCE: Final = 6

#: ``Ended.value`` by its number on the line.
ENDED_NAMES: Final = ("not", "target", "switch", "watch", "stop", "flush", "silence")

# Records: shape.
SHAPE_MOTORS: Final = 0x0F
SHAPE_WIDTH_SHIFT: Final = 4
SHAPE_RESTS: Final = 0x40
SHAPE_RARE: Final = 0x80
# Records: law.
LAW_PIECES: Final = 0x0F
LAW_ACCEL: Final = 0x10
LAW_JUMP: Final = 0x20
LAW_OVERRIDE: Final = 0x40
# Records: rare.
RARE_WATCH: Final = 0x01
RARE_OUTPUTS: Final = 0x02
RARE_ACCEL: Final = 0x04
RARE_JUMP: Final = 0x08
RARE_TOP: Final = 0x10
RARE_SHARE: Final = 0x20
RARE_ENERGY: Final = 0x40
# Records: the head of a piece.
PIECE_TICKS: Final = 0x03
PIECE_INTERVAL_SHIFT: Final = 2
PIECE_ADD_SHIFT: Final = 5
PIECE_RAMP: Final = 0x80
DRY_NONE: Final = 0xFF

WATCH_IGNORE: Final = 0
WATCH_STOP: Final = 1
WATCH_BRAKE: Final = 2

WATCH_ACTIONS: Final = {
    WatchAction.IGNORE: WATCH_IGNORE,
    WatchAction.STOP: WATCH_STOP,
    WatchAction.BRAKE: WATCH_BRAKE,
}

# Cards.
CARD_LENGTH: Final = 45
CARD_PHASES: Final = 0
CARD_CLOCKS: Final = 1
TABLE_MIN: Final = 2
TABLE_MAX: Final = 32
MOTORS_MAX: Final = 4
TABLE_DRIVE: Final = 0
TABLE_HOLD: Final = 1

# Power of a lamp.
POWER_FULL: Final = 255
POWER_RATE: Final = 0x07
POWER_HIGH: Final = 0x80

MOST_TICKS: Final = (1 << 21) - 1
MOST_PIECES: Final = 255


def ended_of(number: int) -> Ended:
    """The reason behind its number on the line; a number that there is not says nothing."""
    return Ended(ENDED_NAMES[number]) if number < len(ENDED_NAMES) else Ended.NOT
