"""The controller: what may be asked for, what is known afterwards, and how a job ends."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_C: Final = "fraese/control/"
_T: Final = "tests/control/"
_CONTROLLER: Final = (_T + "test_controller.py",)
_HOMING: Final = (_T + "test_homing.py",)

MUTANTS: Final = (
    Mutant(
        "control/jogging: the opposite key waits its turn",
        "the cutter runs on into the clamp that somebody wanted to turn away from",
        _C + "jogging.py",
        "press.motor == hand.motor and way * hand.sign < 0:",
        "press.motor == hand.motor and way * hand.sign > 1e9:",
        tests_of(
            "control/test_jogging.py",
            "test_the_opposite_key_brakes_at_once_and_then_goes_the_other_way",
        ),
    ),
    Mutant(
        "control/jogging: presses are left out in silence",
        "the carriage is elsewhere than the presses say",
        _C + "jogging.py",
        "left_out + len(beyond) - 1",
        "0 * (left_out + len(beyond) - 1)",
        tests_of("control/test_jogging.py", "test_carriages_agree_with_what_was_pressed"),
    ),
    Mutant(
        "control/softlimits: no lower limit",
        "an axis is driven into its end",
        _C + "softlimits.py",
        "if axis.low_mm <= to_mm <= axis.high_mm and not",
        "if to_mm <= axis.high_mm and not",
        tests_of("control/test_controller.py", "test_the_limits_can_be_reached_and_not_passed"),
    ),
    Mutant(
        "control/softlimits: no upper limit",
        "an axis is driven into its end",
        _C + "softlimits.py",
        "if axis.low_mm <= to_mm <= axis.high_mm and not",
        "if axis.low_mm <= to_mm and not",
        tests_of("control/test_controller.py", "test_the_limits_can_be_reached_and_not_passed"),
    ),
    Mutant(
        "control/softlimits: unreferenced, any way is allowed",
        "an axis is driven into its end",
        _C + "softlimits.py",
        "if span_mm <= axis.travel_mm + axis.step_mm / 2:",
        "if True:",
        tests_of(
            "control/test_controller.py", "test_unreferenced_no_move_is_longer_than_the_travel"
        ),
    ),
    Mutant(
        "control/position: a reference is never lost",
        "after a stop without ramp the soft limits are in the wrong place",
        _C + "position.py",
        "self.referenced = self._without(lost, self.referenced)",
        "pass",
        tests_of(
            "control/test_controller.py", "test_stop_above_the_start_rate_takes_the_reference"
        ),
    ),
    Mutant(
        "control/position: half a turn away is near enough",
        "a motor may be pulled to the wrong step, and the position is trusted",
        _C + "position.py",
        "2 * max(span) < turn",
        "2 * max(span) <= turn",
        tests_of("control/test_asleft.py", "test_only_what_the_motors_find_back_to_is_taken"),
    ),
    Mutant(
        "control/position: the latched place is on the wrong side",
        "machine zero is off by twice the braking distance",
        _C + "position.py",
        "here - axis.motor_sign * (now - then)",
        "here + axis.motor_sign * (now - then)",
        tests_of("control/test_homing.py", "test_zero_lies_at_the_pull_off_distance"),
    ),
    Mutant(
        "control/position: an inverted motor's latched place",
        "machine zero of an inverted axis is off by twice the braking distance",
        _C + "position.py",
        "here - axis.motor_sign * (now - then)",
        "here - (now - then)",
        tests_of(
            "control/test_homing.py",
            "test_zero_lies_at_the_pull_off_distance",
            "test_every_combination_of_home_ends",
            "test_other_wirings",
        ),
    ),
    Mutant(
        "control/homing: an axis stays referenced while it is looked for",
        "a reference run that fails leaves an old zero in force",
        _C + "homing.py",
        "        self._position.lose_reference([self._machine.index(name)])\n",
        "",
        tests_of(
            "control/test_homing.py",
            "test_a_second_run_loses_the_reference_until_it_is_found_again",
        ),
    ),
    Mutant(
        "control/homing: what did not help is not undone",
        "an axis is backed off into its other end",
        _C + "homing.py",
        "        for axis, sign, distance in reversed(made):\n",
        "        for axis, sign, distance in ():\n",
        tests_of(
            "control/test_homing.py", "test_what_did_not_help_is_undone_before_the_next_is_tried"
        ),
    ),
    Mutant(
        "control/homing: a switch that does not open again is left at that",
        "machine zero is wherever the axis happened to stand",
        _C + "homing.py",
        "        if self._switches.shows(end):\n            raise HomingError(\n",
        "        if False:\n            raise HomingError(\n",
        tests_of("control/test_homing.py", "test_a_pull_off_shorter_than_the_switch_needs"),
    ),
    Mutant(
        "control/runner: a hold that is cancelled goes on first",
        "the tool moves on after a cancel",
        _C + "runner.py",
        "        if not self._cancel:\n            self._driver.resume()\n",
        "        self._driver.resume()\n",
        tests_of(
            "control/test_controller.py",
            "test_what_is_cancelled_while_it_is_held_does_not_move_first",
        ),
    ),
    Mutant(
        "control/runner: a hold is forgotten by an earlier resume",
        "the tool moves on after a hold",
        _C + "runner.py",
        "        self._resume = False\n        self._held = True\n",
        "        self._held = True\n",
        tests_of("control/test_controller.py", "test_hold_after_resume_holds"),
    ),
    Mutant(
        "control/runner: a stop that nobody asked for is no alarm",
        "the rest of the path is made from the wrong place",
        _C + "runner.py",
        "return stray or ended in (Ended.SWITCH, Ended.SILENCE)",
        "return ended in (Ended.SWITCH, Ended.SILENCE)",
        tests_of("control/test_controller.py", "test_a_stop_that_nobody_asked_for_ends_the_job"),
    ),
    Mutant(
        "control/runner: a contact is no alarm",
        "the rest of the path is made from the wrong place",
        _C + "runner.py",
        "return stray or ended in (Ended.SWITCH, Ended.SILENCE)",
        "return stray or ended is Ended.SILENCE",
        tests_of("control/test_controller.py", "test_a_contact_is_an_alarm_that_names_its_end"),
    ),
    Mutant(
        "control/runloop: outputs outlive a job that failed",
        "the spindle runs on after an alarm",
        _C + "runloop.py",
        "self._config.outputs.off_after(done=done)",
        "self._config.outputs.off_after(done=True)",
        tests_of("program/test_program.py", "test_after_a_cancel_no_spindle_runs"),
    ),
    Mutant(
        "control/motionqueue: a lost port keeps the references",
        "a position that nobody knows counts as right",
        _C + "motionqueue.py",
        "        where.lose_reference(range(len(where.machine.axes)))\n",
        "",
        tests_of(
            "control/test_controller.py",
            "test_a_port_that_goes_away_ends_the_job_and_the_references",
        ),
    ),
    Mutant(
        "control/runloop: an error need not be acknowledged",
        "motors start after an alarm that nobody has seen",
        _C + "runloop.py",
        "        if self.status is Status.ERROR:\n            raise StateError",
        "        if False:\n            raise StateError",
        tests_of(
            "control/test_controller.py",
            "test_refused_while_something_runs",
            "test_a_contact_is_an_alarm_that_names_its_end",
        ),
    ),
    Mutant(
        "control/endswitches: a closed switch is in nobody's way",
        "an axis is driven further into its end",
        _C + "endswitches.py",
        "if self.closed and not self._ignored:",
        "if False:",
        tests_of(
            "control/test_controller.py",
            "test_refused_while_something_runs",
            "test_a_switch_pressed_since_the_last_look_is_seen_before_moving",
        ),
    ),
    Mutant(
        "control/lines: the slack after a curve's corner",
        "a curve is cut the backlash off behind its second reversal",
        _C + "lines.py",
        "        slack = _difference(slack, turned)\n",
        "",
        tests_of("program/test_program.py", "test_a_frame_takes_up_backlash"),
    ),
    Mutant(
        "control/retract: the block in hand is played again from its start",
        "after a lift the tool is in the wrong place",
        _C + "motionqueue.py",
        "            blocks[0] = remainder(blocks[0], self.report.tick)\n",
        "            pass\n",
        tests_of("program/test_program.py", "test_held_the_tool_is_lifted_and_comes_back"),
    ),
    Mutant(
        "control/savedstate: a crash while moving is forgotten",
        "after a crash while moving, an old position counts as right",
        _C + "savedstate.py",
        "        elif motion is not None:\n",
        "        elif False:\n",
        tests_of(
            "control/test_savedstate.py", "test_what_ended_in_the_middle_is_shown_but_not_believed"
        ),
    ),
    Mutant(
        "control/savedstate: a damaged last record is no matter",
        "one changed byte makes the position of an hour ago a trusted one",
        _C + "savedstate.py",
        "        if not is_trusted:\n",
        "        if False:\n",
        tests_of("control/test_savedstate.py", "test_a_damaged_last_record_is_no_position"),
    ),
    Mutant(
        "control/runloop: motion is not written down first",
        "after a power cut in the first second, an old position counts as right",
        _C + "runloop.py",
        "            self._recorder.before_motion(self.runner.first())\n",
        "            pass\n",
        tests_of("ui/test_moving.py", "test_motion_is_written_down_first_and_may_be_refused"),
    ),
    Mutant(
        "control/recorder: who stopped without ramp goes on before that is written",
        "after a crash an axis that turned on is trusted",
        _C + "recorder.py",
        "        return not self._torn or self._records.durable.at_ns >= self._torn_ns\n",
        "        return True\n",
        tests_of(
            "control/test_recorder.py",
            "test_who_stopped_without_ramp_does_not_move_before_that_is_on_the_disk",
        ),
    ),
    Mutant(
        "control/recorder: what is begun within the lease need not be bounded",
        "after a crash the machine is outside of what is claimed",
        _C + "recorder.py",
        "is_fine = 0.99 * self._queue.duration_s() > self._left_s() + self._braking_s\n",
        "is_fine = True\n",
        tests_of(
            "control/test_lease.py",
            "test_only_what_can_be_played_within_the_lease_waits_for_the_disk",
        ),
    ),
    Mutant(
        "control/motionqueue: what an alarm says of the place is not kept",
        "after the step process died the record says a place to the step that nobody knows",
        _C + "motionqueue.py",
        "        where.doubt_between(why, low, high)\n",
        "",
        tests_of(
            "control/test_recorder.py",
            "test_what_made_the_steps_died_and_the_record_says_what_the_alarm_said",
        ),
    ),
    Mutant(
        "journal/store: what was damaged is taken for broken off",
        'a flipped bit in the mark "in motion" uncovers the trusted record of before',
        "fraese/journal/store.py",
        "is_trusted = other.condition is not Condition.DAMAGED or (",
        "is_trusted = True or (",
        tests_of("journal/test_store.py", "test_no_changed_byte_uncovers_another_trusted_record"),
    ),
    Mutant(
        "journal/store: a record is not synced",
        "a power cut within seconds leaves the record of before",
        "fraese/journal/store.py",
        "                sync(self._fd)\n",
        "",
        tests_of("journal/test_store.py", "test_a_record_is_on_the_disk_when_it_was_written"),
    ),
    Mutant(
        "journal/store: always the same slot",
        "a power cut while it is written leaves no record at all",
        "fraese/journal/store.py",
        "                self._slot = 1 - self._slot\n",
        "",
        tests_of("journal/test_store.py", "test_a_power_cut_leaves_the_old_record_or_the_new_one"),
    ),
    Mutant(
        "journal/lock: who has it is not looked at",
        "two programs drive one machine",
        "fraese/journal/lock.py",
        "        while not _locked(fd):\n",
        "        while False:\n",
        tests_of("journal/test_lock.py", "test_a_second_program_is_told_who_has_it"),
    ),
    Mutant(
        "control/endswitches: a jog off a switch needs no watch",
        "the way off a closed switch is no way: the axis cannot be freed",
        _C + "endswitches.py",
        "        return self.watch(closed=False, action=WatchAction.IGNORE)\n",
        "        return None\n",
        tests_of("control/test_controller.py", "test_a_contact_is_an_alarm_that_names_its_end"),
    ),
    Mutant(
        "control/endswitches: a jog further into a switch is let through",
        "an axis is driven further into its end",
        _C + "endswitches.py",
        "if End(motor, sign) in ends or End(motor, -sign) not in ends:",
        "if False:",
        tests_of(
            "control/test_controller.py",
            "test_a_contact_is_an_alarm_that_names_its_end",
            "test_a_switch_pressed_since_the_last_look_is_seen_before_moving",
        ),
    ),
    Mutant(
        "control/motionqueue: one block too few is finished",
        "a block that was played is not in the position",
        _C + "motionqueue.py",
        "range(min(len(self._queue), finished - self._finished_before))",
        "range(min(len(self._queue), finished - self._finished_before - 1))",
        ("tests/control/test_played.py",),
    ),
    Mutant(
        "control/motionqueue: one look is enough",
        "a switch that bounces is taken for open",
        _C + "motionqueue.py",
        "equal = equal + 1 if self.poll().inputs == before else 0",
        "equal = equal + 1 if self.poll() else 0",
        tests_of(
            "control/test_queue.py", "test_an_input_that_bounces_is_known_before_anything_moves"
        ),
    ),
    Mutant(
        "control/runner: the queue is shorter than the braking time",
        "a fast machine brakes for want of blocks, again and again",
        _C + "runner.py",
        "max(self._lead_s, fastest_s + 2 * self._slice_s)",
        "self._lead_s",
        tests_of(
            "control/test_queue.py",
            "test_short_lines_of_a_machine_that_brakes_slowly_never_run_dry",
        ),
    ),
    Mutant(
        "control/endswitches: what an input tells is not heard",
        "all ends are named where one input shows which they may be",
        _C + "endswitches.py",
        "            if line.stops and self._report.inputs & mask == closed:\n",
        "            if line.stops:\n",
        ("tests/control/test_switchlines.py",),
    ),
)
