"""From speeds along the path to a block: the one place where mm/s become ticks.

The leading axis makes ``ticks / length_mm`` ticks per mm, so squared speeds and accelerations
along the path become those of the leader by one factor.
"""

import math
from operator import mul
from typing import Final

from fraese.blocks import CYCLES_PER_S, DARK, Q8, Block, Piece, Power, few_bits
from fraese.machine import Machine
from fraese.planner.laws import Law
from fraese.planner.ramps import interval_q8, time_law
from fraese.planner.segments import KEPT, UNLIMITED, Segment
from fraese.planner.shaped import shaped_law

#: Path energy is counted in (mm / 65536 / s)**2, an integer for every machine.
WEIGHT_PER_MM2: Final = 65536**2
#: ``accel_q`` of one tick/s**2, see ``blocks.accel_q_from_hz_s``.
_ACCEL_Q: Final = Q8 * 65536 / CYCLES_PER_S
#: Rates this close are the same.
_SAME: Final = 1 + 1e-6

_sqrt = math.sqrt
_new = tuple.__new__


class BlockMaker:
    """Makes blocks of segments whose speeds are settled.

    Args:
        machine: which way the motors turn.
        law: of all ramps; None: constant acceleration.
    """

    def __init__(self, machine: Machine, law: Law | None = None) -> None:
        self._law = law
        self._signs = tuple(axis.motor_sign for axis in machine.axes)
        self._straight = all(sign == 1 for sign in self._signs)
        #: Overrides that segments are planned with, 256 for 100 %: of feeds, and of rapids.
        self.override_q8 = self.rapid_q8 = Q8

    def block(
        self, segment: Segment, entry_mm2_s2: float, cruise_mm2_s2: float, exit_mm2_s2: float
    ) -> Block:
        """The block of a segment.

        Args:
            segment: where it goes.
            entry_mm2_s2: square of the speed at its beginning,
            cruise_mm2_s2: of the speed wanted in between,
            exit_mm2_s2: and of that at its end.
        """
        ticks = segment.ticks
        per_mm = ticks / segment.length_mm
        start_hz = segment.start_mm_s * per_mm
        twice_mm_s2 = segment.twice_mm_s2
        if entry_mm2_s2 == cruise_mm2_s2 == exit_mm2_s2:
            pieces: tuple[Piece, ...] = (Piece(ticks, interval_q8(_sqrt(cruise_mm2_s2) * per_mm)),)
        else:
            squared = per_mm * per_mm
            entry_hz2, exit_hz2 = entry_mm2_s2 * squared, exit_mm2_s2 * squared
            cruise_hz2, twice_hz_s = cruise_mm2_s2 * squared, twice_mm_s2 * per_mm
            if self._law is None:
                pieces = tuple(time_law(ticks, entry_hz2, cruise_hz2, exit_hz2, twice_hz_s))
            else:
                pieces = tuple(
                    shaped_law(self._law, ticks, entry_hz2, cruise_hz2, exit_hz2, twice_hz_s)
                )
        steps = segment.steps
        if not self._straight:
            steps = tuple(map(mul, steps, self._signs))
        accel_q = few_bits(int(twice_mm_s2 * per_mm / 2 * _ACCEL_Q + 0.5)) or 1
        jump_rate_q8 = few_bits(int(start_hz * Q8 + 0.5))
        weight = int(WEIGHT_PER_MM2 / (per_mm * per_mm) + 0.5) or 1
        ends_at_rest = pieces[-1].last_interval_q8() * start_hz * _SAME >= CYCLES_PER_S * Q8
        watch, outputs, tag = segment.watch, segment.outputs, segment.tag
        is_rapid = segment.feed_mm_s == UNLIMITED
        if is_rapid:
            override_q8 = self.rapid_q8
        else:
            override_q8 = 0 if segment.feed_mm_s == KEPT else self.override_q8
        light, power = segment.light, DARK
        if light.share:
            at_mm_s = light.at_mm_s
            at_cycles = round(CYCLES_PER_S / (at_mm_s * per_mm)) if at_mm_s else 0
            power = Power(light.share, at_cycles)
        # Keywords cost twice as much: every value has the name of its field, see the tests.
        block: Block = _new(
            Block,
            (
                steps, pieces, accel_q, jump_rate_q8, weight, ends_at_rest, watch, outputs, tag,
                override_q8, is_rapid, power,
            ),
        )  # fmt: skip
        return block
