"""Commands about where the work lies: go to its zero, choose and change work offsets.

Rule 1: the way to the zero is one for a tool that stands anywhere: up first, then over, then down.
"""

from collections.abc import Mapping
from typing import Final

from fraese.control import lines
from fraese.control.controller import Controller
from fraese.control.softlimits import to_steps
from fraese.errors import StateError, UsageError
from fraese.log import logged
from fraese.machine import Millimetres
from fraese.phrases import phrase
from fraese.workframe import ACTIVE_SYSTEM, ROTATION, SYSTEMS, first_of_system, numbers

#: So far the tool is lifted above work zero and present height where nobody knows the travel, mm.
_LIFT_MM: Final = 5.0


@logged
def go_to_zero(controller: Controller) -> None:
    """Lift, over, down to the work zero; ``run`` does it.

    Raises:
        LimitError: if the zero, or the way to it, is outside the travel; nothing has moved then.
        StateError: if the machine is not ready.
    """
    points = way_to_zero(controller)
    targets = [to_steps(controller.machine, point) for point in points]
    controller.check_moves(targets)
    controller.start(phrase("go to work zero"), lines.curve(controller.position, targets, None))


def way_to_zero(controller: Controller) -> list[Millimetres]:
    """Its points, machine coordinates."""
    position, vertical = controller.position, controller.machine.vertical
    here = controller.machine.to_mm(position.position_steps)
    zero = position.frame.origin
    if vertical is None:
        return [zero]
    height_mm = max(here[vertical], zero[vertical], _safe_mm(controller, vertical))
    up, over = list(here), list(zero)
    up[vertical] = over[vertical] = height_mm
    return [tuple(up), tuple(over), zero]


def _safe_mm(controller: Controller, vertical: int) -> float:
    configured = controller.config.run.safe_z_mm
    axis = controller.machine.axes[vertical]
    if configured is not None:
        return configured
    if controller.position.referenced[vertical] and not axis.is_endless:
        return axis.high_mm
    here = controller.machine.to_mm(controller.position.position_steps)[vertical]
    return max(here, controller.position.frame.origin[vertical]) + _LIFT_MM


def _number(controller: Controller, name: str) -> int:
    """Of a system; at standstill.

    Raises:
        UsageError: if there is none of this name.
        StateError: while the machine runs.
    """
    if name not in SYSTEMS:
        raise UsageError(
            phrase(
                "There is no work offset {name}: there are {systems}.",
                name=name,
                systems=", ".join(SYSTEMS),
            )
        )
    if controller.question or controller.holding:
        raise StateError(
            phrase("A program waits: its work offset stays as it is; nothing was changed.")
        )
    controller.require_ready()
    return SYSTEMS.index(name) + 1


@logged
def select_system(controller: Controller, name: str) -> None:
    """Put a work offset into force: "G54" to "G59.3".

    Raises:
        UsageError: if there is none of this name.
        StateError: if the machine is not ready.
    """
    number, offsets = _number(controller, name), controller.position.offsets
    offsets.replace({**offsets.parameters, ACTIVE_SYSTEM: float(number)})


@logged
def store_system(controller: Controller, name: str, values_mm: Mapping[str, float]) -> None:
    """Let a work offset be this, machine coordinates of its zero by axis; none: cleared.

    Raises:
        UsageError: if there is none of this name.
        StateError: if the machine is not ready.
    """
    number, offsets = _number(controller, name), controller.position.offsets
    names = controller.machine.names
    places = dict(zip(names, numbers(first_of_system(number), "".join(names)), strict=True))
    if values_mm:
        changes = {places[axis]: value for axis, value in values_mm.items()}
    else:
        changes = dict.fromkeys([*places.values(), first_of_system(number) + ROTATION], 0.0)
    offsets.replace({**offsets.parameters, **changes})


def systems(controller: Controller) -> list[tuple[str, tuple[float, ...]]]:
    """Every work offset with its values in the order of the axes."""
    kept, axes = controller.position.offsets.parameters, "".join(controller.machine.names)
    return [
        (name, tuple(kept.get(n, 0.0) for n in numbers(first_of_system(number), axes)))
        for number, name in enumerate(SYSTEMS, start=1)
    ]
