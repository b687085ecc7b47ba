"""The planner: what motors cannot follow, and what would be cut in the wrong place."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_P: Final = "fraese/planner/"
_T: Final = "tests/planner/"
_PLANNER: Final = (_T + "test_planner.py",)

MUTANTS: Final = (
    Mutant(
        "planner/segments: the faster side of a corner counts",
        "an axis is accelerated harder than it can follow along a curve of short lines",
        _P + "segments.py",
        "slow = min(before.start_mm_s, after.start_mm_s)",
        "slow = max(before.start_mm_s, after.start_mm_s)",
        (_T + "test_corners.py",),
    ),
    Mutant(
        "planner/segments: slow corners are slowed down further",
        "a curve of short lines crawls, and burns the edge",
        _P + "segments.py",
        "limit = min(limit, max(curve, slow * slow))",
        "limit = min(limit, min(curve, slow * slow))",
        (_T + "test_corners.py",),
    ),
    Mutant(
        "planner/segments: a turning path is no acceleration",
        "motors lose steps along a curve of short lines",
        _P + "segments.py",
        "        if curve < limit:\n",
        "        if False:\n",
        (_T + "test_corners.py",),
    ),
    Mutant(
        "planner/segments: an axis that turns round starts at full start rate",
        "a motor is reversed faster than it can follow",
        _P + "segments.py",
        "math.copysign(was * exit_mm_s, was * now)",
        "abs(was * exit_mm_s)",
        tests_of(
            "planner/test_planner.py",
            "test_nor_with_everything_that_can_come_in_between",
            "test_turning_back_divides_the_start_rate_between_both_sides",
        ),
    ),
    Mutant(
        "planner/lookahead: the end of the window need not be at rest",
        "a program that ends, or waits, leaves the motors at speed",
        _P + "lookahead.py",
        "speed = min(segments[last].rest_mm_s ** 2, self._cruise[last])",
        "speed = self._cruise[last]",
        tests_of("planner/test_planner.py", "test_drain_gives_all_and_goes_on_from_rest"),
    ),
    Mutant(
        "planner/lookahead: exact stop is none",
        "G61 rounds corners",
        _P + "lookahead.py",
        "corner = min(corner, before.rest_mm_s**2, segment.rest_mm_s**2)",
        "pass",
        tests_of(
            "planner/test_planner.py", "test_exact_stop_never_passes_a_corner_above_the_start_rate"
        ),
    ),
    Mutant(
        "planner/ramps: no crest",
        "motors are torn from acceleration into braking",
        _P + "ramps.py",
        "CREST_TICKS: Final = 4",
        "CREST_TICKS: Final = 0",
        tests_of("planner/test_ramps.py", "test_a_short_move_has_a_crest_of_constant_rate"),
    ),
    Mutant(
        "planner/ramps: intervals are rounded to the faster side",
        "a rate is a little above the highest one",
        _P + "ramps.py",
        "return min(_LONGEST_Q8, math.ceil(UNITS_PER_S / rate_hz))",
        "return min(_LONGEST_Q8, math.floor(_UNITS_PER_S / rate_hz))",
        tests_of("planner/test_ramps.py", "test_a_rate_is_played_no_faster_than_it_was_meant"),
    ),
    Mutant(
        "planner/ramps: a feed lowered on the way is leapt to",
        "motors lose steps when the override is turned down",
        _P + "ramps.py",
        "    if entry_hz2 > cruise_hz2:\n        return _brake_first",
        "    if False:\n        return _brake_first",
        tests_of("planner/test_ramps.py", "test_entered_too_fast_it_brakes_first_and_then_cruises"),
    ),
    Mutant(
        "planner/backlash: taken up on the wrong side",
        "every reversal is cut twice the backlash off",
        _P + "backlash.py",
        "return slack_steps - backlash_steps if direction else 0",
        "return -slack_steps if direction else 0",
        tests_of("planner/test_backlash.py", "test_after_the_take_up_every_motor_step_is_a_step"),
    ),
    Mutant(
        "planner/backlash: the slack has no end",
        "the position is the motor's, not the carriage's",
        _P + "backlash.py",
        "min(max(slack_steps - motor_steps, 0), backlash_steps)",
        "max(slack_steps - motor_steps, 0)",
        tests_of(
            "planner/test_backlash.py", "test_the_carriage_follows_with_play_and_stays_within_it"
        ),
    ),
    Mutant(
        "planner/rounding: near a boundary the float decides",
        "the same coordinate is another step in another place",
        _P + "rounding.py",
        "_MARGIN_STEPS: Final = 1e-6",
        "_MARGIN_STEPS: Final = 0.0",
        tests_of(
            "planner/test_rounding.py", "test_where_the_float_product_lands_on_the_wrong_side"
        ),
    ),
    Mutant(
        "planner/targets: a long move is cut short",
        "a part of a long line is left out",
        _P + "targets.py",
        "(2 * n * at + ticks) // (2 * ticks)",
        "(2 * n * at - ticks) // (2 * ticks)",
        tests_of(
            "planner/test_planner.py",
            "test_long_lines_are_cut_in_time_but_not_slowed_down",
            "test_a_long_slow_line_is_planned_while_it_is_taken_and_an_override_acts_on_the_rest",
        ),
    ),
    Mutant(
        "planner/lines: a line by hand has no ramp's foot",
        "the first step of a jog is faster than the start/stop rate",
        _P + "lines.py",
        "return self.start_hz - self.acceleration_hz_s / (2 * self.start_hz)",
        "return self.start_hz * 1.5",
        tests_of(
            "planner/test_ramps.py", "test_straight_moves_take_hardly_longer_than_the_optimum"
        ),
    ),
    Mutant(
        "planner/laws: a sine is taken to reach as far as constant acceleration",
        "a ramp comes to half as much again as the axes can follow, and steps are lost",
        _P + "laws.py",
        "return rate2 + self.mean * twice * way",
        "return rate2 + twice * way",
        (_T + "test_laws.py",),
    ),
    Mutant(
        "planner/shapedwindow: ramps are cut like any line",
        "the acceleration goes to nothing twenty times a second: the machine hums and shakes",
        _P + "shapedwindow.py",
        "return _MORE * max(self._law.way(low, wanted, segment.twice_mm_s2) for low in lows)",
        "return 0.0 * max(self._law.way(low, wanted, segment.twice_mm_s2) for low in lows)",
        (_T + "test_laws.py",),
    ),
)
