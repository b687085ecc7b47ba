"""The app: the stop key, what is announced before motion, a terminal that goes away."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_U: Final = "fraese/ui/"

MUTANTS: Final = (
    Mutant(
        "app/link: the second stop brakes once more",
        "who presses the stop key twice waits for the ramp all the same",
        _U + "machinelink.py",
        "            self._worker.stop()\n",
        "            self._worker.cancel()\n",
        tests_of("ui/test_moving.py", "test_second_stop_is_without_ramp"),
    ),
    Mutant(
        "app/app: the stop key does not reach the motors",
        "the stop key does nothing",
        _U + "app.py",
        "            moving = self.link.brake_or_stop()\n",
        "            moving = self.link.moving\n",
        tests_of("ui/test_moving.py", "test_stop_brakes_and_drops_what_waits"),
    ),
    Mutant(
        "app/app: what began after the stop key was heard goes on",
        "a jog that was pressed just before the stop key is made after it",
        _U + "app.py",
        "            if not (self._heard.moving and self.link.question):\n",
        "            if False:\n",
        tests_of(
            "ui/test_stopkey.py",
            "test_what_was_pressed_before_it_does_not_move_for_long",
            "test_what_was_ordered_before_it_and_has_not_begun_never_moves",
        ),
    ),
    Mutant(
        "app/app: keys that the stop key overtook are done after it",
        "a jog or start that was pressed just before the stop key is made after it",
        _U + "app.py",
        "                if event.time < self._stopped_s:\n",
        "                if False:\n",
        tests_of(
            "ui/test_stopkey.py", "test_what_was_pressed_before_it_and_comes_later_is_not_done"
        ),
    ),
    Mutant(
        "app/terminal: one that goes away is not told of",
        "the machine runs on with nobody at a stop key",
        _U + "terminal.py",
        "        app.terminal_is_gone()\n",
        "        pass\n",
        tests_of(
            "ui/test_terminal.py",
            "test_a_terminal_that_goes_away_without_a_signal_ends_the_app_too",
        ),
    ),
)
