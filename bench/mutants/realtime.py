"""The step process: a host that is dead or silent, a child that is dead, blocks pushed in vain."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_R: Final = "fraese/motor/realtime/"
_PLAYER: Final = "tests/realtime/test_player.py"

MUTANTS: Final = (
    Mutant(
        "realtime/chores: a dead host is not followed",
        "the motors run on after the app has crashed",
        _R + "chores.py",
        "            self.leave()\n        moves",
        "            pass\n        moves",
        (_PLAYER + "::TestHost::test_a_dead_host_brakes_the_motors_and_the_child_leaves",),
        limit_s=60,
    ),
    Mutant(
        "realtime/chores: a silent host is no reason to brake",
        "the motors run on when the app hangs",
        _R + "chores.py",
        "            if moves:\n                self.brake()\n",
        "",
        (_PLAYER + "::TestHost::test_a_silent_host_brakes_the_motors_and_switches_them_off",),
    ),
    Mutant(
        "realtime/chores: a lease that is over is no reason to brake",
        "after a crash the machine is outside of what is claimed",
        _R + "chores.py",
        "        is_over = 0 < lease_ns < now_ns\n",
        "        is_over = False\n",
        ("tests/realtime/test_lease.py",),
    ),
    Mutant(
        "realtime/chores: a lease that is put off ends a hold",
        "the motors start again though somebody holds them",
        _R + "chores.py",
        "            self._host_brakes, self._lapsed = True, False\n",
        "",
        ("tests/realtime/test_lease.py::test_what_the_host_has_braked_stays_so",),
    ),
    Mutant(
        "realtime/chores: blocks of ignorance are played",
        "motors start again after a contact",
        _R + "chores.py",
        "if decoder.generation == self.reporter.generation:",
        "if True:",
        (_PLAYER + "::TestIgnorance",),
    ),
    Mutant(
        "realtime/chores: an answer before the stop was acted on",
        "what the app does after a stop is done in ignorance of it",
        _R + "chores.py",
        "if self._is_dropping() or self.has_wish():",
        "if False:",
        tests_of("realtime/test_player.py", "TestWishes::test_an_answer_after_a_stop_knows_of_it"),
    ),
    Mutant(
        "realtime/chores: a stop is only taken up in the next gap",
        "a stop waits for a slow tick",
        _R + "chores.py",
        "return urgent and self._is_within_a_block()",
        "return False",
        tests_of(
            "realtime/test_player.py", "TestWishes::test_a_stop_does_not_wait_for_a_slow_tick"
        ),
    ),
    Mutant(
        "realtime/player: a run that ended early makes no new generation",
        "motors start again after a contact",
        _R + "player.py",
        "        if plays and dropped:\n            chores.reporter.generation += 1\n",
        "",
        (_PLAYER + "::TestIgnorance",),
    ),
    Mutant(
        "realtime/player: current stays on after the host's silence",
        "motors under current in a machine that nobody looks after",
        _R + "player.py",
        "            self._core.idle(IdleLevel.OFF)\n",
        "",
        tests_of(
            "realtime/test_player.py",
            "TestHost::test_a_silent_host_brakes_the_motors_and_switches_them_off",
        ),
    ),
    Mutant(
        "realtime/player: outputs stay on after the host's silence",
        "the spindle runs on when the app hangs",
        _R + "player.py",
        "            self._core.set_outputs(ALL_OUTPUTS, 0)\n",
        "",
        tests_of("realtime/test_player.py", "TestHost::test_silence_switches_every_output_off"),
    ),
    Mutant(
        "realtime/rescue: the bytes are written once",
        "a child that died with the strobe set leaves a motor under current",
        _R + "rescue.py",
        "_TIMES: Final = 2",
        "_TIMES: Final = 1",
        tests_of("realtime/test_rescue.py", "test_a_child_may_die_between_any_two_writes"),
    ),
    Mutant(
        "realtime/driver: after the death of a child nobody is torn",
        "a position that nobody knows counts as right",
        _R + "driver.py",
        "torn=frozenset(range(self._motors)) if untouched else report.torn,",
        "torn=report.torn,",
        ("tests/realtime/test_lives.py::TestDeathOfTheChild",),
        limit_s=180,
    ),
    Mutant(
        "realtime/session: a child that hangs is waited for",
        "the app hangs with a stop in its queue",
        _R + "session.py",
        "            if waited_s > self._hung_s:\n",
        "            if False:\n",
        ("tests/realtime/test_lives.py::TestDeathOfTheChild::test_a_child_that_hangs_is_killed",),
        limit_s=60,
    ),
    Mutant(
        "realtime/report: motors that come to rest stand",
        "what needs standstill is begun while steps are made",
        _R + "report.py",
        "running=bool(flags & _MAY_PLAY) or not flags & _STANDING,",
        "running=bool(flags & _MAY_PLAY),",
        tests_of(
            "realtime/test_player.py", "TestPlaying::test_motors_run_until_the_last_pulse_has_ended"
        ),
    ),
    Mutant(
        "realtime/process: a parent that ends does not wait for its child's motors",
        "after Ctrl-C the motors stay on when the step process died in the same moment",
        _R + "process.py",
        "        self._pipe.close()\n        self._buried.wait(_BURIAL_S)\n",
        "        self._pipe.close()\n",
        tests_of("realtime/test_lives.py", "TestDeathOfTheHost"),
    ),
    Mutant(
        "realtime/driver: what an earlier step process left stays",
        "after a crash the place is that of the step process before the last",
        _R + "driver.py",
        "            os.ftruncate(words.fd, 0)\n",
        "            pass\n",
        tests_of("realtime/test_lastwords.py", "TestKilledHost"),
    ),
    Mutant(
        "realtime/child: one that has not moved is sure of its place",
        "after two crashes a place that is known to a tick only is trusted",
        _R + "child.py",
        "    is_unsure = bool(to.base_steps) and not any(track.travelled_steps())\n",
        "    is_unsure = False\n",
        tests_of("realtime/test_lastwords.py", "TestKilledHost"),
    ),
    Mutant(
        "realtime/session: a machine that stood still blames the child",
        "the position is lost because the host was busy",
        _R + "session.py",
        "waited_s += min(looked_s - before_s, _HELD_UP_S)",
        "waited_s += looked_s - before_s",
        tests_of("realtime/test_lives.py", "TestDeathOfTheChild"),
    ),
)
