"""What the tool of a simulated mill touches, as the status register shows it.

    carriages --what lies on the table--> touches --input--> reading

Rule 1: a probe that shares the end switches' input closes that, whatever they do; one with an
        input of its own is the only one there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

#: Whether the tool touches something where the carriages are, half-steps of their motors.
Touches = Callable[[Sequence[float]], bool]


@dataclass(frozen=True, slots=True)
class Feeler:
    """A probe on an input.

    Attributes:
        touches: see there.
        mask: bit of the input.
        touching: its value with contact.
        is_shared: other contacts are on it, too.
    """

    touches: Touches
    mask: int
    touching: int
    is_shared: bool

    def felt(self, reading: int, carriages_steps: Sequence[float]) -> int:
        """A reading of the inputs, with what is touched there."""
        if self.touches(carriages_steps):
            return reading & ~self.mask | self.touching
        if self.is_shared:
            return reading
        return reading & ~self.mask | (self.touching ^ self.mask)
