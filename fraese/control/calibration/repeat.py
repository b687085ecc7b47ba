"""How well a switch repeats: approached again and again, as in a reference run.

    |<- switch
    |   <====  first contact, as ever
    |  ====>   off it, and clear of it
    |   <====  slowly: contact 1
    |  ====>   ...        contact n

Rule 1: each approach is the slow one of a reference run, from beyond the backlash.
Rule 2: the figures are of the machine as it moves: switch, coupling, spindle and steps together.
"""

from dataclasses import dataclass
from typing import Any, Final

from fraese.anythread import any_thread
from fraese.control.calibration.figures import Figures
from fraese.control.calibration.moves import AxisMoves
from fraese.control.controller import Controller
from fraese.control.jobs import Doing, Job
from fraese.errors import LimitError
from fraese.phrases import phrase

#: How many approaches one can wait for.
APPROACHES: Final = (2, 1000)
_CLEAR_MM: Final = 1.0


@dataclass(frozen=True, slots=True)
class Repeatability:
    """What was found so far.

    Attributes:
        end: name of the switch.
        approaches: wanted.
        figures: where it closed, from the first contact on, mm or degrees in axis direction.
        step_mm: what one step is.
        unit: of all that.
    """

    end: str
    approaches: int
    figures: Figures
    step_mm: float
    unit: str

    @property
    def made(self) -> int:
        """Approaches so far."""
        return len(self.figures.readings)

    def words(self) -> str:
        """The figures, a sentence."""
        found, unit = self.figures, self.unit
        return phrase(
            "{end} closed {made} times within {spread:.4f} {unit}, standard deviation"
            " {deviation:.4f} {unit}; one step is {step_mm:.4f} {unit}.",
            end=self.end,
            made=self.made,
            spread=found.spread,
            unit=unit,
            deviation=found.deviation,
            step_mm=self.step_mm,
        )

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {"end": self.end, "step_mm": self.step_mm, **self.figures.as_dict()}


class RepeatTest:
    """Approaches one switch again and again.

    Args:
        controller: of the machine.
        axis: name.
        sign: which end, -1 or +1; None: that to which the axis is referenced.
        approaches: how often, within ``APPROACHES``.

    Raises:
        LimitError: if the number is outside.
    """

    def __init__(
        self, controller: Controller, axis: str, sign: int | None = None, approaches: int = 10
    ) -> None:
        self._controller = controller
        self._moves = AxisMoves(controller, axis)
        self._sign = self._moves.axis.home_sign if sign is None else sign
        low, high = APPROACHES
        if not low <= approaches <= high:
            raise LimitError(
                phrase(
                    "A switch is approached {low} to {high} times, not {approaches}.",
                    low=low,
                    high=high,
                    approaches=approaches,
                )
            )
        self._approaches = approaches
        self._readings_mm: tuple[float, ...] = ()

    @any_thread
    def facts(self) -> Repeatability:
        """What was found so far."""
        axis = self._moves.axis
        return Repeatability(
            self._moves.end_name(self._sign),
            self._approaches,
            Figures(self._readings_mm),
            axis.step_mm,
            axis.unit,
        )

    def start(self) -> None:
        """Take it up; the controller's ``run`` does it.

        Raises:
            LimitError: if the axis has no end switches.
            StateError: if the machine is not ready.
        """
        self._moves.require_switches()
        self._readings_mm = ()
        name = self._moves.end_name(self._sign)
        self._controller.start(phrase("repeatability of {name}", name=name), self._job())

    def _job(self) -> Job:
        moves, sign, homing = self._moves, self._sign, self._controller.config.homing
        axis = moves.axis
        clear_mm = _CLEAR_MM + axis.to_mm(axis.backlash_steps)
        first = yield from moves.find(sign)
        for number in range(1, self._approaches + 1):
            yield Doing(
                phrase(
                    "approach {number} of {approaches}", number=number, approaches=self._approaches
                )
            )
            yield from moves.off_contact(sign)
            yield from moves.go(-sign * axis.to_steps(clear_mm), homing.approach_mm_min)
            longest_mm = clear_mm + 2 * homing.back_off_max_mm
            contact = yield from moves.to_contact(sign, longest_mm, homing.slow_mm_min)
            self._readings_mm = (*self._readings_mm, axis.to_mm(contact - first))
        yield from moves.leave(sign)
        self._controller.say(self.facts().words())
