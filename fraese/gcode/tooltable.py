"""The tool table as programs have changed it: G10 L1, L10 and L11 outlive them.

    20000 + 20 x tool   offsets of nine axes | diameter | length, diameter of the configuration

Rule 1: what a program has set counts until the configuration says something else of that tool.
"""

from collections.abc import Mapping
from typing import Final

from fraese.gcode.setup import ToolData
from fraese.workframe import LETTERS, TOOLS, stored

#: A record of the machine's state has room for so many tools that programs have changed.
MOST_CHANGED: Final = 40

_STRIDE: Final = 20
_DIAMETER: Final = 9
_SET: Final = 12
_CONFIGURED: Final = 10
_CONFIGURED_DIAMETER: Final = 11


def as_parameters(number: int, tool: ToolData, configured: ToolData) -> dict[int, float]:
    """A tool as it is kept; lengths in mm.

    Args:
        number: of the tool.
        tool: as a program has set it.
        configured: as the configuration has it.
    """
    first = TOOLS + _STRIDE * number
    offsets = dict(enumerate(tool.offset(LETTERS), first))
    return {
        **offsets,
        first + _SET: 1.0,
        first + _DIAMETER: tool.diameter_mm,
        first + _CONFIGURED: configured.length_mm,
        first + _CONFIGURED_DIAMETER: configured.diameter_mm,
    }


def changed_tools(
    kept: Mapping[int, float], configured: Mapping[int, ToolData]
) -> dict[int, ToolData]:
    """Tools that programs have changed since the configuration said something of them.

    Args:
        kept: parameters, by number.
        configured: the tool table of the configuration.
    """
    found = {}
    for first in (n - _SET for n in kept if n >= TOOLS and n % _STRIDE == _SET):
        number = (first - TOOLS) // _STRIDE
        was = (kept.get(first + _CONFIGURED, 0.0), kept.get(first + _CONFIGURED_DIAMETER, 0.0))
        now = configured.get(number, ToolData())
        if was == (now.length_mm, now.diameter_mm):
            offsets = dict(zip(LETTERS, stored(kept, first, LETTERS), strict=True))
            length_mm = offsets.pop("z")
            found[number] = ToolData(length_mm, kept.get(first + _DIAMETER, 0.0), offsets)
    return found
