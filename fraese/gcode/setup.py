"""What a program finds when it starts, and what is left when it ends."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fraese.gcode.canon import PathMode, Plane, Point


@dataclass(frozen=True, slots=True)
class ToolData:
    """A line of the tool table, in mm."""

    length_mm: float = 0.0
    diameter_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class Setup:
    """What the interpreter is told before the first line.

    Args:
        position_mm: start position in machine coordinates.
        parameters: persistent numbered parameters as of LinuxCNC (5161.. and 5181.. for G28
            and G30, 5210 and 5211.. for G92, 5220 for the active system, 5221.. for G54 to
            G59.3), lengths in mm.
        tools: tool table by tool number. None: there is no table, every tool is allowed and
            has length 0. An empty table, on the other hand, knows no tool.
        tool: number of the tool in the spindle, 0 for none.
        inches: start in G20 instead of G21.
        block_delete: whether lines that start with ``/`` are left out.
        file: name of the program for messages.
        folders: where ``o<name> call`` looks for ``name.ngc``.
        max_idle_lines: how many lines a loop or subroutine may do without any motion before
            the program counts as one that never ends.
    """

    position_mm: Point = (0.0, 0.0, 0.0)
    parameters: Mapping[int, float] = field(default_factory=dict)
    tools: Mapping[int, ToolData] | None = None
    tool: int = 0
    inches: bool = False
    block_delete: bool = False
    file: str = ""
    folders: tuple[Path, ...] = ()
    max_idle_lines: int = 300_000


@dataclass(frozen=True, slots=True)
class ModalState:
    """What is in force between two lines: enough to show, or to start in the middle.

    Positions and offsets are in mm, ``feed_mm_min`` is 0 where no feed has been given,
    ``motion`` is the modal motion code as a word (``G1``) or empty after G80.
    """

    line: int
    motion: str
    plane: Plane
    inches: bool
    absolute: bool
    arc_absolute: bool
    inverse_time: bool
    feed_mm_min: float
    spindle: int
    rev_min: float
    mist: bool
    flood: bool
    tool: int
    selected_tool: int
    tool_offset_mm: Point
    work_offset: int
    work_offset_mm: Point
    rotation_deg: float
    g92_offset_mm: Point
    retract_to_start: bool
    path_mode: PathMode
    tolerance_mm: float
    overrides: bool
    position_mm: Point
