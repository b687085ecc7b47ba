r"""From points in millimetres to segments in steps.

    point --> rounding --> backlash --> segment --> window
              absolute     take-up      cut where it is long

Rule 1: targets are rounded once and absolutely; a segment's steps are the difference of two.
Rule 2: a move of no steps vanishes. What it was short of a step waits for the next one, and so do
        its outputs.
Rule 3: a long move is cut in step space, each cut the step nearest to the line. The parts follow
        one by one while blocks are taken: so an override acts on what was not taken.
"""

import math
from collections.abc import Iterator
from operator import sub
from typing import Final, NamedTuple

from fraese.blocks import Block, Outputs, Watch
from fraese.machine import Machine, Steps
from fraese.planner.arcs import Point
from fraese.planner.backlash import followed, take_up
from fraese.planner.lookahead import Window
from fraese.planner.rounding import point_rounder
from fraese.planner.segments import KEPT, NO_LIGHT, UNLIMITED, Light, Limits, Segment

#: Parts that differ by less are as many.
_SAME: Final = 1e-9


class Beam(NamedTuple):
    """A lamp as a program has it.

    Attributes:
        share: of its full power.
        per_feed: it has that share at so many times the feed, and less below it; 0: always.
    """

    share: int = 0
    per_feed: float = 0.0


NO_BEAM: Final = Beam()


class Targets:
    """Where the path has come to, and the way to the next point.

    Args:
        machine: conversions and backlash.
        limits: of the machine.
        window: takes the segments.
        max_block_s: longer moves are cut.
        position_steps: where the axes are.
        slack_steps: of their backlash.

    Attributes:
        reached_steps: axis steps at the end of the last segment.
        slack_steps: slack of the axes there.
        outputs: change that waits for a segment.
        beam: of a lamp, along what is planned now.
        exact_stop: the next corner is passed no faster than the start/stop rates.
        override: factor of feeds; only to know what is a long move.
        rapid: factor of rapids, likewise.
        keeps_feed: no override acts on what is planned now.
        streaming: a long move is on its way, and not all of its blocks were taken.
    """

    def __init__(
        self,
        machine: Machine,
        limits: Limits,
        window: Window,
        max_block_s: float,
        position_steps: Steps,
        slack_steps: Steps,
    ) -> None:
        self._limits = limits
        self._window = window
        self._max_block_s = max_block_s
        self._to_steps = point_rounder(machine.axes)
        self._are_three = len(machine.axes) == 3
        self._backlash_steps = tuple(axis.backlash_steps for axis in machine.axes)
        self._has_backlash = any(self._backlash_steps)
        self._reached_mm = machine.to_mm(position_steps)
        self.reached_steps = position_steps
        self.slack_steps = slack_steps
        self.outputs: Outputs | None = None
        self.beam = NO_BEAM
        self.exact_stop = False
        self.override = self.rapid = 1.0
        self.keeps_feed = False
        self.streaming = False

    def go(
        self,
        to_mm: Point,
        feed_mm_s: float,
        top_mm_s: float,
        tag: int,
        watch: Watch | None = None,
    ) -> Iterator[Block] | None:
        """Round the target, take up backlash, and hand the move to the window.

        Args:
            to_mm: the next point.
            feed_mm_s: wanted speed, infinite for a rapid.
            top_mm_s: never faster (a curve).
            tag: for reports.
            watch: condition while it plays; such a move is not cut.

        Returns:
            For a long move its blocks, to be taken before anything else is planned; else None.
        """
        there = self._to_steps(to_mm)
        at = self.reached_steps
        if there == at:
            return None
        beam, light = self.beam, NO_LIGHT
        if beam.share and feed_mm_s != UNLIMITED:
            light = Light(beam.share, feed_mm_s * beam.per_feed)
        if self.keeps_feed and feed_mm_s != UNLIMITED:
            feed_mm_s, top_mm_s = KEPT, min(feed_mm_s, top_mm_s)
        if self._are_three:
            # What most machines have, and every line of a program comes by: written out.
            x, y, z = there
            u, v, w = at
            steps: Steps = (x - u, y - v, z - w)
            x_mm, y_mm, z_mm = to_mm
            u_mm, v_mm, w_mm = self._reached_mm
            way_mm: Point = (x_mm - u_mm, y_mm - v_mm, z_mm - w_mm)
        else:
            steps, way_mm = tuple(map(sub, there, at)), tuple(map(sub, to_mm, self._reached_mm))
        self.reached_steps = there
        self._reached_mm = to_mm
        if self._has_backlash:
            self._take_up(steps, tag, watch)
        outputs = self.outputs
        segment = self._limits.segment(
            steps, way_mm, feed_mm_s, top_mm_s, outputs, tag, watch, light
        )
        if outputs is not None:
            self.outputs = None
        uncut_mm = max(self._longest_mm(segment), 2 * self._window.ramp_mm(segment))
        if watch is None and segment.length_mm > uncut_mm:
            self.streaming = True
            return self._in_parts(segment, way_mm)
        self._window.append(segment, self.exact_stop)
        return None

    def _longest_mm(self, segment: Segment) -> float:
        """How far it goes in a block, as fast as it is wanted now."""
        feed_mm_s = segment.feed_mm_s
        factor = self.rapid if feed_mm_s == UNLIMITED else 1.0
        fastest_mm_s = min(abs(feed_mm_s) * self.override, segment.top_mm_s * factor)
        return fastest_mm_s * self._max_block_s

    def _in_parts(self, whole: Segment, way_mm: Point) -> Iterator[Block]:
        done: Steps = (0,) * len(whole.steps)
        exact_stop, outputs, window = self.exact_stop, whole.outputs, self._window
        ticks, at = whole.ticks, 0
        while at < ticks:
            before, at = at, at + self._part(whole, at)
            there = tuple([(2 * n * at + ticks) // (2 * ticks) for n in whole.steps])
            steps = tuple(map(sub, there, done))
            done = there
            part_mm = tuple([mm * (at - before) / ticks for mm in way_mm])
            segment = self._limits.segment(
                steps, part_mm, whole.feed_mm_s, whole.top_mm_s, outputs, whole.tag,
                light=whole.light,
            )  # fmt: skip
            window.append(segment, exact_stop)
            exact_stop, outputs = False, None
            if window.due:
                yield from window.settle()
        self.streaming = False

    def _part(self, whole: Segment, at: int) -> int:
        """Ticks of the next part of a long line, after so many of them.

        Equal parts of what is left; an override that has changed since makes other ones. A ramp of
        a law that is not to be cut is a part of its own, at the beginning and at the end.
        """
        ticks = whole.ticks
        ramp = math.ceil(self._window.ramp_mm(whole) / whole.length_mm * ticks)
        if ramp and not at:
            return min(ramp, ticks)
        left = ticks - at
        if ramp and left <= ramp:
            return left
        left -= ramp
        share = self._longest_mm(whole) / whole.length_mm
        parts = min(left, math.ceil(left / (ticks * share) - _SAME))
        return -(-left // max(1, parts))

    def _take_up(self, steps: Steps, tag: int, watch: Watch | None) -> None:
        """Before axes turn round, the steps that only their motors make."""
        slack, backlash = self.slack_steps, self._backlash_steps
        extra = tuple(map(take_up, slack, backlash, steps))
        if any(extra):
            segment = self._limits.segment(extra, None, UNLIMITED, UNLIMITED, None, tag, watch)
            self._window.append(segment, self.exact_stop)
            self.slack_steps = tuple(
                followed(*each)[1] for each in zip(slack, backlash, extra, strict=True)
            )
