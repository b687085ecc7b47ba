"""The travel of an axis, from one end switch to the other: a reference run that goes on."""

from dataclasses import dataclass
from decimal import ROUND_FLOOR, Decimal
from typing import Any, Final

from fraese.control.calibration.moves import AxisMoves
from fraese.control.calibration.proposal import Change, Proposal, proposal
from fraese.control.controller import Controller
from fraese.control.homing import Homing
from fraese.control.jobs import Job
from fraese.phrases import phrase

#: How far the other end may be, in configured travels: the travel is what is not known.
_SEARCH_FACTOR: Final = 2.0
_HUNDREDTH: Final = Decimal("0.01")


@dataclass(frozen=True, slots=True)
class Travel:
    """What was found; ways in mm, or in degrees on a rotary axis.

    Attributes:
        axis: its name.
        measured_mm: from contact to contact.
        configured_mm: what is in force.
    """

    axis: str
    measured_mm: float
    configured_mm: float

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {"measured_mm": round(self.measured_mm, 6), "configured_mm": self.configured_mm}


class TravelTest:
    """Measures one axis, which is referenced by that.

    Args:
        controller: of the machine.
        axis: name.

    Attributes:
        result: what was found; None: nothing yet.
    """

    def __init__(self, controller: Controller, axis: str) -> None:
        self._controller = controller
        self._moves = AxisMoves(controller, axis)
        self.result: Travel | None = None

    def start(self) -> None:
        """Take it up; the controller's ``run`` does it.

        Raises:
            LimitError: if the axis has no end switches.
            StateError: if the machine is not ready.
        """
        self._moves.require_switches()
        name = self._moves.axis.name.upper()
        self._controller.start(phrase("measure the travel of {name}", name=name), self._job())

    def _job(self) -> Job:
        controller, axis = self._controller, self._moves.axis
        config, position = controller.config.homing, controller.position
        factor = max(config.search_factor, _SEARCH_FACTOR)
        config = config.model_copy(update={"search_factor": factor})
        homing = Homing(
            config, position, controller.switches, controller.say, lambda: "", measure=True
        )
        yield from homing.job([axis.name])
        self.result = Travel(axis.name, homing.measured_mm[axis.name], axis.travel_mm)

    def proposal(self) -> Proposal | None:
        """What the configuration should say of it; None: nothing was found."""
        found, axis = self.result, self._moves.axis
        if found is None:
            return None
        travel = Decimal(str(found.measured_mm)).quantize(_HUNDREDTH, ROUND_FLOOR).normalize()
        old = self._controller.config.axes.table[found.axis].travel
        key = f"axes.{found.axis}.{axis.travel_key}"
        why = phrase(
            "{axis}: from end to end {with_unit}; configured are {with_unit_2}.",
            axis=found.axis.upper(),
            with_unit=axis.with_unit(f"{found.measured_mm:.3f}"),
            with_unit_2=axis.with_unit(found.configured_mm),
        )
        return proposal(why, Change(key, old or Decimal(0), travel))
