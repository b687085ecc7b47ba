r"""The streaming planner: canonical moves in millimetres in, final blocks in steps out.

    line, arc --> merging --> rounding --> backlash --> segments --> window --> blocks
                  (G64 P)     absolute     take-up      limits       look-ahead

Rule 1: targets are rounded once and absolutely. A move of no steps vanishes; what it was short of
        a step is in the next target.
Rule 2: every method gives the blocks that became final by it, in order; take all of them before
        the next call. A long move or an arc is planned while its blocks are taken, so that memory
        is bounded and an override acts on what is not taken yet. There may be no blocks for a
        while: what is held back is bounded too, and ``drain`` gives it.
Rule 3: blocks so far always allow a stop within themselves; after ``drain`` they end in one.
Rule 4: memory does not grow with the length of the program, nor with that of an arc.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final

from fraese.blocks import DARK, OVERRIDES, Q8, RAPID_OVERRIDES, Block, Outputs, Power, Watch, dwell
from fraese.feedway import GROUPS
from fraese.machine import Machine, Steps
from fraese.planner.arcs import Point, arc_shape, curve_mm_s, planes_of
from fraese.planner.laws import law_of
from fraese.planner.merging import Chain
from fraese.planner.options import Options, PathMode
from fraese.planner.segments import UNLIMITED, limits_of
from fraese.planner.shapedwindow import window_for
from fraese.planner.targets import NO_BEAM, Beam, Targets
from fraese.planner.timing import BlockMaker

__all__ = ["Options", "PathMode", "Planner"]

_S_PER_MIN: Final = 60
#: A feed below this takes longer than a life for any move; it would not be told from none.
_SLOWEST_MM_S: Final = 1e-6


class Planner:
    """Look-ahead planning of a stream of moves.

    Args:
        machine: conversions and limits, of any number of axes; points have a value for each.
        start_steps: where the axes are, in axis steps.
        options: what can be chosen.
        slack_steps: of each axis' backlash, see ``backlash``; None: nil.

    Attributes:
        tell: told where each move ends, by its tag; of merged ones the line that they became.
    """

    def __init__(
        self,
        machine: Machine,
        start_steps: Steps,
        options: Options = Options(),  # noqa: B008 (immutable)
        slack_steps: Steps | None = None,
    ) -> None:
        self._machine = machine
        self._options = options
        self._limits = limits_of(machine, options.rate_factor)
        self._planes = planes_of(machine.names)
        # Points are merged while no other axis moves.
        self._followers = [n for n, name in enumerate(machine.names) if name not in GROUPS[0]]
        self._law = law_of(machine)
        self._maker = BlockMaker(machine, self._law)
        self._exact_stop = False
        self._tolerance_mm = 0.0
        self._override = self._rapid = 1.0
        self._keeps_feed = False
        self.tell: Callable[[int, Point], object] | None = None
        self._beam = NO_BEAM
        self._begin_at(start_steps, slack_steps or (0,) * len(machine.axes))

    def _begin_at(self, position_steps: Steps, slack_steps: Steps) -> None:
        options = self._options
        window = window_for(self._law, self._limits, self._maker, options)
        window.set_override(self._override, self._rapid)
        self._window = window
        self._targets = Targets(
            self._machine,
            self._limits,
            window,
            options.max_block_s,
            position_steps,
            slack_steps,
        )
        self._targets.exact_stop = self._exact_stop
        self._targets.override, self._targets.rapid = self._override, self._rapid
        self._targets.keeps_feed, self._targets.beam = self._keeps_feed, self._beam
        self._chain = Chain()
        self._target_mm = self._machine.to_mm(position_steps)

    # --- where it is ---------------------------------------------------------------------------

    @property
    def position_steps(self) -> Steps:
        """Axis steps at the end of all that was planned."""
        return self._targets.reached_steps

    @property
    def slack_steps(self) -> Steps:
        """Slack of the axes there."""
        return self._targets.slack_steps

    @property
    def pending(self) -> int:
        """Segments whose blocks are not final."""
        return len(self._window) + (self._chain.end is not None)

    # --- moves ---------------------------------------------------------------------------------

    def line(self, to_mm: Point, feed_mm_min: float | None = None, tag: int = 0) -> Iterable[Block]:
        """A straight move.

        Args:
            to_mm: target in machine coordinates.
            feed_mm_min: speed along the path, see ``feedway``; None: as fast as the axes can.
            tag: seen in reports.

        Raises:
            ValueError: if the feed is not positive.
        """
        feed_mm_s = self._begin(feed_mm_min)
        if self._tolerance_mm and feed_mm_min is not None and not self._follows(to_mm):
            return self._merge(to_mm, feed_mm_s, tag)
        held = self._end_chain()
        if held is not None:
            return self._line_after(held, to_mm, feed_mm_s, tag)
        return self._line(to_mm, feed_mm_s, tag)

    def _follows(self, to_mm: Point) -> bool:
        """An axis moves that is not measured in space."""
        return any(to_mm[axis] != self._target_mm[axis] for axis in self._followers)

    def _line(self, to_mm: Point, feed_mm_s: float, tag: int) -> Iterable[Block]:
        parts = self._targets.go(to_mm, feed_mm_s, UNLIMITED, tag)
        self._target_mm = to_mm
        if self.tell is not None:
            self.tell(tag, to_mm)
        if parts is not None:
            return parts
        window = self._window
        return window.settle() if window.due else ()

    def _line_after(
        self, held: Iterator[Block], to_mm: Point, feed_mm_s: float, tag: int
    ) -> Iterator[Block]:
        yield from held
        yield from self._line(to_mm, feed_mm_s, tag)

    def _merge(self, to_mm: Point, feed_mm_s: float, tag: int) -> Iterable[Block]:
        """Lengthen the line that waits, or let it go and make this one wait."""
        held = None
        if not self._chain.take(to_mm, feed_mm_s, self._tolerance_mm):
            held = self._end_chain()
            self._chain.begin(self._target_mm, to_mm, feed_mm_s, tag)
        self._target_mm = to_mm
        if held is not None:
            return held
        return self._window.settle() if self._window.due else ()

    def arc(
        self,
        to_mm: Point,
        centre_mm: tuple[float, float],
        plane: int,
        turns: int,
        feed_mm_min: float,
        tag: int = 0,
    ) -> Iterator[Block]:
        """An arc or helix, as chords; to be iterated to its end.

        Args:
            to_mm: end in machine coordinates.
            centre_mm: in the first and second axis of the plane: XY, ZX or YZ.
            plane: 17, 18 or 19; all axes outside it go along evenly.
            turns: signed, positive counter-clockwise seen from the positive third axis.
            feed_mm_min: speed along the path.
            tag: seen in reports.

        Raises:
            ValueError: if the feed is not positive, ``turns`` is 0, or the machine has no such
                plane.
        """
        feed_mm_s = self._begin(feed_mm_min)
        shape = arc_shape(self._target_mm, to_mm, centre_mm, plane, turns, self._planes)
        self._target_mm = to_mm
        if self.tell is not None:
            self.tell(tag, to_mm)
        self._targets.streaming = True
        limit_mm_s = self._curve_mm_s(plane, shape.radius_mm)
        return self._walk(
            shape.corners(self._options.chord_tolerance_mm), feed_mm_s, limit_mm_s, tag
        )

    def along(
        self,
        points_mm: Iterable[Point],
        to_mm: Point,
        feed_mm_min: float | None,
        tag: int = 0,
        *,
        plane: int = 17,
        radius_mm: float = 0.0,
    ) -> Iterator[Block]:
        """One move along many points; to be iterated to its end.

        Args:
            points_mm: in machine coordinates, the last one is
            to_mm: its end.
            feed_mm_min: as for ``line``.
            tag: seen in reports.
            plane: of an arc.
            radius_mm: of it; 0: the points lie on a line that is nearly straight.

        Raises:
            ValueError: if the feed is not positive, or the machine has no such plane.
        """
        feed_mm_s = self._begin(feed_mm_min)
        self._target_mm = to_mm
        if self.tell is not None:
            self.tell(tag, to_mm)
        self._targets.streaming = True
        limit_mm_s = self._curve_mm_s(plane, radius_mm) if radius_mm else UNLIMITED
        return self._walk(points_mm, feed_mm_s, limit_mm_s, tag)

    def _curve_mm_s(self, plane: int, radius_mm: float) -> float:
        return curve_mm_s([self._machine.axes[axis] for axis in self._planes[plane]], radius_mm)

    def _walk(
        self, corners: Iterable[Point], feed_mm_s: float, curve_mm_s: float, tag: int
    ) -> Iterator[Block]:
        yield from self._end_chain() or ()
        targets, window = self._targets, self._window
        for corner in corners:
            yield from targets.go(corner, feed_mm_s, curve_mm_s, tag) or ()
            targets.streaming = True
            # Only the ends of an arc, or of another course, are corners of the program.
            targets.exact_stop = False
            if window.due:
                yield from window.settle()
        targets.exact_stop = self._exact_stop
        targets.streaming = False

    def watched(
        self, to_mm: Point, feed_mm_min: float | None, watch: Watch, tag: int = 0
    ) -> Sequence[Block]:
        """A straight move from rest to rest in one block with a watch (a probe).

        Where it really ended is for the caller to find out, and to ``reset`` to.

        Raises:
            ValueError: if the feed is not positive.
        """
        feed_mm_s = self._begin(feed_mm_min)
        blocks = list(self.drain())
        self._targets.go(to_mm, feed_mm_s, UNLIMITED, tag, watch)
        self._target_mm = to_mm
        if self.tell is not None:
            self.tell(tag, to_mm)
        return blocks + self._window.settle(everything=True)

    def dwell(self, duration_s: float, tag: int = 0) -> Sequence[Block]:
        """Come to rest and wait.

        Raises:
            ValueError: if the duration is negative.
        """
        # A beam that goes with the speed has none here.
        power = DARK if self._beam.per_feed else Power(self._beam.share)
        pause = dwell(len(self._machine.axes), duration_s, tag)
        blocks = [*self.drain(), pause._replace(outputs=self._targets.outputs, power=power)]
        self._targets.outputs = None
        if duration_s >= max(2 / axis.start_rate_hz for axis in self._machine.axes):
            self._window.stand()
        return blocks

    def outputs(self, mask: int, value: int) -> Sequence[Block]:
        """Change free outputs at the first tick of the next move, without stopping for it."""
        blocks = self.end_line()
        if self._targets.outputs is not None:
            before, was = self._targets.outputs
            value = was & ~mask | value & mask
            mask |= before
        self._targets.outputs = Outputs(mask, value & mask)
        return blocks

    def beam(self, share: int, *, follows: bool) -> Sequence[Block]:
        """Power of a lamp along the feeds from here on, without stopping for it.

        Args:
            share: of its full power, 0 to ``FULL_POWER``.
            follows: that is at the programmed feed; played slower or faster, in proportion.
        """
        blocks = self.end_line()
        # An unreferenced machine is slower than its program says.
        per_feed = 1 / self._options.rate_factor if follows else 0.0
        self._beam = self._targets.beam = Beam(share, per_feed)
        return blocks

    def path_control(self, mode: str, tolerance_mm: float = 0.0) -> Sequence[Block]:
        """G61, G61.1 or G64 with its P.

        Args:
            mode: a ``PathMode`` or its code.
            tolerance_mm: for G64: how far merged points may lie off their line; 0: none are.

        Raises:
            ValueError: if the mode is unknown.
        """
        wanted = PathMode(mode)
        blocks = self.end_line()
        self._exact_stop = self._targets.exact_stop = wanted is PathMode.EXACT_STOP
        self._tolerance_mm = tolerance_mm if wanted is PathMode.BLEND else 0.0
        return blocks

    # --- flow ----------------------------------------------------------------------------------

    def ready(self) -> Sequence[Block]:
        """What is final already; nothing is given away."""
        return self._window.settle()

    def drain(self) -> Sequence[Block]:
        """Everything that was commanded, ending at rest; for a slow producer, a barrier, a pause.

        The next move goes on from there, from the start/stop rate.
        """
        blocks = list(self.end_line())
        return blocks + self._window.settle(everything=True)

    def finish(self) -> Sequence[Block]:
        """The same at the end of a program; outputs that wait for a move do not wait longer."""
        blocks = list(self.drain())
        if self._targets.outputs is not None:
            blocks.append(dwell(len(self._machine.axes), 0)._replace(outputs=self._targets.outputs))
            self._targets.outputs = None
        self._window.stand()
        return blocks

    def end_line(self) -> Sequence[Block]:
        """Merge no point over here; the motion goes on as it was."""
        self._require_taken()
        return list(self._end_chain() or ())

    def allow_override(self, allowed: bool) -> Sequence[Block]:
        """M48 and M49: whether an override acts on the feeds of the moves from here on."""
        blocks = self.end_line()
        self._keeps_feed = self._targets.keeps_feed = not allowed
        return blocks

    def set_override(self, factor: float, rapid: float = 1.0) -> None:
        """Scale the feeds and the rapids of all segments that are not final.

        Args:
            factor: of feeds, 0.1 to 2.
            rapid: of rapids, 0.1 to 1.

        Raises:
            ValueError: if one is outside.
        """
        if not OVERRIDES[0] <= factor <= OVERRIDES[1]:
            raise ValueError("a feed override is {:g} to {:g}".format(*OVERRIDES))
        if not RAPID_OVERRIDES[0] <= rapid <= RAPID_OVERRIDES[1]:
            raise ValueError("an override of rapids is {:g} to {:g}".format(*RAPID_OVERRIDES))
        self._override = self._targets.override = factor
        self._rapid = self._targets.rapid = rapid
        self._maker.override_q8, self._maker.rapid_q8 = round(factor * Q8), round(rapid * Q8)
        self._window.set_override(factor, rapid)

    def reset(self, position_steps: Steps, slack_steps: Steps | None = None) -> None:
        """Forget what is not final: the machine stands at these axis steps.

        After a stop, a flush or a probe; modes, override and options stay.
        """
        self._begin_at(position_steps, slack_steps or self.slack_steps)

    # --- between -------------------------------------------------------------------------------

    def _begin(self, feed_mm_min: float | None) -> float:
        """Every move begins here: nothing is left over, and the feed in mm/s."""
        self._require_taken()
        if feed_mm_min is None:
            return UNLIMITED
        if not feed_mm_min > 0:
            raise ValueError("a feed is positive")
        return max(_SLOWEST_MM_S, feed_mm_min / _S_PER_MIN * self._options.rate_factor)

    def _require_taken(self) -> None:
        if self._targets.streaming:
            raise RuntimeError("the blocks of the move before were not taken")

    def _end_chain(self) -> Iterator[Block] | None:
        """Let the line go that waits; what comes is to be taken before anything else is planned."""
        chain = self._chain
        if chain.end is None:
            return None
        end_mm, chain.end = chain.end, None
        if self.tell is not None:
            self.tell(chain.tag, end_mm)
        return self._targets.go(end_mm, chain.feed_mm_s, UNLIMITED, chain.tag)
