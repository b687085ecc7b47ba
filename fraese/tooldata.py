"""What is known of tools, and the table as programs have changed it: G10 L1, L10, L11 outlive them.

    20000 + 20 x tool   offsets of nine axes | diameter | length, diameter of the configuration

Rule 1: what a program has set counts until the configuration says something else of that tool, or
        somebody changes it in the tool table.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from fraese.workframe import LETTERS, TOOLS, Point, stored

#: A record of the machine's state has room for so many tools that programs have changed.
MOST_CHANGED: Final = 40

_STRIDE: Final = 20
_DIAMETER: Final = 9
_SET: Final = 12
_CONFIGURED: Final = 10
_CONFIGURED_DIAMETER: Final = 11


@dataclass(frozen=True, slots=True)
class ToolData:
    """A line of the tool table, in mm."""

    length_mm: float = 0.0
    diameter_mm: float = 0.0
    # offsets along other axes than Z, by letter
    others: Mapping[str, float] = field(default_factory=dict)

    def offset(self, axes: str) -> Point:
        """What G43 applies to these axes."""
        offsets = {**self.others, "z": self.length_mm}
        return tuple(offsets.get(letter, 0.0) for letter in axes)


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
    for number in ((n - TOOLS) // _STRIDE for n in kept if n >= TOOLS and n % _STRIDE == _SET):
        tool = changed_tool(number, kept, configured.get(number, ToolData()))
        if tool is not None:
            found[number] = tool
    return found


def changed_tool(number: int, kept: Mapping[int, float], configured: ToolData) -> ToolData | None:
    """One tool as a program has changed it; None: the configuration counts."""
    first = TOOLS + _STRIDE * number
    was = (kept.get(first + _CONFIGURED, 0.0), kept.get(first + _CONFIGURED_DIAMETER, 0.0))
    if first + _SET not in kept or was != (configured.length_mm, configured.diameter_mm):
        return None
    offsets = dict(zip(LETTERS, stored(kept, first, LETTERS), strict=True))
    length_mm = offsets.pop("z")
    return ToolData(length_mm, kept.get(first + _DIAMETER, 0.0), offsets)


def without_tool(number: int, kept: Mapping[int, float]) -> dict[int, float]:
    """Parameters without what a program has set of a tool."""
    first = TOOLS + _STRIDE * number
    return {n: value for n, value in kept.items() if not first <= n < first + _STRIDE}
