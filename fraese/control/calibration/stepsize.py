"""Steps per millimetre from a way that somebody measured.

    run in (backlash out) | mark, or zero the gauge | the way -->|  how far did it really go?

    new pitch = pitch in force * way measured / way commanded

Rule 1: the way is run in its own direction, so that no backlash is in it.
Rule 2: a measuring error is taken for what it is: where a pitch that is made lies within it, that
        one is meant.
Rule 3: what went the other way is inverted.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any, Final

from fraese.control.calibration.moves import AxisMoves
from fraese.control.calibration.proposal import Change, Proposal, proposal
from fraese.control.controller import Controller
from fraese.control.jobs import Ask, Job
from fraese.control.softlimits import require_finite
from fraese.errors import LimitError
from fraese.machine import Axis
from fraese.phrases import phrase

#: What is sold: threads of spindles, belts times teeth, in mm a turn.
MADE_PITCHES: Final = (
    0.5, 0.7, 0.75, 0.8, 1, 1.25, 1.5, 1.75, 2, 2.5, 3, 3.5, 4, 5, 6, 8, 10, 12, 16, 20, 24, 25, 30,
    32, 36, 40, 48, 50, 60, 80, 100,
)  # fmt: skip
#: And in inches: leads of 20, 16, 13, 12, 10, 8, 5, 4 and 2 threads.
INCH_PITCHES: Final = (1.27, 1.5875, 1.9538, 2.1167, 2.54, 3.175, 5.08, 6.35, 12.7)
#: How well a way is read with a ruler or a calliper.
READING_MM: Final = 0.05
_DIGITS: Final = Decimal("0.000001")
#: The motor makes more than this at once only for a way that is to be measured.
_RUN_IN_MM: Final = 1.0


@dataclass(frozen=True, slots=True)
class StepSize:
    """A way that was commanded and measured, mm or degrees.

    Attributes:
        axis: its name.
        commanded_mm: what the axis was told.
        measured_mm: what it did; negative: the other way.
        steps_per_mm: in force.
    """

    axis: str
    commanded_mm: float
    measured_mm: float
    steps_per_mm: float

    @property
    def found_steps_per_mm(self) -> float:
        """What would have been right."""
        return self.steps_per_mm * abs(self.commanded_mm / self.measured_mm)

    @property
    def is_inverted(self) -> bool:
        """It went the other way."""
        return self.commanded_mm * self.measured_mm < 0

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {
            "commanded_mm": self.commanded_mm,
            "measured_mm": self.measured_mm,
            "steps_per_mm": self.steps_per_mm,
            "found_steps_per_mm": round(self.found_steps_per_mm, 6),
            "inverted": self.is_inverted,
        }


class StepSizeTest:
    """Makes a way that is measured from outside.

    Args:
        controller: of the machine.
        axis: name.

    Attributes:
        commanded_mm: the way that was made; 0: none yet.
        result: what was found; None: nothing yet.
    """

    def __init__(self, controller: Controller, axis: str) -> None:
        self._controller = controller
        self._moves = AxisMoves(controller, axis)
        self.commanded_mm = 0.0
        self.result: StepSize | None = None

    def start(self, way_mm: float, *, ask: bool = True) -> None:
        """Make the way; the controller's ``run`` does it.

        Args:
            way_mm: signed.
            ask: wait between running in and the way, so that somebody can mark where it begins.

        Raises:
            LimitError: if there is no room for it, or nothing to measure.
            StateError: if the machine is not ready.
        """
        axis, motor, where = self._moves.axis, self._moves.motor, self._controller.position
        require_finite(axis, way_mm)
        run_in = axis.to_steps(_run_in_mm(axis, way_mm))
        way = axis.to_steps(abs(way_mm)) * (1 if way_mm > 0 else -1)
        if not way:
            raise LimitError(
                phrase(
                    "A way must be at least one step of {with_unit}.",
                    with_unit=axis.with_unit(axis.step_mm),
                )
            )
        target = list(where.position_steps)
        target[motor] += run_in + way
        self._controller.check_moves([tuple(target)])
        self._controller.start(
            phrase("a way of {name}", name=axis.name.upper()), self._job(run_in, way, ask)
        )

    def _job(self, run_in: int, way: int, ask: bool) -> Job:
        axis, feed = self._moves.axis, self._controller.config.jog.feed_mm_min
        yield from self._moves.go(run_in, feed)
        if ask:
            yield Ask(
                phrase(
                    "Mark where {name} stands, or set the gauge to zero. Then it moves"
                    " {with_unit}.",
                    name=axis.name.upper(),
                    with_unit=axis.with_unit(axis.to_mm(way)),
                ),
                waits_for=phrase("mark"),
            )
        yield from self._moves.go(way, feed)
        self.commanded_mm = axis.to_mm(way)

    def measured(self, commanded_mm: float, measured_mm: float) -> StepSize:
        """Take what was read.

        Args:
            commanded_mm: what the axis was told.
            measured_mm: what it did; negative: the other way.

        Raises:
            LimitError: if nothing can be made of it.
        """
        axis = self._moves.axis
        for value in (commanded_mm, measured_mm):
            require_finite(axis, value)
        if not commanded_mm or not measured_mm:
            raise LimitError(
                phrase(
                    "A way of nothing says nothing: give how far it went, or look why it"
                    " does not move."
                )
            )
        self.result = StepSize(axis.name, commanded_mm, measured_mm, float(axis.steps_per_mm))
        return self.result

    def proposals(self, reading_mm: float = READING_MM) -> tuple[Proposal, ...]:
        """What the configuration should say, the likeliest first; empty: nothing was measured.

        Args:
            reading_mm: by how much the reading may be off.
        """
        found = self.result
        if found is None:
            return ()
        config, axis = self._controller.config.axes.table[found.axis], self._moves.axis
        key = f"axes.{found.axis}.pitch_{config.key_unit}"
        ratio = abs(Fraction(str(found.measured_mm)) / Fraction(str(found.commanded_mm)))
        exact = _rounded(Fraction(config.pitch) * ratio)
        off = abs(reading_mm / found.measured_mm)
        turned = Change(f"axes.{found.axis}.inverted", config.inverted, not config.inverted)
        return tuple(
            proposal(
                phrase(
                    "{axis} moved {with_unit} for {with_unit_2}: {said}.",
                    axis=found.axis.upper(),
                    with_unit=axis.with_unit(abs(found.measured_mm)),
                    with_unit_2=axis.with_unit(abs(found.commanded_mm)),
                    said=said,
                ),
                Change(key, config.pitch, pitch),
                *([turned] if found.is_inverted else []),
            )
            for pitch, said in _pitches(config.pitch, exact, off, is_linear=config.kind == "linear")
        )


def _run_in_mm(axis: Axis, way_mm: float) -> float:
    return (1 if way_mm > 0 else -1) * max(_RUN_IN_MM, 2 * axis.to_mm(axis.backlash_steps))


def _rounded(value: Fraction) -> Decimal:
    exact = Decimal(value.numerator) / Decimal(value.denominator)
    return exact.quantize(_DIGITS).normalize()


def _pitches(
    old: Decimal, exact: Decimal, off: float, *, is_linear: bool
) -> Iterator[tuple[Decimal, str]]:
    """Pitches that explain it, the likeliest first, each once."""
    known = [(old, phrase("the pitch in force is right, as far as that can be read"))]
    if is_linear:
        known += [
            (Decimal(str(pitch)), phrase("a pitch that is made"))
            for pitch in (*MADE_PITCHES, *INCH_PITCHES)
        ]
    given = set()
    for pitch, said in known:
        if abs(float(pitch / exact) - 1) <= off and pitch not in given:
            given.add(pitch)
            yield pitch, said
    if exact not in given:
        yield exact, phrase("as it was read")
