"""Commands that want an answer: one at a time, in three words and a number.

    parent   kind, a, b -> number            waits            reads result, text
    child                  sees number       does it -> text, result, number

Rule 1: the number is written last, on both sides.
Rule 2: what needs standstill is refused while steps are made. What comes while the motors are just
        coming to rest waits until they stand.
"""

from typing import Final

from fraese.motor.realtime.memory import COMMAND, COMMAND_A, COMMAND_B, COMMAND_KIND
from fraese.motor.seams import IdleLevel, SwitchMode
from fraese.phrases import phrase

RESUME: Final = 1
OUTPUTS: Final = 2
SWITCH_MODE: Final = 3
FLUSH: Final = 4
IDLE: Final = 5
CLOSE: Final = 6

#: Commands for standstill, and what is said where it is not.
AT_STANDSTILL: Final = {
    FLUSH: phrase("the queue can only be dropped"),
    IDLE: phrase("the motors can only be switched off"),
}

DONE: Final = 0
#: The text says why not.
REFUSED: Final = 1

IDLE_LEVELS: Final = tuple(IdleLevel)
SWITCH_MODES: Final = tuple(SwitchMode)

_WORD: Final = (1 << 64) - 1


def post(words: memoryview, number: int, kind: int, a: int = 0, b: int = 0) -> None:
    """Put a command into the mailbox; the one before must have been answered."""
    words[COMMAND_KIND] = kind
    words[COMMAND_A] = a & _WORD
    words[COMMAND_B] = b & _WORD
    words[COMMAND] = number
