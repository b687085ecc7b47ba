"""Parameters that answer: position, modes, tool and the like, by number or by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from fraese.gcode.canon import PathMode
from fraese.gcode.messages import DEBUG_SWITCH
from fraese.gcode.parameters import Live

if TYPE_CHECKING:
    from fraese.gcode.interpreter import Interpreter

POSITION: Final = 5420
TOOL_NUMBER: Final = 5400
# Of the tool in the spindle, in mm whatever the unit of the program.
TOOL_LENGTH: Final = 5403
TOOL_DIAMETER: Final = 5410
# The language is that of LinuxCNC 2.9.
VERSION: Final = (2.9, 0.0)
_SYSTEMS: Final = (540, 550, 560, 570, 580, 590, 591, 592, 593)
_PATHS: Final = {PathMode.EXACT_PATH: 610, PathMode.EXACT_STOP: 611, PathMode.BLEND: 640}


def install(interpreter: Interpreter) -> None:
    """Connect the answering parameters to an interpreter."""
    parameters = interpreter.parameters
    parameters.numbered.setdefault(DEBUG_SWITCH, 1.0)
    parameters.live.update(_numbered(interpreter))
    parameters.live_names.update(_modes(interpreter))
    parameters.live_names.update(_places(interpreter))
    parameters.live_names.update(_constants())


def _program_position(interpreter: Interpreter, axis: int) -> Live:
    motion, modal = interpreter._motion, interpreter._modal
    return lambda: motion.at[axis] / modal.scale_mm


def _machine_position(interpreter: Interpreter, axis: int) -> Live:
    return lambda: interpreter.position_mm[axis] / interpreter._modal.scale_mm


def _constant(value: float) -> Live:
    return lambda: value


def _numbered(interpreter: Interpreter) -> dict[int, Live]:
    modal = interpreter._modal
    return {
        TOOL_NUMBER: lambda: float(modal.tool),
        TOOL_LENGTH: lambda: interpreter._settings.tool_data(modal.tool).length_mm,
        TOOL_DIAMETER: lambda: interpreter._settings.tool_data(modal.tool).diameter_mm,
        **{POSITION + axis: _program_position(interpreter, axis) for axis in range(3)},
    }


def _places(interpreter: Interpreter) -> dict[str, Live]:
    modal = interpreter._modal
    answers: dict[str, Live] = {
        "_line": lambda: float(interpreter._flow.source.line),
        "_call_level": lambda: float(interpreter._flow.call_level),
        "_value": lambda: interpreter._flow.value,
        "_value_returned": lambda: interpreter._flow.value_returned,
        "_feed": lambda: modal.feed_word,
        "_rpm": lambda: modal.rev_min,
        "_current_tool": lambda: float(modal.tool),
        "_selected_tool": lambda: float(modal.selected_tool),
        "_current_pocket": lambda: float(modal.tool),
        "_selected_pocket": lambda: float(modal.selected_tool),
    }
    for axis, letter in enumerate("xyz"):
        answers[f"_{letter}"] = _program_position(interpreter, axis)
        answers[f"_abs_{letter}"] = _machine_position(interpreter, axis)
    return answers


def _modes(interpreter: Interpreter) -> dict[str, Live]:
    modal, coordinates = interpreter._modal, interpreter._coordinates
    return {
        "_motion_mode": lambda: float(800 if modal.motion is None else modal.motion),
        "_plane": lambda: modal.plane * 10.0,
        "_metric": lambda: float(modal.scale_mm == 1.0),
        "_imperial": lambda: float(modal.scale_mm != 1.0),
        "_absolute": lambda: float(modal.absolute),
        "_incremental": lambda: float(not modal.absolute),
        "_inverse_time": lambda: float(modal.inverse_time),
        "_units_per_minute": lambda: float(not modal.inverse_time),
        "_coord_system": lambda: float(_SYSTEMS[coordinates.system - 1]),
        "_tool_offset": lambda: float(any(coordinates.tool)),
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
        "_ccomp": 400.0,
        "_units_per_rev": 0.0,
        "_spindle_rpm_mode": 1.0,
        "_spindle_css_mode": 0.0,
        "_lathe_diameter_mode": 0.0,
        "_lathe_radius_mode": 1.0,
        "_adaptive_feed": 0.0,
        "_feed_hold": 1.0,
        "_remap_level": 0.0,
        "_task": 0.0,
        **{f"_{letter}": 0.0 for letter in "abcuvw"},
    }
    return {name: _constant(value) for name, value in constants.items()}
