"""What lies on the table of the simulated mill, and whether the tool touches it.

Rule 1: places are those of the machine, as a reference run at the true switches makes them;
        half-steps become millimetres in ``trueplaces``, for the onlooker as well.
Rule 2: a tool is a cylinder below the spindle: what reaches above its tip touches it.
"""

import math
from collections.abc import Sequence
from typing import Final

from fraese.assembly.trueaxis import true_axes
from fraese.assembly.trueplaces import true_way, true_zero
from fraese.config import Config
from fraese.config.solid import SimulatedSolid
from fraese.control.endswitches import contact_bits, probe_bits
from fraese.motor.feeler import Feeler

#: What is left of sums.
_NOTHING_MM: Final = 1e-6


def feeler_of(config: Config) -> Feeler | None:
    """The probe of the simulated mill; None: there is nothing to touch."""
    table = Table(config)
    if not table.blocks:
        return None
    mask, touching = probe_bits(config)
    shared = bool(contact_bits(config)[0] & mask)
    return Feeler(table.is_touched, mask, touching, shared)


class Table:
    """What lies on the table.

    Args:
        config: what lies where, the axes, and the tool.

    Attributes:
        blocks: what is solid.
        holes: what is cut out of it.
    """

    def __init__(self, config: Config) -> None:
        solids = config.simulation.solids.values()
        self.blocks = [solid for solid in solids if not solid.hole]
        self.holes = [solid for solid in solids if solid.hole]
        self._radius_mm = config.simulation.tool_diameter_mm / 2
        self._length_mm = config.simulation.tool_length_mm
        # Of each axis of the machine: its index, mm at half-step 0 and mm in one of them.
        self._axes: dict[str, tuple[int, float, float]] = {}
        tables = config.axes.table
        for index, axis in enumerate(true_axes(config)):
            zero = true_zero(axis, config, tables[axis.name])
            at_0, at_1 = (float(true_way(axis, steps) - zero) for steps in (0, 1))
            self._axes[axis.name] = index, at_0, at_1 - at_0

    def tip_mm(self, carriages_steps: Sequence[float]) -> tuple[float, float, float]:
        """Where the tip of the tool is; 0 along an axis that there is not."""
        x, y, z = (
            first + each * carriages_steps[index]
            for index, first, each in (self._axes.get(name, (0, 0.0, 0.0)) for name in "xyz")
        )
        return x, y, z - self._length_mm

    def is_touched(self, carriages_steps: Sequence[float]) -> bool:
        """Whether the tool touches something."""
        x, y, z = self.tip_mm(carriages_steps)
        if not any(self._reaches(block, x, y, z) for block in self.blocks):
            return False
        return not any(self._is_within(hole, x, y, z) for hole in self.holes)

    def _reaches(self, block: SimulatedSolid, x: float, y: float, z: float) -> bool:
        """The block reaches to the tip, within the radius of the tool."""
        nearest_x, nearest_y = _into(block.x_mm, x), _into(block.y_mm, y)
        if math.hypot(x - nearest_x, y - nearest_y) > self._radius_mm + _NOTHING_MM:
            return False
        return z <= _top(block, nearest_x, nearest_y)

    def _is_within(self, hole: SimulatedSolid, x: float, y: float, z: float) -> bool:
        """The tool is clear of the walls and of the ground of a hole."""
        radius = self._radius_mm
        (low_x, high_x), (low_y, high_y) = hole.x_mm, hole.y_mm
        is_clear = low_x + radius < x < high_x - radius and low_y + radius < y < high_y - radius
        return is_clear and z > hole.top_mm


def _into(span: tuple[float, float], at: float) -> float:
    return min(max(at, span[0]), span[1])


def _top(block: SimulatedSolid, x: float, y: float) -> float:
    """Height of its top."""
    (low_x, high_x), (low_y, high_y) = block.x_mm, block.y_mm
    a, b = (x - low_x) / (high_x - low_x), (y - low_y) / (high_y - low_y)
    one, two, three, four = block.corners_mm
    near, far = one + (two - one) * a, three + (four - three) * a
    return block.top_mm + near + (far - near) * b
