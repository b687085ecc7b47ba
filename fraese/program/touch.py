"""Probe moves: towards the contact, and away from it again.

Rule 1: a probe that shares the end switches' input still touches when its move has ended. Until it
        is free, moves away from the contact or along it are let through, none further in.
"""

from collections.abc import Generator, Iterable

from fraese import alarms
from fraese.blocks import Block, WatchAction
from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, Demand
from fraese.control.softlimits import within_travel
from fraese.errors import ProbeError
from fraese.gcode import canon
from fraese.motor.seams import Ended, Report
from fraese.phrases import phrase
from fraese.planner.planner import Planner
from fraese.program.context import ProgramContext
from fraese.workframe import Point

Part = Generator[Demand, Report, canon.Facts | None]


class Touch:
    """What the probe of one program feels.

    Args:
        context: the machine as the program finds it.
        controller: of the machine; None for a check: then it goes as commanded.
        planner: makes the blocks.
    """

    def __init__(
        self, context: ProgramContext, controller: Controller | None, planner: Planner
    ) -> None:
        self._context = context
        self._controller = controller
        self._planner = planner
        self._way: tuple[float, ...] = ()

    @property
    def is_closed(self) -> bool:
        """The switch is still closed by the probe."""
        return bool(self._way)

    def probe(self, move: canon.Probe, tag: int) -> Part:
        """Straight on until the contact changes.

        Args:
            move: what is commanded.
            tag: names it in the driver's reports.

        Raises:
            ProbeError: it changes never, or is as wanted already.
        """
        controller = self._controller
        if controller is None:
            yield from each(self._planner.line(move.to, move.feed_mm_min, tag))
            yield from each(self._planner.drain())
            return None
        yield from each(self._planner.drain())
        yield STANDSTILL
        where, switches = controller.position, controller.switches
        from_mm = self._point(where.position_steps)
        if switches.probe_closed == move.until_closed:
            raise ProbeError(
                phrase(
                    "line {line}: the probe {word} already; the machine stands at {in_words}.",
                    line=move.line,
                    word=phrase("touches") if move.until_closed else phrase("is free"),
                    in_words=where.in_words(),
                ),
                alarms.PROBE_TOUCHES,
                line=move.line,
            )
        watch = switches.probe_watch(closed=move.until_closed, action=WatchAction.STOP)
        to = within_travel(self._context.machine, where.referenced, from_mm, move.to)
        yield from each(self._planner.watched(to, move.feed_mm_min, watch, tag))
        report = yield STANDSTILL
        touched = report.ended is Ended.WATCH
        contact_mm = self._point(where.latched_steps(report)) if touched else None
        self._planner.reset(where.position_steps, where.slack_steps)
        if move.must_touch and not touched:
            raise ProbeError(
                phrase(
                    "line {line}: the probe never {word}; the machine stands at {in_words}.",
                    line=move.line,
                    word=phrase("touched") if move.until_closed else phrase("came free"),
                    in_words=where.in_words(),
                ),
                line=move.line,
            )
        at_mm = self._point(where.position_steps)
        if report.switch_closed:
            self._way = _way(from_mm, move.to)
        return canon.Facts(position_mm=at_mm, touched=touched, contact_mm=contact_mm)

    def leave(self, move: canon.Rapid | canon.Feed | canon.Along, tag: int) -> Part:
        """A move with the switch still closed by the probe; straight to its end."""
        controller = self._controller
        assert controller is not None
        feed_mm_min = None if isinstance(move, canon.Rapid) else move.feed_mm_min
        way = _way(self._point(controller.position.position_steps), move.to)
        further_in = sum(a * b for a, b in zip(way, self._way, strict=True)) > 0
        watch = controller.switches.watch(closed=False, action=WatchAction.IGNORE)
        if further_in:
            yield from each(self._planner.line(move.to, feed_mm_min, tag))
            yield from each(self._planner.drain())
        else:
            yield from each(self._planner.watched(move.to, feed_mm_min, watch, tag))
        report = yield STANDSTILL
        if not report.switch_closed:
            self._way = ()
        return None

    def _point(self, steps: tuple[int, ...]) -> Point:
        return self._context.machine.to_mm(steps)


def _way(from_mm: Point, to_mm: Point) -> tuple[float, ...]:
    return tuple(b - a for a, b in zip(from_mm, to_mm, strict=True))


def each(blocks: Iterable[Block]) -> Generator[Block, Report, None]:
    """Blocks one by one; a plain iterator cannot take the reports that a job is sent."""
    for block in blocks:
        yield block
