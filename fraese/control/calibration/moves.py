"""Moves of one axis for measuring: so many steps of its motor, to a contact and off it.

    creep:   step, wait, look | step, wait, look | ...     what bounces or lags has come to rest

Rule 1: a count here is of motor steps in the direction of the axis, since the driver was opened.
        Backlash is not made up for; the position takes it out all the same.
Rule 2: every way is bounded. A switch that is not found, or does not open, is an error.
Rule 3: what creeps finds an edge to the stride, whatever the switch does for a while after it.
"""

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Final

from fraese import alarms
from fraese.blocks import Watch, WatchAction, dwell
from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, Demand, Doing
from fraese.errors import HomingError, LimitError
from fraese.machine import Axis, Machine
from fraese.motor.seams import End, Ended, Report
from fraese.phrases import phrase
from fraese.planner.lines import plan_line

Moves = Generator[Demand, Report, Report]
Count = Generator[Demand, Report, int]

#: After each stride a switch has so long to come to rest; the input is read every 10 ms.
_SETTLE_S: Final = 0.1
#: What creeps makes strides of this way, or of one step.
_STRIDE_MM: Final = 0.002


class AxisMoves:
    """Moves of one axis.

    Args:
        controller: whose machine it is.
        name: of the axis.

    Attributes:
        axis: likewise.
        motor: its number.
    """

    def __init__(self, controller: Controller, name: str) -> None:
        self._controller = controller
        self._machine = controller.machine
        self.motor = self._machine.index(name)
        self.axis: Axis = self._machine.axes[self.motor]

    def count(self, report: Report) -> int:
        """Where the motor stands."""
        return self._signed(report.position_steps)

    def _signed(self, counts: Sequence[int]) -> int:
        return counts[self.motor] * self.axis.motor_sign

    # --- ways ----------------------------------------------------------------------------------

    def go(
        self,
        steps: int,
        feed_mm_min: float | None = None,
        watch: Watch | None = None,
        axis: Axis | None = None,
    ) -> Moves:
        """So many steps, from rest to rest.

        Args:
            steps: signed.
            feed_mm_min: None: as fast as the axis can.
            watch: condition on the way.
            axis: with other limits than its own.
        """
        axes = list(self._machine.axes)
        axes[self.motor] = axis or self.axis
        delta = tuple(steps if n == self.motor else 0 for n in range(len(axes)))
        block = plan_line(Machine(tuple(axes)), delta, feed_mm_min, watch=watch)
        if block is not None:
            yield block
        return (yield STANDSTILL)

    def _watch(self, sign: int, *, closed: bool) -> Watch:
        """For the switch of this end, closed or open."""
        end = End(self.motor, sign)
        switches = self._controller.switches
        return switches.watch(closed=closed, action=WatchAction.STOP, end=end)

    def to_contact(self, sign: int, longest_mm: float, feed_mm_min: float) -> Count:
        """Into the switch of this end; the count at the contact.

        Raises:
            HomingError: if it is not found.
        """
        watch = self._watch(sign, closed=True)
        steps = sign * self.axis.to_steps(longest_mm)
        report = yield from self.go(steps, feed_mm_min, watch)
        if report.ended is not Ended.WATCH:
            raise self._not_found(sign, longest_mm)
        return self._latched(report)

    def off_contact(self, sign: int) -> Count:
        """Back from this end until its switch opens; the count then.

        Raises:
            HomingError: if it does not open.
        """
        homing = self._controller.config.homing
        watch = self._watch(sign, closed=False)
        steps = -sign * self.axis.to_steps(homing.back_off_max_mm)
        report = yield from self.go(steps, homing.slow_mm_min, watch)
        if report.ended is not Ended.WATCH:
            raise self._does_not_open(sign, homing.back_off_max_mm)
        return self._latched(report)

    def find(self, sign: int) -> Count:
        """Wherever the axis is: to the switch of this end, off it, and slowly back to it.

        Raises:
            HomingError: if it is not found.
        """
        homing = self._controller.config.homing
        search_mm = self.axis.travel_mm * homing.search_factor
        yield Doing(phrase("to the switch {end_name}", end_name=self.end_name(sign)))
        yield from self.to_contact(sign, search_mm, homing.approach_mm_min)
        yield from self.off_contact(sign)
        return (yield from self.to_contact(sign, 2 * homing.back_off_max_mm, homing.slow_mm_min))

    def leave(self, sign: int) -> Moves:
        """Off the switch of this end, to the pull-off distance; where it is known it says so."""
        yield from self.off_contact(sign)
        pull_off = self.axis.to_steps(self._controller.config.homing.pull_off_mm)
        return (
            yield from self.go(-sign * pull_off, self._controller.config.homing.approach_mm_min)
        )

    # --- creeping ------------------------------------------------------------------------------

    @property
    def stride_steps(self) -> int:
        """How far what creeps goes at once."""
        return max(1, self.axis.to_steps(_STRIDE_MM))

    def creep(self, sign: int, *, closed: bool, longest_mm: float) -> Count:
        """Stride by stride until the switch is closed, or open; the count at that stride.

        Args:
            sign: direction of the axis.
            closed: what is waited for.
            longest_mm: no further.

        Raises:
            HomingError: if it does not come about.
        """
        slow_mm_min = self._controller.config.homing.slow_mm_min
        watch = self._watch(sign if closed else -sign, closed=closed)
        wait = dwell(len(self._machine.axes), _SETTLE_S)._replace(watch=watch)
        report = yield STANDSTILL
        longest = self.count(report) + sign * self.axis.to_steps(longest_mm)
        while (longest - self.count(report)) * sign > 0:
            report = yield from self.go(sign * self.stride_steps, slow_mm_min, watch)
            if report.ended is not Ended.WATCH:
                yield wait
                report = yield STANDSTILL
            if report.ended is Ended.WATCH:
                return self._latched(report)
        raise (
            self._not_found(sign, longest_mm) if closed else self._does_not_open(-sign, longest_mm)
        )

    # --- words ---------------------------------------------------------------------------------

    def require_switches(self) -> None:
        """See that there are end switches, and that none is closed.

        Raises:
            LimitError: if there are none.
            StateError: if one is closed, or the machine is not ready.
        """
        if not self.axis.has_switches:
            name = self.axis.name
            raise LimitError(
                phrase(
                    "{name} has no end switches (axes.{name_2}.end_switches), and this is"
                    " found by one.",
                    name=name.upper(),
                    name_2=name,
                )
            )
        self._controller.check_moves([])

    def end_name(self, sign: int) -> str:
        """As in the original: xmin, xmax."""
        return self.axis.name + ("max" if sign > 0 else "min")

    def _latched(self, report: Report) -> int:
        return self._signed(report.latched_steps or report.position_steps)

    def _not_found(self, sign: int, longest_mm: float) -> HomingError:
        end = self.end_name(sign)
        return HomingError(
            phrase(
                "End switch {end} was not found within {with_unit}: look at the switch; the"
                " machine stands at {in_words}.",
                end=end,
                with_unit=self.axis.with_unit(longest_mm),
                in_words=self._controller.position.in_words(),
            ),
            end=end,
        )

    def _does_not_open(self, sign: int, longest_mm: float) -> HomingError:
        end = self.end_name(sign)
        return HomingError(
            phrase(
                "End switch {end} does not open again within {with_unit}: look for a stuck"
                " switch, and at the wire to DB25 pin {pin}.",
                end=end,
                with_unit=self.axis.with_unit(longest_mm),
                pin=self._controller.switches.pin_of(End(self.motor, sign)),
            ),
            alarms.END_STUCK,
            end=end,
        )


def with_rates(axis: Axis, start_hz: float, rate_hz: float, acceleration_hz_s: float) -> Axis:
    """An axis that may do just that."""
    return replace(
        axis,
        start_rate_hz=min(start_hz, rate_hz),
        max_rate_hz=rate_hz,
        acceleration_hz_s=acceleration_hz_s,
        avoid_hz=(),
    )
