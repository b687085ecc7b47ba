"""What a sender may and may not bring about."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_S: Final = "fraese/serve/"
_PROTOCOL: Final = "serve/test_protocol.py"
_DOORS: Final = "serve/test_doors.py"

MUTANTS: Final = (
    Mutant(
        "serve/session: who goes away stops nothing",
        "the mill moves on for a computer that has crashed",
        _S + "session.py",
        "            self._at_once.stop()\n",
        "            pass\n",
        tests_of(_PROTOCOL, "test_who_goes_away_while_it_moves_stops_it"),
    ),
    Mutant(
        "serve/session: a reset in motion does not lock",
        "lines of a program that was broken off move the machine",
        _S + "session.py",
        "        if self._wishes.was_moving:\n            self._lock(",
        "        if False:\n            self._lock(",
        tests_of(_PROTOCOL, "test_a_reset_in_motion_brakes_and_locks"),
    ),
    Mutant(
        "serve/session: a locked machine takes lines",
        "it moves after an alarm that nobody has taken note of",
        _S + "session.py",
        "if kind is not Kind.EMPTY and self.modes.alarm:",
        "if kind is Kind.JOG and self.modes.alarm:",
        tests_of(_PROTOCOL, "test_a_reset_in_motion_brakes_and_locks"),
    ),
    Mutant(
        "serve/session: who has taken over is not obeyed",
        "a sender moves the machine under a person's hands",
        _S + "session.py",
        "        if self.modes.out and kind is not Kind.EMPTY:",
        "        if self.modes.out and kind is Kind.JOG:",
        tests_of(_PROTOCOL, "test_who_has_taken_over_is_not_disturbed"),
    ),
    Mutant(
        "serve/atonce: a sender lets go on what somebody else has held",
        "the program of a person goes on under his hands",
        _S + "atonce.py",
        "        if not self._modes.held and self._modes.doing is Doing.NOTHING:\n",
        "        if False:\n",
        tests_of(_PROTOCOL, "test_a_sender_lets_nothing_go_on_that_somebody_else_has_held"),
    ),
    Mutant(
        "serve/codes: no alarm asks for a reset",
        "what follows a move beyond the travel is carried out",
        _S + "codes.py",
        "frozenset({Alarmed.HARD_LIMIT, Alarmed.SOFT_LIMIT})",
        "frozenset()",
        tests_of(_PROTOCOL, "test_beyond_the_travel_is_a_soft_limit"),
    ),
    Mutant(
        "serve/feeder: a dwell is answered at once",
        "a sender believes that the mill stands, and it moves",
        _S + "feeder.py",
        "self._syncs or type(move) is canon.Dwell",
        "self._syncs",
        tests_of(_PROTOCOL, "test_a_dwell_is_answered_when_it_is_over"),
    ),
    Mutant(
        "program/stream: what is held back is let go with every line that is late",
        "a stream stops at its corners",
        "fraese/program/stream.py",
        "return self._lines.is_dry() and self._controller.spare_s() < _SPARE_S",
        "return True",
        tests_of(_PROTOCOL, "test_a_slow_sender_flows_through_its_corners_too"),
    ),
    Mutant(
        "serve/access: everybody is admitted",
        "anybody on the network moves the machine",
        _S + "access.py",
        "return there.is_loopback or any(",
        "return True or any(",
        tests_of(_DOORS, "test_who_is_admitted_by_his_address"),
    ),
    Mutant(
        "config/serving: an open port needs no reason",
        "anybody on the network moves the machine",
        "fraese/config/serving.py",
        "            if not is_here(host):\n",
        "            if False:\n",
        tests_of(_DOORS, "test_what_would_let_everybody_in_is_refused"),
    ),
)
