"""What is in force between two lines, as a frozen fact."""

from dataclasses import dataclass

from fraese.gcode.canon import PathMode, Plane
from fraese.gcode.modal import name
from fraese.gcode.position import Position
from fraese.workframe import Point


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


def state_of(position: Position, line: int) -> ModalState:
    """The state at a position, in front of or behind a line."""
    m, c = position.modal, position.coordinates.frame
    return ModalState(
        line=line,
        motion="" if m.motion is None else name(m.motion),
        plane=m.plane,
        inches=m.scale_mm != 1.0,
        absolute=m.absolute,
        arc_absolute=m.arc_absolute,
        inverse_time=m.inverse_time,
        feed_mm_min=m.feed_mm_min,
        spindle=m.spindle,
        rev_min=m.rev_min,
        mist=m.mist,
        flood=m.flood,
        tool=m.tool,
        selected_tool=m.selected_tool,
        tool_offset_mm=c.tool,
        work_offset=c.system,
        work_offset_mm=c.offset,
        rotation_deg=c.rotation_deg,
        g92_offset_mm=c.g92,
        retract_to_start=m.retract_to_start,
        path_mode=m.path_mode,
        tolerance_mm=m.tolerance_mm,
        overrides=m.overrides,
        position_mm=position.machine,
    )
