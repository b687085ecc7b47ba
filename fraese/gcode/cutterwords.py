"""The words of cutter compensation, and what must not stand beside them.

What LinuxCNC refuses under compensation is refused here, and what would change the path's frame
in the middle of it.
"""

from collections.abc import Mapping
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.cutter import ORIENTATIONS, Side
from fraese.gcode.expressions import whole
from fraese.gcode.frames import Frames
from fraese.gcode.modal import CUTTER_ON, CYCLES, M_OFFSET, Modal, name
from fraese.gcode.words import Block
from fraese.phrases import phrase

#: With the diameter in the D word itself.
_DYNAMIC: Final = frozenset({411, 421})
_LEFT: Final = frozenset({410, 411})
_PROBES: Final = frozenset({382, 383, 384, 385})
#: G10 that moves the system in force.
_SYSTEMS: Final = (2, 20)
_PLACES: Final = frozenset({280, 281, 300, 301, 520, 530, 920, 921, 922, 923})
_GROUPS: Final[Mapping[str, str]] = {
    "length": phrase("changes the tool's length"),
    "system": phrase("changes the coordinate system"),
    "path": phrase("changes how corners are treated"),
    "tool_change": phrase("changes the tool"),
    "override": phrase("switches overrides"),
}


def side_of(code: int, block: Block, frames: Frames, modal: Modal) -> Side:
    """What G41, G41.1, G42 or G42.1 asks for.

    Raises:
        ProgramError: a word is missing or wrong, or the tool's diameter is not known.
    """
    word = block.words.get("d")
    shift: tuple[float, float] = (0, 0)
    if code in _DYNAMIC:
        if word is None:
            raise ProgramError(
                phrase("{name} needs a D word: the cutter's diameter", name=name(code))
            )
        diameter_mm = word * modal.scale_mm
        shift = _orientation(code, block, modal)
    else:
        number = 0 if word is None else whole(word, phrase("the D word of {name}", name=name(code)))
        diameter_mm = frames.diameter_mm(number or modal.tool, name(code))
    distance_mm = diameter_mm / 2 if code in _LEFT else -diameter_mm / 2
    return Side(code, distance_mm, shift)


def _orientation(code: int, block: Block, modal: Modal) -> tuple[float, float]:
    word = block.words.get("l")
    if word is None:
        return 0, 0
    number = whole(word, phrase("the L word of {name}", name=name(code)))
    if modal.plane != 18:
        raise ProgramError(phrase("the L word of {name} is for the plane G18", name=name(code)))
    if not 0 <= number < len(ORIENTATIONS):
        raise ProgramError(
            phrase("the L word of {name} is an orientation from 0 to 9", name=name(code))
        )
    return ORIENTATIONS[number]


def check(block: Block, modal: Modal, system: int) -> None:
    """See that nothing on a line forbids compensation.

    Args:
        block: the line; compensation is on, or is switched on by it.
        modal: what is in force before it.
        system: the work system in force.

    Raises:
        ProgramError: naming it.
    """
    if block.motion in CYCLES or block.motion in _PROBES:
        raise _not_possible(block.motion)
    codes = block.codes
    nonmodal = codes.get("nonmodal")
    if nonmodal in _PLACES:
        raise _not_possible(nonmodal)
    is_of_system = nonmodal == 100 and block.words.get("l") in _SYSTEMS
    if is_of_system and block.words.get("p") in (0, system):
        raise ProgramError(phrase("G10 changes the coordinate system in force{end}", end=_END))
    now = modal.plane * 10
    if codes.get("cutter") not in CUTTER_ON and codes.get("plane", now) != now:
        raise ProgramError(phrase("the plane cannot be changed{end}", end=_END))
    for group, said in _GROUPS.items():
        code = codes.get(group)
        if code is not None:
            shown = name(code) if code < M_OFFSET else f"M{code - M_OFFSET}"
            raise ProgramError(
                phrase(
                    "{shown} {said}, which is not possible{end}", shown=shown, said=said, end=_END
                )
            )


_END: Final = phrase(" while cutter compensation is on; end it with G40 before")


def _not_possible(code: int | None) -> ProgramError:
    return ProgramError(phrase("{name} is not possible{end}", name=name(code or 0), end=_END))
