"""Programs and their language: what would be cut, or started, in the wrong place."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_P: Final = "fraese/program/"

MUTANTS: Final = (
    Mutant(
        "program/visit: back to the place of the machine",
        "a longer tool is driven into the work",
        "fraese/program/visit.py",
        "if vertical is None or not self.changed:",
        "if True:",
        tests_of(
            "program/test_visit.py",
            "test_a_longer_tool_is_touched_off_and_the_program_goes_on_with_it",
        ),
    ),
    Mutant(
        "program/visit: what was touched off is forgotten by the program",
        "a longer tool mills too deep from then on",
        "fraese/program/visit.py",
        "parameters=dict(self.changed)",
        "parameters={}",
        tests_of("program/test_visit.py", "test_the_deepest_place_is_that_of_the_new_tool"),
    ),
    Mutant(
        "program/survey: what leaves the travel upwards is no warning",
        "a program is started that drives an axis into its end",
        _P + "survey.py",
        "                if high[i] > before_mm:\n",
        "                if False:\n",
        tests_of(
            "program/test_program.py", "test_a_program_that_leaves_the_travel_is_refused_by_line"
        ),
    ),
    Mutant(
        "program/survey: a run is not guarded",
        "what a probe led to is driven into an end",
        _P + "survey.py",
        "            if self.outside:\n",
        "            if False:\n",
        tests_of(
            "program/test_program.py",
            "test_without_the_look_through_limits_count_all_the_same",
            "test_a_program_may_find_its_limits_only_while_it_runs",
        ),
    ),
    Mutant(
        "program/runfromline: tool, spindle and coolant are not repeated",
        "the tool goes down into the work with the spindle off",
        _P + "runfromline.py",
        "        if kind in kept:\n",
        "        if False:\n",
        tests_of("program/test_program.py", "test_from_a_line_repeats_spindle_and_tool"),
    ),
    Mutant(
        "program/runfromline: straight over instead of up first",
        "the tool goes through the work",
        _P + "runfromline.py",
        "            canon.Rapid(line, top.at(self.now.start_mm)),\n",
        "",
        tests_of("program/test_program.py", "test_from_a_line_starts_with_what_was_in_force"),
    ),
    Mutant(
        "program/runfromline: a beam is on during the way",
        "the laser burns a line over the work",
        _P + "runfromline.py",
        "        if self.now.has_laser:\n",
        "        if False:\n",
        tests_of("program/test_laser.py", "test_off_on_the_way_to_a_line_and_on_from_there"),
    ),
    Mutant(
        "program/numbers: the way to a line is counted as moves",
        "a second start in the middle begins at another move",
        _P + "numbers.py",
        "        self.pass_by()\n        self.stride = 0\n",
        "        self.pass_by()\n",
        tests_of(
            "program/test_program.py",
            "test_a_program_from_a_line_has_the_numbers_of_the_whole_one",
        ),
    ),
    Mutant(
        "program/offsethistory: what was only read counts",
        "after a cancel the work zero is that of another clamping",
        _P + "offsethistory.py",
        "passed = sum(blocks <= finished for blocks, _ in entries[1:])",
        "passed = len(entries) - 1",
        tests_of("program/test_program.py", "test_a_work_zero_moves_when_the_motors_come_to_it"),
    ),
    Mutant(
        "program/touch: after a probe the planner goes on from its target",
        "everything after a probe is cut too deep",
        _P + "touch.py",
        "        self._planner.reset(where.position_steps, where.slack_steps)\n",
        "",
        tests_of(
            "program/test_program.py", "test_probe_against_the_shared_switch_and_go_away_again"
        ),
    ),
    Mutant(
        "program/touch: a probe that touches already is moved",
        "the probe is broken",
        _P + "touch.py",
        "if switches.probe_closed == move.until_closed:",
        "if False:",
        tests_of("program/test_program.py", "test_probes_that_fail_say_so"),
    ),
    Mutant(
        "program/touch: after a probe any move is let through",
        "the probe is broken",
        _P + "touch.py",
        "        if further_in:\n",
        "        if False:\n",
        tests_of("program/test_program.py", "test_after_a_probe_nothing_goes_further_in"),
    ),
    Mutant(
        "config/axis: a start/stop rate above the highest rate",
        "motors are started faster than they can turn",
        "fraese/config/axis.py",
        "if self.start_rate_hz > self.max_rate_hz:",
        "if False:",
        ("tests/config/test_config.py",),
    ),
    Mutant(
        "program/runfromline: over to the line below its own height",
        "the tool goes through the work on the way to a line above the safe height",
        _P + "runfromline.py",
        "top = height.at_least(at[height.axis])",
        "top = height",
        tests_of("program/test_more_axes.py", "test_from_a_line_the_way_is_never_below_the_place"),
    ),
    Mutant(
        "planner/targets: M49 is no protection from the override",
        "a tap or a probe is slowed down or hurried against the program's word",
        "fraese/planner/targets.py",
        "        if self.keeps_feed and feed_mm_s != UNLIMITED:\n",
        "        if False:\n",
        tests_of(
            "program/test_program.py",
            "test_m49_holds_the_feed_against_an_override_that_comes_while_it_moves",
        ),
    ),
    Mutant(
        "program/userwords: a program of one's own outlives a cancel",
        "what M101 has started goes on while the operator reaches into the machine",
        "fraese/program/userwords.py",
        "            _end(process)\n",
        "            process.poll()\n",
        ("tests/program/test_userwords.py",),
    ),
)
