"""The firmware: what is seen on the pins."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_F: Final = "firmware/"
_EVENTS: Final = "tests/bridge/test_events.py"
_PULSES: Final = ("tests/bridge/test_pulses.py",)

MUTANTS: Final = (
    Mutant(
        "firmware/player: a pause may be shorter than a pulse",
        "a drive misses pulses above its rate",
        _F + "player.c",
        "        cycles = 2UL * card.facts.pulse_cycles;\n",
        "        cycles = 1UL * card.facts.pulse_cycles;\n",
        _PULSES,
        limit_s=300,
    ),
    Mutant(
        "firmware/player: a tick that was made out is not taken back",
        "a brake in a slow feed makes a step twice",
        _F + "player.c",
        "        restore_state();\n",
        "        (void)restore_state;\n",
        (_EVENTS + "::test_a_brake_in_a_long_interval_makes_no_step_twice",),
        limit_s=300,
    ),
    Mutant(
        "firmware/player: an edge that was made out is made out again",
        "a brake in a slow feed makes a step of a minor axis twice, or leaves it out",
        _F + "player.c",
        "        player.is_made_out = true;\n",
        "        player.is_made_out = false;\n",
        (_EVENTS + "::test_a_brake_in_a_long_interval_of_clock_lines",),
        limit_s=300,
    ),
    Mutant(
        "firmware/reader: a late dry point is not looked at",
        "a queue that runs dry ends with the motors at speed",
        _F + "reader.c",
        "        wish(MAY_RUN_DRY);\n",
        "        (void)0;\n",
        (_EVENTS + "::test_a_dry_point_that_comes_when_its_block_is_in_hand_counts",),
        limit_s=300,
    ),
    Mutant(
        "firmware/throttle: a dry point is not looked at",
        "a queue that runs dry ends with the motors at speed",
        _F + "throttle.c",
        "        wish(MAY_RUN_DRY);\n",
        "        (void)0;\n",
        (_EVENTS + "::test_running_dry_brakes_on_a_ramp",),
        limit_s=300,
    ),
    Mutant(
        "firmware/throttle: held at twice the start/stop rate",
        "a brake stops the motors dead at speed",
        _F + "throttle.c",
        "if (!last || slowest >= throttle.jump_cycles)",
        "if (!last || slowest >= throttle.jump_cycles / 2)",
        (_EVENTS + "::test_brake_and_resume",),
        limit_s=300,
    ),
    Mutant(
        "firmware/run: nobody is torn",
        "after a stop without ramp the position still counts as right",
        _F + "run.c",
        "    run.torn = true;\n",
        "    run.torn = false;\n",
        (_EVENTS + "::test_stop_finishes_the_tick_in_hand",),
        limit_s=300,
    ),
    Mutant(
        "firmware/run: a silent host is waited for",
        "the motors run on when the program hangs",
        _F + "run.c",
        "return silence_cycles && run.now - run.life >= silence_cycles;",
        "return false;",
        (
            "tests/bridge/test_driver.py::TestLives::test_a_host_that_says_nothing_is_taken_for_hung",
        ),
        limit_s=300,
    ),
    Mutant(
        "firmware/run: the laser is wanted again after a stop",
        "the laser comes on with the next jog",
        _F + "run.c",
        "        card_forget_safe_outputs();\n",
        "",
        tests_of("bridge/test_driver.py", "TestLaser"),
        limit_s=300,
    ),
    Mutant(
        "firmware/reader: a block of the wrong length is played",
        "a damaged block makes fewer steps than it says",
        _F + "reader.c",
        "(is_last && !is_whole)",
        "(is_last && !is_whole && false)",
        tests_of("bridge/test_device.py", "test_a_block_that_does_not_add_up_stops_the_run"),
        limit_s=300,
    ),
)
