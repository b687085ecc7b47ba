"""The control register of a parallel port, as cards use it.

Rule 1: a card owns the shadow of the control register; nobody else writes it.
Rule 2: bits of the control register that a card does not use stay as they rest. 0xFF is never
        written: it would also set the interrupt and direction bits.
Rule 3: callers speak of pins and of on and off. What register and wiring invert is known here.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from fraese.motor.pins import CONTROL_PINS
from fraese.motor.seams import CONTROL, EVERY_MOTOR, STATUS, Entries, Entry

NOTHING: Final[Entries] = ()
READING: Final[Entries] = (Entry(STATUS, EVERY_MOTOR),)


class OutputPin(NamedTuple):
    """A free output.

    Attributes:
        pin: DB25 pin of the control register.
        active_high: its level means on.
        pulses_hz: pulses that set its power, where the port can make them; 0: it is on or off.
    """

    pin: int
    active_high: bool = True
    pulses_hz: float = 0.0


class ControlLines:
    """The shadow of the control register.

    Args:
        value: how the register rests; bits of ``outputs`` are changed to their off level.
        outputs: free outputs, in the order of the bits of ``set_outputs``.

    Attributes:
        value: the shadow.
        rest: how it rests, with all outputs off.
        outputs: as given.
    """

    def __init__(self, value: int, outputs: Sequence[OutputPin]) -> None:
        self.value = value
        self.outputs = tuple(outputs)
        self.set_outputs(~0, 0)
        self.rest = self.value

    def set_pin(self, pin: int, high: bool) -> None:
        """Change the shadow so that a pin is high or low."""
        bit, inverted = CONTROL_PINS[pin]
        self.value = self.value | bit if high != inverted else self.value & ~bit

    def set_outputs(self, mask: int, value: int) -> None:
        """Change the shadow of the free outputs in ``mask``."""
        for bit, output in enumerate(self.outputs):
            if mask >> bit & 1:
                self.set_pin(output.pin, bool(value >> bit & 1) == output.active_high)

    def entries(self) -> Entries:
        """Write the shadow."""
        return (Entry(CONTROL, self.value),)
