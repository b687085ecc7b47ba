"""Where the axes are, how far that can be relied on, and where the work zero lies.

    driver's counts --backlash taken out--> machine position --work offset--> work position

Rule 1: the driver counts motor steps; the machine's position is derived from them here, and only
        here.
Rule 2: every block that was played is told once and in order (``played``), then what the driver
        reports (``seen``, ``at_rest``); ``MotionQueue`` does so, nobody else.
Rule 3: what others read is replaced whole, so that it may be read from any thread.
Rule 4: an axis is referenced from ``set_reference`` until something shakes it: a stop without ramp
        at speed, or a new reference run.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from fraese.control.workoffsets import WorkOffsets
from fraese.machine import Machine, Steps
from fraese.motor.seams import Report
from fraese.phrases import joined, phrase
from fraese.planner.backlash import Carriages
from fraese.workframe import WorkFrame


@dataclass(frozen=True, slots=True)
class Doubt:
    """The position may be another one.

    Attributes:
        why: half a sentence.
        spans_steps: per axis, by how much it may be below and above; empty: nobody knows.
        referenced: per axis, whether it was referenced before; empty: nobody knows.
    """

    why: str
    spans_steps: tuple[tuple[int, int], ...] = ()
    referenced: tuple[bool, ...] = ()


class Position:
    """Position, reference and work offsets of all axes; they begin at machine zero.

    Args:
        machine: axes and conversions.

    Attributes:
        machine: likewise.
        position_steps: machine position at the driver's last report.
        referenced: per axis, whether its position can be relied on.
        offsets: the work offsets.
        doubt: why and by how much it may be another one, until all axes are referenced.
        was_abandoned: the program before was not closed, and the machine stood.
        turn_steps: per axis, steps in one electrical turn of its motor; 0: not known.
        aim_steps: where the last move by hand leads; None: another job came since.
    """

    def __init__(self, machine: Machine) -> None:
        axes = len(machine.axes)
        self.machine = machine
        self.position_steps: Steps = (0,) * axes
        self.referenced = (False,) * axes
        self.offsets = WorkOffsets(
            "".join(axis.name for axis in machine.axes), lambda: self.referenced
        )
        self.doubt: Doubt | None = None
        self.was_abandoned = False
        self.turn_steps: Steps = (0,) * axes
        self.aim_steps: Steps | None = None
        self._carriages = Carriages(machine, self.position_steps)
        # Motor steps that the carriages have been told of.
        self._told_steps = self.position_steps

    # --- what the driver did -------------------------------------------------------------------

    def count_from(self, motor_steps: Steps) -> None:
        """What the driver has counted so far was before our time."""
        self._told_steps = motor_steps

    def played(self, motor_steps: Steps) -> None:
        """A block was played to its end."""
        self._carriages.advance(motor_steps)
        self._told_steps = tuple(a + b for a, b in zip(self._told_steps, motor_steps, strict=True))

    def at_rest(self, motor_steps: Steps) -> None:
        """The queue is empty; of the last block the driver counts what was really played.

        Args:
            motor_steps: what the driver has counted so far.
        """
        self.played(self._untold(motor_steps))

    def seen(self, motor_steps: Steps) -> None:
        """This is what the driver has counted so far."""
        self.position_steps = self._carriages.seen(self._untold(motor_steps))

    def _untold(self, motor_steps: Steps) -> Steps:
        return tuple(a - b for a, b in zip(motor_steps, self._told_steps, strict=True))

    # --- position ------------------------------------------------------------------------------

    @property
    def slack_steps(self) -> Steps:
        """How much of each axis' backlash lies between motor and carriage; at standstill."""
        return self._carriages.slack_steps

    def slack_seen_steps(self, motor_steps: Steps) -> Steps:
        """The same where the driver has counted this; also in the middle of a block."""
        return self._carriages.slack_seen(self._untold(motor_steps))

    def latched_steps(self, report: Report) -> Steps:
        """Machine position at the contact that fulfilled a watch.

        The motors have not turned round since, so what they did since then their axes did too.
        """
        latched_steps = report.latched_steps or report.position_steps
        return tuple(
            here - axis.motor_sign * (now - then)
            for here, axis, now, then in zip(
                self.position_steps,
                self.machine.axes,
                report.position_steps,
                latched_steps,
                strict=True,
            )
        )

    @property
    def to_go_mm(self) -> tuple[float, ...]:
        """What is left of the move by hand in hand, per axis; 0 without one. From any thread."""
        here, aim = self.position_steps, self.aim_steps
        return self.machine.to_mm(tuple(a - b for a, b in zip(aim or here, here, strict=True)))

    def in_words(self) -> str:
        """The machine position in words."""
        position_mm = self.machine.to_mm(self.position_steps)
        return self.machine.in_words(position_mm) + " (machine)"

    def take_up(
        self,
        position_steps: Steps,
        slack_steps: Steps,
        referenced: Sequence[bool],
        parameters: Mapping[int, float],
    ) -> None:
        """Go on where another run ended; at standstill."""
        self._carriages.slack_steps = slack_steps
        self._stand_at(position_steps)
        self.referenced = tuple(referenced)
        self.offsets.take_up(parameters)

    def _stand_at(self, position_steps: Steps) -> None:
        self._carriages.position_steps = self.position_steps = position_steps

    # --- reference -----------------------------------------------------------------------------

    def set_reference(self, name: str, position_steps: int) -> tuple[str, ...]:
        """Let the present position of an axis be this one, and count it as referenced.

        Returns:
            Which work offsets were carried along, see ``WorkOffsets.carry``.
        """
        motor = self.machine.index(name)
        position = list(self.position_steps)
        way_steps = position_steps - position[motor]
        position[motor] = position_steps
        self._stand_at(tuple(position))
        self.referenced = tuple(n == motor or old for n, old in enumerate(self.referenced))
        if all(self.referenced):
            self.doubt, self.was_abandoned = None, False
        return self.offsets.carry(name, self.machine.axes[motor].to_mm(way_steps))

    def doubt_between(self, why: str, low_steps: Steps, high_steps: Steps) -> None:
        """The motors may have counted anything between these; a doubt of before goes on.

        Args:
            why: half a sentence.
            low_steps: of the driver's counts, per motor; what it was told last is not below,
            high_steps: and not above.
        """
        old = self.doubt.spans_steps if self.doubt else ((0, 0),) * len(low_steps)
        spans = []
        for axis, at, low, high, slack, (below, above) in zip(
            self.machine.axes, self._told_steps, low_steps, high_steps, self.slack_steps, old,
            strict=False,
        ):  # fmt: skip
            down, up = sorted((axis.motor_sign * (low - at), axis.motor_sign * (high - at)))
            # Where the motor turned round since is not known, so the carriage lags by all or none.
            spans.append((below - down + slack, above + up + axis.backlash_steps - slack))
        # Nobody may take it as it was left: a motor that lost its current at speed turned on.
        self.doubt = Doubt(why, tuple(spans))

    def bounds_steps(self) -> list[tuple[int, int]]:
        """Per axis, between which places it is; empty: nobody knows, or there is no doubt."""
        spans = self.doubt.spans_steps if self.doubt else ()
        return [
            (at, at) if is_sure else (at - below, at + above)
            for at, (below, above), is_sure in zip(
                self.position_steps, spans, self.referenced, strict=False
            )
        ]

    def doubt_in_words(self) -> str:
        """What is not known of the position, and what to do, a sentence; empty if nothing."""
        if self.doubt is None:
            return ""
        also = phrase(", or take it as it was left (fraese trust)") if self.finds_back else ""
        return phrase("{doubted}; reference it again{also}.", doubted=self.doubted(), also=also)

    def doubted(self) -> str:
        """What is not known of the position, a sentence without its end; empty if nothing."""
        if self.doubt is None:
            return ""
        between = [
            phrase(
                "{name} {to_mm:.3f} and {to_mm_2:.3f}",
                name=axis.name.upper(),
                to_mm=axis.to_mm(low),
                to_mm_2=axis.to_mm(high),
            )
            for axis, is_sure, (low, high) in zip(
                self.machine.axes, self.referenced, self.bounds_steps(), strict=False
            )
            if not is_sure
        ]
        where = (
            phrase(", between {between} (machine)", between=joined(", ", between))
            if between
            else ""
        )
        return phrase("The position is not trusted: {why}{where}", why=self.doubt.why, where=where)

    @property
    def finds_back(self) -> bool:
        """The motors, wherever they are in these bounds, are pulled back to where they are counted.

        That is so from less than half an electrical turn: the phases are kept with the position.
        """
        doubt = self.doubt
        if doubt is None or not doubt.spans_steps or not doubt.referenced:
            return False
        return all(
            known or max(span) == 0 or 2 * max(span) < turn
            for known, span, turn in zip(
                self.referenced, doubt.spans_steps, self.turn_steps, strict=True
            )
        )

    def take_as_left(self) -> None:
        """What is doubted is as it was left, and as good as its reference was."""
        if self.doubt is not None:
            before = zip(self.referenced, self.doubt.referenced, strict=True)
            self.referenced = tuple(now or then for now, then in before)
        self.doubt, self.was_abandoned = None, False

    def lose_reference(self, motors: Iterable[int]) -> None:
        """These axes are not to be relied on."""
        lost = frozenset(motors)
        if lost:
            self.referenced = self._without(lost, self.referenced)
            if self.doubt is not None:
                before = self._without(lost, self.doubt.referenced)
                self.doubt = replace(self.doubt, referenced=before)

    @staticmethod
    def _without(lost: Collection[int], referenced: Sequence[bool]) -> tuple[bool, ...]:
        return tuple(old and n not in lost for n, old in enumerate(referenced))

    # --- work offsets --------------------------------------------------------------------------

    @property
    def frame(self) -> WorkFrame:
        """Where the work lies."""
        return self.offsets.frame

    def set_zero(self, axes: Collection[str], value_mm: float) -> None:
        """Let the present position of some axes have this work coordinate."""
        self.offsets.set_zero(axes, self.machine.to_mm(self.position_steps), value_mm)

    def to_steps(
        self, targets_mm: Mapping[str, float], *, relative: bool, machine_coordinates: bool
    ) -> Steps:
        """Where a straight line of some axes leads; the others stay where they are.

        Args:
            targets_mm: by axis name, in work coordinates.
            relative: as distances from here, along the axes of the work, instead.
            machine_coordinates: from machine zero instead.
        """
        names = [axis.name for axis in self.machine.axes]
        here_mm = self.machine.to_mm(self.position_steps)
        moved = frozenset(targets_mm)
        if relative:
            way_mm = self.frame.turned(tuple(targets_mm.get(name, 0.0) for name in names))
            to_mm = tuple(at + by for at, by in zip(here_mm, way_mm, strict=True))
        elif machine_coordinates:
            to_mm = tuple(targets_mm.get(name, 0.0) for name in names)
        else:
            work_mm = self.frame.to_work(here_mm)
            wanted = zip(names, work_mm, strict=True)
            to_mm = self.frame.to_machine(tuple(targets_mm.get(name, at) for name, at in wanted))
        if not machine_coordinates:
            moved = self.frame.moved_with(targets_mm)
        return tuple(
            axis.to_steps(mm) if axis.name in moved else here
            for axis, mm, here in zip(self.machine.axes, to_mm, self.position_steps, strict=True)
        )
