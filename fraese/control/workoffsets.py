"""Work offsets, as the language numbers them, so that panel and program share one set.

    machine = work + offset of the active system + G92, where that is on

Parameters (RS-274/NGC): 5220 active system, 5221.. 5241.. ... 5381.. offsets of G54 to G59.3,
5210 G92 on, 5211.. its offset, 5161.. and 5181.. the positions of G28 and G30. Lengths in mm.
"""

from collections.abc import Mapping
from typing import Final

ACTIVE_SYSTEM: Final = 5220
FIRST_SYSTEM: Final = 5221
SYSTEM_STRIDE: Final = 20
G92_ON: Final = 5210
G92_FIRST: Final = 5211


class WorkOffsets:
    """The persistent parameters of the language, and what they mean for the position.

    Attributes:
        parameters: by number; a program that ends leaves new ones.
    """

    def __init__(self, axes: int) -> None:
        self._axes = axes
        self.parameters: dict[int, float] = {}

    def replace(self, parameters: Mapping[int, float]) -> None:
        """Take up what a program left, or what was kept."""
        self.parameters = dict(parameters)

    @property
    def system(self) -> int:
        """1 for G54 to 9 for G59.3."""
        return int(self.parameters.get(ACTIVE_SYSTEM, 1))

    def _system_key(self, index: int) -> int:
        return FIRST_SYSTEM + SYSTEM_STRIDE * (self.system - 1) + index

    def _g92_mm(self, index: int) -> float:
        if not self.parameters.get(G92_ON):
            return 0.0
        return self.parameters.get(G92_FIRST + index, 0.0)

    def offset_mm(self) -> tuple[float, ...]:
        """Where the work zero lies, in machine coordinates."""
        return tuple(
            self.parameters.get(self._system_key(index), 0.0) + self._g92_mm(index)
            for index in range(self._axes)
        )

    def set_zero(self, index: int, machine_mm: float, work_mm: float) -> None:
        """Let a machine position have this work coordinate, in the active system."""
        self.parameters[self._system_key(index)] = machine_mm - work_mm - self._g92_mm(index)
