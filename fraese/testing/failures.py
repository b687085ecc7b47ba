"""What a test is told when the machine would not come to an end by itself, or was asked wrongly.

    HarnessError
    ├── Unanswered      a program asked, and the test has no answer
    ├── TookTooLong     the machine runs longer than the test allows
    ├── NeverCame       what was to be done during a run: its moment did not come
    ├── DrivenByKeys    a command to a machine that the app drives
    ├── HasEnded        a key for an app that has been left
    └── NoSuchName      an axis, an end, a key or a plate that there is not

What the machine itself refuses, or stops with, is raised as it is: ``fraese.errors``.
"""

from collections.abc import Iterable


class HarnessError(Exception):
    """Root of the family."""


class Unanswered(HarnessError):
    """A program asked something, and nobody had an answer.

    Args:
        question: as the operator would read it.
        why: what was wrong with an answer that was given; empty: there was none.

    Attributes:
        question: likewise.
    """

    def __init__(self, question: str, why: str = "") -> None:
        self.question = question
        hint = why or "give run() answers, or yes=True"
        super().__init__(f"The program asks, and nobody has answered: {question} ({hint})")


class TookTooLong(HarnessError):
    """A run, or a wait, was longer than it may be.

    Args:
        what: was done.
        limit_s: so long it may take.
        time: whose: "machine", or "real".
    """

    def __init__(self, what: str, limit_s: float, time: str = "machine") -> None:
        super().__init__(f"{what}: not over after {limit_s:g} s of {time} time")


class NeverCame(HarnessError):
    """What was to be done during a run was not: it ended before.

    Args:
        moments: what was waited for.
    """

    def __init__(self, moments: Iterable[str]) -> None:
        super().__init__(f"The run was over before this came: {', '.join(moments)}")


class DrivenByKeys(HarnessError):
    """The app drives this machine: keys do, and nothing beside them.

    Args:
        command: what was called.
    """

    def __init__(self, command: str) -> None:
        super().__init__(f"{command}() on a machine that the app drives: press keys instead")


class HasEnded(HarnessError):
    """The app was left, by a key or by the test: nobody hears what is typed."""

    def __init__(self) -> None:
        super().__init__("The app has ended: nobody hears what is typed")


class NoSuchName(HarnessError, ValueError):
    """A name that this machine does not have.

    Args:
        name: as given.
        known: what there is.
    """

    def __init__(self, name: str, known: Iterable[str]) -> None:
        super().__init__(f"{name!r} is none of {', '.join(known)}")
