"""How many examples, and how long one may take."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from hypothesis import HealthCheck, settings

from fraese.errors import FraeseError

#: So many times as many as in CI; above 1 they are new ones every time.
FACTOR = int(os.environ.get("FRAESE_FUZZ", "1"))
#: What takes longer counts as hung.
HUNG_S = 5.0


def fuzzed(examples: int) -> settings:
    """Settings of a target.

    Args:
        examples: as many in CI.
    """
    return settings(
        max_examples=examples * FACTOR,
        deadline=None,
        derandomize=FACTOR == 1,
        suppress_health_check=list(HealthCheck),
    )


def refusal_of(action: Callable[[], object], patience_s: float = HUNG_S) -> str:
    """The one sentence with which this is refused; empty: it is not. Nothing else comes out."""
    try:
        with soon(patience_s):
            action()
    except FraeseError as refusal:
        return str(refusal)
    return ""


def is_a_sentence(text: str) -> bool:
    """Of a length that a screen holds."""
    return len(text) < 1000 and "\n" not in text


class HungError(AssertionError):
    """It took too long."""


@contextmanager
def soon(patience_s: float = HUNG_S) -> Iterator[None]:
    """Whatever happens here is over in time; in the main thread."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise HungError(f"this was not over within {patience_s:g} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, patience_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
