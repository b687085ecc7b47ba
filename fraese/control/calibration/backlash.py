"""Backlash: motor steps without effect after the axis turns round.

    by a switch                                    by a dial gauge
    |<- closes: A    creeping in                   forward, gauge to zero
    |   opens: B     creeping out again            forward by a way, back by the same way
    backlash = A - B - one stride                  the gauge shows what is missing

Rule 1: the steps are the motor's own: what is configured as backlash is not made up for meanwhile.
Rule 2: by a switch, what the switch itself needs between closing and opening is in the figure:
        it is the most that the backlash can be.
"""

from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Final

from fraese.anythread import any_thread
from fraese.control.calibration.figures import Figures
from fraese.control.calibration.moves import AxisMoves
from fraese.control.calibration.proposal import Change, Proposal, proposal
from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, Ask, Doing, Job
from fraese.control.softlimits import require_finite
from fraese.errors import LimitError
from fraese.phrases import phrase

#: How often it is measured by a switch.
TIMES: Final = (1, 100)
_BY: Final = {"switch": phrase("switch"), "gauge": phrase("gauge")}
_THOUSANDTH: Final = Decimal("0.001")
#: More than this is broken.
_MOST_MM: Final = 5.0
_GAUGE_WAY_MM: Final = 2.0


@dataclass(frozen=True, slots=True)
class Backlash:
    """What was found so far, mm or degrees.

    Attributes:
        axis: its name.
        by: "switch" or "gauge".
        figures: each time that it was measured.
        configured_mm: in force.
        fine_mm: what can be told apart.
    """

    axis: str
    by: str
    figures: Figures
    configured_mm: float
    fine_mm: float

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {"by": self.by, "configured_mm": self.configured_mm, **self.figures.as_dict()}


class BacklashTest:
    """Measures the backlash of one axis.

    Args:
        controller: of the machine.
        axis: name.
    """

    def __init__(self, controller: Controller, axis: str) -> None:
        self._controller = controller
        self._moves = AxisMoves(controller, axis)
        self._by = ""
        self._found_mm: tuple[float, ...] = ()

    @any_thread
    def facts(self) -> Backlash:
        """What was found so far."""
        axis = self._moves.axis
        fine = self._moves.stride_steps if self._by == "switch" else 1
        return Backlash(
            axis.name,
            self._by,
            Figures(self._found_mm),
            axis.to_mm(axis.backlash_steps),
            axis.to_mm(fine),
        )

    # --- by a switch ---------------------------------------------------------------------------

    def start_by_switch(self, times: int = 3) -> None:
        """Take it up at the switch to which the axis is referenced; ``run`` does it.

        Args:
            times: how often, within ``TIMES``.

        Raises:
            LimitError: if the axis has no end switches, or the number is outside.
            StateError: if the machine is not ready.
        """
        low, high = TIMES
        if not low <= times <= high:
            raise LimitError(
                phrase(
                    "Backlash is measured {low} to {high} times, not {times}.",
                    low=low,
                    high=high,
                    times=times,
                )
            )
        self._moves.require_switches()
        self._by, self._found_mm = "switch", ()
        name = self._moves.axis.name.upper()
        self._controller.start(phrase("backlash of {name}", name=name), self._by_switch(times))

    def _by_switch(self, times: int) -> Job:
        moves, axis = self._moves, self._moves.axis
        sign = axis.home_sign
        yield from moves.find(sign)
        yield from moves.off_contact(sign)
        for number in range(1, times + 1):
            yield Doing(
                phrase(
                    "{number} of {times}: creeping in until the switch closes",
                    number=number,
                    times=times,
                )
            )
            closed = yield from moves.creep(sign, closed=True, longest_mm=_MOST_MM)
            yield Doing(
                phrase(
                    "{number} of {times}: creeping out until it opens", number=number, times=times
                )
            )
            opened = yield from moves.creep(-sign, closed=False, longest_mm=_MOST_MM)
            play = abs(closed - opened) - moves.stride_steps
            self._found_mm = (*self._found_mm, axis.to_mm(max(0, play)))
        pull_off = axis.to_steps(self._controller.config.homing.pull_off_mm)
        yield from moves.go(-sign * pull_off, self._controller.config.homing.approach_mm_min)

    # --- by a dial gauge -----------------------------------------------------------------------

    def start_by_gauge(self, sign: int = 1, way_mm: float = _GAUGE_WAY_MM) -> None:
        """Forward, a question, forward and back again; then the gauge is read.

        Args:
            sign: which way forward is.
            way_mm: how far, without sign.

        Raises:
            LimitError: if there is no room for it.
            StateError: if the machine is not ready.
        """
        axis, where = self._moves.axis, self._controller.position
        require_finite(axis, way_mm)
        way = sign * axis.to_steps(abs(way_mm))
        if not way:
            raise LimitError(
                phrase(
                    "A way must be at least one step of {with_unit}.",
                    with_unit=axis.with_unit(axis.step_mm),
                )
            )
        target = list(where.position_steps)
        target[self._moves.motor] += 2 * way
        self._controller.check_moves([tuple(target)])
        self._by, self._found_mm = "gauge", ()
        self._controller.start(
            phrase("backlash of {name}", name=axis.name.upper()), self._by_gauge(way)
        )

    def _by_gauge(self, way: int) -> Job:
        moves, axis, feed = self._moves, self._moves.axis, self._controller.config.jog.feed_mm_min
        yield from moves.go(way, feed)
        yield Ask(
            phrase(
                "Set a dial gauge against {name}, and its scale to zero. Then it moves"
                " {with_unit} on and the same way back.",
                name=axis.name.upper(),
                with_unit=axis.with_unit(abs(axis.to_mm(way))),
            ),
            waits_for=phrase("gauge"),
        )
        yield from moves.go(way, feed)
        yield from moves.go(-way, feed)
        yield STANDSTILL

    def read(self, gauge_mm: float) -> None:
        """Take what the gauge shows.

        Raises:
            LimitError: if it is no way that backlash can be.
        """
        axis = self._moves.axis
        require_finite(axis, gauge_mm)
        if abs(gauge_mm) > _MOST_MM:
            raise LimitError(
                phrase(
                    "{with_unit} is more than backlash can be, {with_unit_2}: look at the"
                    " gauge and at the coupling.",
                    with_unit=axis.with_unit(abs(gauge_mm)),
                    with_unit_2=axis.with_unit(_MOST_MM),
                )
            )
        self._by = "gauge"
        self._found_mm = (*self._found_mm, abs(gauge_mm))

    def proposal(self) -> Proposal | None:
        """What the configuration should say of it; None: nothing was found."""
        found, axis = self.facts(), self._moves.axis
        if not found.figures.readings:
            return None
        config = self._controller.config.axes.table[found.axis]
        key = f"axes.{found.axis}.backlash_{config.key_unit}"
        mean = Decimal(str(found.figures.mean)).quantize(_THOUSANDTH).normalize()
        times = len(found.figures.readings)
        why = phrase(
            "{axis}: {with_unit} by {by}, {often}, spread {with_unit_2};"
            " configured are {with_unit_3}.",
            axis=found.axis.upper(),
            with_unit=axis.with_unit(f"{found.figures.mean:.4f}"),
            by=_BY[found.by],
            often=phrase("1 time") if times == 1 else phrase("{times} times", times=times),
            with_unit_2=axis.with_unit(f"{found.figures.spread:.4f}"),
            with_unit_3=axis.with_unit(found.configured_mm),
        )
        return proposal(why, Change(key, config.backlash, mean))
