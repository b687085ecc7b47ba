"""Waiting in small steps: what waits yields, and whoever runs it decides how long at a time.

    steps = connection.opening(...)      # nothing has happened yet
    finish(steps)                        # all of it, at a stretch
    advance(steps, enough)               # some of it; the rest another time

Rule 1: between two steps lies one short look at the line, never more than a few milliseconds.
Rule 2: steps that are given up are closed, and then let go of what they hold.
"""

from collections.abc import Callable, Generator
from typing import TypeVar

T = TypeVar("T")
Steps = Generator[None, None, T]


def finish(steps: Steps[T]) -> T:
    """Run to the end, and say what came of it."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            result: T = end.value
            return result


def advance(steps: Steps[object], enough: Callable[[], bool]) -> bool:
    """One step, and more until it is enough; whether the end was reached."""
    return all(not enough() for _ in steps)
