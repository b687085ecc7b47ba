"""What survives a restart: position, reference, work offsets, phase index; and what is doubtful.

Rule 1: while the machine may move the record says so, and between which places it is. If it still
        says so at the next start, the program ended in the middle of something: the position is
        shown with its bounds, the reference is not believed.
Rule 2: a doubt stays in every later record until all axes have been referenced.
"""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from fraese.control.bounds import Box
from fraese.control.position import Doubt, Position
from fraese.errors import ConfigError
from fraese.machine import Axis, Steps
from fraese.motor.seams import Report
from fraese.phrases import phrase, remembered
from fraese.workframe import ACTIVE_SYSTEM, SYSTEMS

#: No machine was ever so far from its zero.
_FARTHEST_STEPS: Final = 10**10 - 1

_Count = Annotated[int, Field(ge=-_FARTHEST_STEPS, le=_FARTHEST_STEPS)]
_Counts = tuple[_Count, ...]

IN_MOTION: Final = phrase("the program ended while the machine moved")
DAMAGED: Final = phrase("the last record of its place was damaged")


class _Fact(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


class Motion(_Fact):
    """The machine may move.

    Attributes:
        low_steps: machine position per axis; below it nothing reaches that the motors were given.
        high_steps: likewise, above it.
        counted_steps: what the driver had counted where ``position_steps`` was, per motor,
        travelled_steps: and that with both directions added.
    """

    low_steps: _Counts
    high_steps: _Counts
    counted_steps: _Counts = ()
    travelled_steps: _Counts = ()

    @classmethod
    def of(cls, axes: Sequence[Axis], at_steps: Steps, report: Report, box: Box) -> "Motion":
        """Carriages follow their motors or lag behind, so they stay within what those do.

        Args:
            axes: of the machine.
            at_steps: position per axis,
            report: where the driver has counted this.
            box: what its counts stay within.
        """
        low, high = [], []
        for axis, at, motor, least, most in zip(
            axes, at_steps, report.position_steps, box.low, box.high, strict=True
        ):
            ways = sorted((axis.motor_sign * (least - motor), axis.motor_sign * (most - motor)))
            low.append(at + ways[0])
            high.append(at + ways[1])
        return cls(
            low_steps=tuple(low),
            high_steps=tuple(high),
            counted_steps=report.position_steps,
            travelled_steps=report.travelled_steps,
        )


class KeptDoubt(_Fact):
    """See ``Doubt``."""

    why: str = Field(max_length=200)
    spans_steps: tuple[tuple[_Count, _Count], ...] = ()
    referenced: tuple[bool, ...] = ()


class SavedState(_Fact):
    """One state of one machine.

    Attributes:
        position_steps: machine position per axis.
        slack_steps: backlash between motor and carriage, per axis.
        parameters: persistent parameters of the language, work offsets among them.
        referenced: per axis.
        phases: phase index per motor.
        ends: which ends the contact may be; none: there was no contact.
        simulation: what the simulated mill needs to be found as it was left.
        axes: what gives the steps of each axis their meaning; configured otherwise, they have none.
        motion: the machine may move; None: it stands.
        doubt: why the position may be another one; None: it is as good as its reference.
        in_hand: the program that wrote it had not closed the machine yet.
        job: what must be known to go on with a program that was cut short; None: there is none.
        session: which opening of the machine wrote it.
        moving: files of earlier versions said so that the machine may move.
    """

    position_steps: _Counts
    slack_steps: _Counts
    parameters: dict[int, float]
    referenced: tuple[bool, ...]
    phases: _Counts
    ends: tuple[str, ...] = ()
    simulation: tuple[tuple[float, float, float, float], ...] = ()
    axes: tuple[str, ...] = ()
    motion: Motion | None = None
    doubt: KeptDoubt | None = None
    in_hand: bool = False
    job: dict[str, Any] | None = None
    session: str = ""
    moving: bool = False

    @classmethod
    def of(cls, where: Position, phases: Steps, ends: Sequence[str]) -> "SavedState":
        """What is to be kept of a machine at standstill."""
        doubt = where.doubt
        return cls(
            position_steps=where.position_steps,
            slack_steps=where.slack_steps,
            parameters=where.offsets.kept(),
            referenced=where.referenced,
            phases=phases,
            ends=tuple(ends),
            doubt=doubt and KeptDoubt(**asdict(doubt)),
        )

    def give_back(self, where: Position) -> None:
        """Let the axes stand where they were left."""
        where.take_up(self.position_steps, self.slack_steps, self.referenced, self.parameters)
        if self.doubt is not None:
            why = remembered(self.doubt.why)
            where.doubt = Doubt(**{**dict(self.doubt), "why": why})
        where.was_abandoned = self.in_hand and self.doubt is None and any(self.referenced)

    def believed(self, *, is_trusted: bool = True) -> "SavedState":
        """What of it may be believed at a start, see rule 1.

        Args:
            is_trusted: it is the last one that was written.
        """
        doubt, motion = self.doubt, self.motion
        if not is_trusted:
            doubt = KeptDoubt(why=DAMAGED)
        elif motion is not None:
            # A doubt of before goes on, as wide as it was, around each place that is possible.
            old = doubt.spans_steps if doubt else ((0, 0),) * len(self.position_steps)
            spans = [
                (at - low + below, high - at + above)
                for at, low, high, (below, above) in zip(
                    self.position_steps, motion.low_steps, motion.high_steps, old, strict=False
                )
            ]
            known = doubt is None or bool(doubt.spans_steps)
            doubt = KeptDoubt(
                why=IN_MOTION,
                spans_steps=tuple(spans) if known else (),
                referenced=self._was_referenced(),
            )
        elif self.moving:
            doubt = KeptDoubt(why=IN_MOTION)
        else:
            return self
        # Nor is believed what was known of a contact before it moved.
        nothing = {"referenced": (False,) * len(self.referenced), "ends": ()}
        return self.model_copy(update={**nothing, "doubt": doubt, "motion": None, "moving": False})

    def _was_referenced(self) -> tuple[bool, ...]:
        """Before that doubt, or an older one, came up."""
        before = (self.doubt and self.doubt.referenced) or self.referenced
        return tuple(a or b for a, b in zip(self.referenced, before, strict=True))

    @field_validator("parameters")
    @classmethod
    def _a_system(cls, value: dict[int, float]) -> dict[int, float]:
        if value.get(ACTIVE_SYSTEM, 1) not in range(1, len(SYSTEMS) + 1):
            raise ValueError(phrase("no such work offset"))
        return value


def state_in(text: bytes, axes: int, name: str) -> SavedState:
    """What a record or an old file says, for a machine of so many axes.

    Args:
        text: JSON.
        axes: how many there are.
        name: of the file, for people.

    Raises:
        ConfigError: if it does not make sense.
    """
    try:
        kept = SavedState.model_validate_json(text)
    except ValidationError as error:
        raise ConfigError(
            phrase("{name}: is damaged; start with --fresh and reference the machine.", name=name)
        ) from error
    motion, doubt = kept.motion, kept.doubt
    per_axis: list[tuple[object, ...]] = [
        kept.position_steps,
        kept.slack_steps,
        kept.referenced,
        kept.phases,
        kept.simulation or (None,) * axes,
        *((motion.low_steps, motion.high_steps) if motion else ()),
        (doubt.spans_steps if doubt else ()) or (None,) * axes,
        (doubt.referenced if doubt else ()) or (None,) * axes,
    ]
    if any(len(values) != axes for values in per_axis):
        raise ConfigError(
            phrase(
                "{name}: belongs to a machine with another number of axes; start with --fresh.",
                name=name,
            )
        )
    return kept
