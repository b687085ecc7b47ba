"""The pin that sets the power of a lamp, as the simulated microcontroller has it."""

from typing import Final

from rigs.avr.simavr import Avr

#: Registers of timer 2, in the data space.
TCCR2A: Final = 0xB0
TCCR2B: Final = 0xB1
OCR2A: Final = 0xB3
_CONNECTED: Final = 0xC0


def share_of(avr: Avr) -> int:
    """How much of the time the pin is on now, 1/256; 0: the timer is off the pin, which rests."""
    return avr.peek(OCR2A)[0] + 1 if avr.peek(TCCR2A)[0] & _CONNECTED else 0
