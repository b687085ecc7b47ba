"""Lines for the job that runs: one after the other, each answered when it has been taken over.

    inbox --line--> interpreter, planner --asks for the next one--> "ok" of this one

Rule 1: a line is answered in its turn and once: ``ok`` when the planner takes its move, or with
        what is wrong. Of G4 it is ``ok`` when the motors stand and have waited, as a grbl has it.
Rule 2: what is said while it moves and belongs to a standstill is refused at once. At rest it ends
        the job, and is done then.
Rule 3: after the last line the job waits for a while at rest: the motors keep their current, and a
        line that comes soon does not have to start anew.
"""

from collections.abc import Callable
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.phrases import phrase
from fraese.program.stream import NOT_YET
from fraese.serve.codes import Code, code_of
from fraese.serve.inbox import Inbox, Sent
from fraese.serve.kinds import Kind, kind_of, why_not
from fraese.serve.modes import Modes
from fraese.serve.receiver import MOST

#: How long a line is waited for: while nothing moves, and while the run loop must not wait.
_PATIENCE_AT_REST_S: Final = 0.02
_PATIENCE_S: Final = 0.002
#: After so many lines it is the run loop's turn.
_A_TURN: Final = 100
#: Moves with which a line is through, as far as its sender is concerned.
_TAKEN: Final = frozenset({canon.Rapid, canon.Feed, canon.Arc})
#: How long a job without lines stays.
_LINGER_S: Final = 0.25


class Feeder:
    """Lines of one kind, for one job after the other.

    Args:
        inbox: where they wait.
        modes: told whether the job rests.
        answer: told what to answer to a line: it, the number, and what else is to be said.
        inline: does what may be done at any time; False: that is not it.
        at_rest: all that was planned has been made.
        now_s: a clock of people's time.
        linger_s: how long a job without lines stays.
    """

    def __init__(
        self,
        inbox: Inbox,
        modes: Modes,
        answer: Callable[[Sent, Code, str], object],
        inline: Callable[[Sent], bool],
        at_rest: Callable[[], bool],
        now_s: Callable[[], float],
        linger_s: float = _LINGER_S,
    ) -> None:
        self._inbox = inbox
        self._modes = modes
        self._answer = answer
        self._inline = inline
        self._at_rest = at_rest
        self._now_s = now_s
        self._linger_s = linger_s
        self._kind = Kind.CODE
        self._open: Sent | None = None
        self._refused: ProgramError | None = None
        self._syncs = self._dry = self._is_others = False
        self._count = 0
        self._dry_since_s: float | None = None
        #: Told of what a line has led to, besides the answer.
        self.report: Callable[[canon.Move, canon.Facts | None], object] = lambda move, facts: None

    def begin(self, kind: Kind) -> None:
        """A job for lines of this kind."""
        self._kind = kind
        self._is_others = self._dry = False
        self._dry_since_s, self._count = None, 0

    def drop(self) -> None:
        """The line in hand is not answered any more."""
        self._open = self._refused = None
        self._syncs = False

    # --- as ``stream.Lines`` ---------------------------------------------------------------------

    def next(self) -> str:
        """The next line, or ``NOT_YET``."""
        if self._syncs:
            self._dry = True
            if not self._at_rest():
                return NOT_YET
            # Who hears that it is over asks, and hears so.
            self._modes.resting = True
        self.close()
        return self._next()

    def refused(self, error: ProgramError) -> None:
        """What is wrong with the line in hand."""
        self._refused = error

    def leads_to(self, move: canon.Move) -> None:
        """The planner is about to take this; a long move is in its hands for long."""
        if type(move) in _TAKEN and self._refused is None:
            self.close()

    def saw(self, move: canon.Move, facts: canon.Facts | None) -> None:
        """What the line in hand has led to."""
        self._syncs = self._syncs or type(move) is canon.Dwell
        self.report(move, facts)

    def ended(self) -> None:
        """The program is over."""
        self.close()

    def is_dry(self) -> bool:
        """There was no line."""
        return self._dry

    def is_over(self) -> bool:
        """Nothing comes for now."""
        if not self._dry or self._syncs or not self._at_rest():
            self._dry_since_s = None
            return False
        self._modes.resting = True
        now_s = self._now_s()
        if self._dry_since_s is None:
            self._dry_since_s = now_s
        return self._is_others or now_s - self._dry_since_s >= self._linger_s

    # --- inside ----------------------------------------------------------------------------------

    def close(self, code: Code = Code.OK, said: str = "") -> None:
        """The line in hand is through: answer it."""
        line, error = self._open, self._refused
        self.drop()
        if line is None:
            return
        if error is not None:
            code, said = code_of(error), error.message
        self._answer(line, code, said)

    def _next(self) -> str:
        self._dry = False
        self._count += 1
        if self._count > _A_TURN:
            self._count = 0
            return NOT_YET
        while (line := self._inbox.head(self._patience_s())) is not None:
            kind = kind_of(line.text)
            said = self._why_not(line) if kind is self._kind else ""
            if kind is self._kind and not said:
                if not self._inbox.take(line):
                    continue
                self._open = line
                self._modes.resting = False
                return line.text
            if kind is Kind.EMPTY or said:
                self._say(line, self._number(line) if said else Code.OK, said)
            elif not self._passed(line, kind):
                self._is_others = True
                break
        self._dry, self._count = True, 0
        return NOT_YET

    def between(self) -> None:
        """Between two rounds of the job: what is no line for it does not wait for its turn."""
        while self._open is None and (line := self._inbox.head()) is not None:
            kind = kind_of(line.text)
            if kind in (self._kind, Kind.EMPTY) or self._at_rest() or not self._passed(line, kind):
                return

    def _passed(self, line: Sent, kind: Kind) -> bool:
        """A line that is not for this job is seen to, or refused; False: at rest it is its turn."""
        if kind is Kind.SYSTEM and self._inline(line):
            return True
        if self._at_rest():
            return False
        is_locked = self._kind is Kind.JOG and kind is Kind.CODE
        self._say(line, Code.LOCKED if is_locked else Code.NOT_IDLE)
        return True

    def _say(self, line: Sent, code: Code, said: str = "") -> None:
        if self._inbox.take(line):
            self._answer(line, code, said)

    def _why_not(self, line: Sent) -> str:
        if len(line.text) > MOST:
            return phrase("A line has at most {most} characters.", most=MOST)
        return why_not(line.text) if self._kind is Kind.CODE else ""

    @staticmethod
    def _number(line: Sent) -> Code:
        return Code.OVERFLOW if len(line.text) > MOST else Code.UNSUPPORTED

    def _patience_s(self) -> float:
        return _PATIENCE_AT_REST_S if self._at_rest() else _PATIENCE_S
