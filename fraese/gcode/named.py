"""Parameters that answer: position, modes, tool and the like, by number or by name."""

from collections.abc import Callable
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.canon import PathMode
from fraese.gcode.cutter import Cutter
from fraese.gcode.frames import Frames
from fraese.gcode.messages import DEBUG_SWITCH
from fraese.gcode.oword import Flow
from fraese.gcode.parameters import Live, Parameters
from fraese.gcode.position import Position
from fraese.phrases import phrase
from fraese.workframe import LETTERS, TOOL_NUMBER, TOOL_OFFSET, numbers

POSITION: Final = 5420
TOOL_DIAMETER: Final = 5410
# The language is that of LinuxCNC 2.9.
VERSION: Final = (2.9, 0.0)
_SYSTEMS: Final = (540, 550, 560, 570, 580, 590, 591, 592, 593)
_PATHS: Final = {PathMode.EXACT_PATH: 610, PathMode.EXACT_STOP: 611, PathMode.BLEND: 640}


def install(
    parameters: Parameters,
    position: Position,
    frames: Frames,
    cutter: Cutter,
    flow: Callable[[], Flow],
) -> None:
    """Connect the answering parameters to what they tell of."""
    parameters.numbered.setdefault(DEBUG_SWITCH, 1.0)
    parameters.live.update(_numbered(position, frames))
    parameters.live.update(_place(position, cutter))
    parameters.live_names.update(_modes(position))
    parameters.live_names.update(_places(position))
    parameters.live_names.update(_control(flow))
    parameters.live_names.update(_constants())
    parameters.live_names["_ccomp"] = lambda: 400.0 if cutter.side is None else cutter.side.code


def _program_position(position: Position, axis: int) -> Live:
    return lambda: position.at[axis] / position.axes.scales[position.modal.scale_mm][axis]


def _machine_position(position: Position, axis: int) -> Live:
    return lambda: position.machine[axis] / position.axes.scales[position.modal.scale_mm][axis]


def _tool_offset(position: Position, frames: Frames, axis: int) -> Live:
    return lambda: frames.tool_data(position.modal.tool).offset(position.axes.letters)[axis]


def _place(position: Position, cutter: Cutter) -> dict[int, Live]:
    def answer(axis: int) -> Live:
        place = _program_position(position, axis)

        def at() -> float:
            if cutter.side is not None:
                raise ProgramError(
                    phrase("the position cannot be read under compensation (G41, G42)")
                )
            return place()

        return at

    letters = position.axes.letters
    return {numbers(POSITION, letter)[0]: answer(axis) for axis, letter in enumerate(letters)}


def _constant(value: float) -> Live:
    return lambda: value


def _numbered(position: Position, frames: Frames) -> dict[int, Live]:
    modal = position.modal
    # What the machine has not is asked for as well, and stands at nothing.
    answers = {
        number: _constant(0.0)
        for first in (TOOL_OFFSET, POSITION)
        for number in numbers(first, LETTERS)
    }
    for axis, letter in enumerate(position.axes.letters):
        answers[numbers(TOOL_OFFSET, letter)[0]] = _tool_offset(position, frames, axis)
    return answers | {
        TOOL_NUMBER: lambda: float(modal.tool),
        TOOL_DIAMETER: lambda: frames.tool_data(modal.tool).diameter_mm,
    }


def _control(flow: Callable[[], Flow]) -> dict[str, Live]:
    return {
        "_line": lambda: float(flow().source.line),
        "_call_level": lambda: float(flow().call_level),
        "_value": lambda: flow().value,
        "_value_returned": lambda: flow().value_returned,
    }


def _places(position: Position) -> dict[str, Live]:
    answers = {
        name: _constant(0.0) for letter in LETTERS for name in (f"_{letter}", f"_abs_{letter}")
    }
    for axis, letter in enumerate(position.axes.letters):
        answers[f"_{letter}"] = _program_position(position, axis)
        answers[f"_abs_{letter}"] = _machine_position(position, axis)
    return answers


def _modes(position: Position) -> dict[str, Live]:
    modal, coordinates = position.modal, position.coordinates
    return {
        "_feed": lambda: modal.feed_word,
        "_rpm": lambda: modal.rev_min,
        "_current_tool": lambda: float(modal.tool),
        "_selected_tool": lambda: float(modal.selected_tool),
        "_current_pocket": lambda: float(modal.tool),
        "_selected_pocket": lambda: float(modal.selected_tool),
        "_motion_mode": lambda: float(800 if modal.motion is None else modal.motion),
        "_plane": lambda: modal.plane * 10.0,
        "_metric": lambda: float(modal.scale_mm == 1.0),
        "_imperial": lambda: float(modal.scale_mm != 1.0),
        "_absolute": lambda: float(modal.absolute),
        "_incremental": lambda: float(not modal.absolute),
        "_inverse_time": lambda: float(modal.inverse_time),
        "_units_per_minute": lambda: float(not modal.inverse_time),
        "_coord_system": lambda: float(_SYSTEMS[coordinates.frame.system - 1]),
        "_tool_offset": lambda: float(any(coordinates.frame.tool)),
        "_retract_r_plane": lambda: float(not modal.retract_to_start),
        "_retract_old_z": lambda: float(modal.retract_to_start),
        "_ijk_absolute_mode": lambda: float(modal.arc_absolute),
        "_spindle_on": lambda: float(modal.spindle != 0),
        "_spindle_cw": lambda: float(modal.spindle > 0),
        "_mist": lambda: float(modal.mist),
        "_flood": lambda: float(modal.flood),
        "_speed_override": lambda: float(modal.overrides),
        "_feed_override": lambda: float(modal.overrides),
        "_path_mode": lambda: float(_PATHS[modal.path_mode]),
    }


def _constants() -> dict[str, Live]:
    constants = {
        "_vmajor": VERSION[0],
        "_vminor": VERSION[1],
        "_units_per_rev": 0.0,
        "_spindle_rpm_mode": 1.0,
        "_spindle_css_mode": 0.0,
        "_lathe_diameter_mode": 0.0,
        "_lathe_radius_mode": 1.0,
        "_adaptive_feed": 0.0,
        "_feed_hold": 1.0,
        "_remap_level": 0.0,
        "_task": 0.0,
    }
    return {name: _constant(value) for name, value in constants.items()}
