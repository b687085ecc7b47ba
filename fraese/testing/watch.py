"""What a test has to say while the machine runs: looked at between two slices of the run loop.

    slice of 0.1 s --> what is due is done --> a question is answered --> too long?

Rule 1: the job ends as jobs end, by a cancel with ramp; only one that does not come to rest then is
        torn out of the run loop.
Rule 2: an answer is what would be typed at the question: "" goes on; "jog Z 2", "zero Z" and the
        other words of ``cli/byhand.py`` are done first, and it asks again.
"""

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from fraese.cli.byhand import by_hand
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import FraeseError
from fraese.motor.seams import Clock
from fraese.testing.failures import HarnessError, NeverCame, TookTooLong, Unanswered

#: Says what would be typed at a question; None: nothing, it stays unanswered.
Answerer = Callable[[str], str | None]
#: A line, lines in turn, or somebody who answers.
Answers = str | Sequence[str] | Answerer

#: After a cancel motors come to rest within so much machine time, s.
_RAMP_S: Final = 30.0
_NS_PER_S: Final = 1_000_000_000


class Due(NamedTuple):
    """Something to be done once.

    Attributes:
        moment: in words.
        is_now: whether its moment has come; told the machine time since the run began, s.
        action: what.
    """

    moment: str
    is_now: Callable[[float], bool]
    action: Callable[[], object]


class Watch:
    """Looks after one run at a time.

    Args:
        controller: whose.
        clock: its time.

    Attributes:
        plans: what is to be done during the next run.
        looks: what is to be done all the time during the next run.
        asked: questions of this run, in order.
    """

    def __init__(self, controller: Controller, clock: Clock) -> None:
        self._controller = controller
        self._clock = clock
        self.plans: list[Due] = []
        self.looks: list[Callable[[], object]] = []
        self.asked: list[str] = []
        self._due: list[Due] = []
        self._looks: list[Callable[[], object]] = []
        self._answer: Answerer = _nothing
        self._limit_s = self._began_s = 0.0
        self._what = ""
        self._question = ""
        self._failure: HarnessError | None = None

    def begin(self, what: str, answers: Answers, *, yes: bool, limit_s: float) -> None:
        """A run begins.

        Args:
            what: for people.
            answers: to its questions.
            yes: those that nobody answers go on.
            limit_s: machine time that it may take.
        """
        self._what, self._limit_s, self._began_s = what, limit_s, self._now_s()
        self._answer = _answerer(answers, yes=yes)
        self._due, self.plans = self.plans, []
        self._looks, self.looks = self.looks, []
        self.asked = []
        self._question, self._failure = "", None

    def between(self) -> None:
        """Between two slices.

        Raises:
            HarnessError: the machine did not come to rest after a cancel.
        """
        passed_s = self._now_s() - self._began_s
        for look in self._looks:
            look()
        if self._failure is not None:
            if passed_s > self._limit_s + _RAMP_S:
                raise self._failure
            return
        for due in [each for each in self._due if each.is_now(passed_s)]:
            self._due.remove(due)
            due.action()
        if question := self._controller.question:
            self._reply(question)
        if passed_s > self._limit_s:
            self._fail(TookTooLong(self._what, self._limit_s))

    def end(self) -> None:
        """The run is over.

        Raises:
            HarnessError: not as it should be: nobody had an answer, or it took too long.
        """
        due, self._due = self._due, []
        if self._failure is not None:
            raise self._failure
        if due and self._controller.status is Status.OK:
            raise NeverCame(each.moment for each in due)

    def _now_s(self) -> float:
        return self._clock.now_ns() / _NS_PER_S

    def _reply(self, question: str) -> None:
        if question != self._question:
            self.asked.append(str(question))
        # What is done by hand comes back to the same question.
        self._question = question
        typed = self._answer(question)
        if typed is None:
            self._fail(Unanswered(question))
        elif not typed.strip():
            self._question = ""
            self._controller.answer()
        else:
            try:
                by_hand(self._controller, typed)
            except FraeseError as error:
                self._fail(Unanswered(question, f"{typed!r} was refused: {error}"))

    def _fail(self, failure: HarnessError) -> None:
        self._failure = failure
        # Nobody knows how far away a limit is that is over: braking begins now.
        self._limit_s = self._now_s() - self._began_s
        self._controller.cancel()


def _nothing(question: str) -> str | None:
    return None


def _answerer(answers: Answers, *, yes: bool) -> Answerer:
    left = [answers] if isinstance(answers, str) else [] if callable(answers) else list(answers)

    def answer(question: str) -> str | None:
        given = answers(question) if callable(answers) else (left.pop(0) if left else None)
        return "" if given is None and yes else given

    return answer
