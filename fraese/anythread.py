"""What may be called from any thread is marked where it is defined.

Everything else belongs to one thread: the one that runs the controller. A marked method sets flags
or reads what is replaced whole, so that it needs no lock and waits for nobody. The mark costs
nothing and does nothing; a test calls every marked method of the controller from another thread
and sees which attributes it sets.
"""

from collections.abc import Callable
from typing import Final, TypeVar

F = TypeVar("F", bound=Callable[..., object])

#: Of a marked function this attribute is true.
MARK: Final = "__any_thread__"


def any_thread(function: F) -> F:
    """Mark a function that may be called from any thread."""
    function.__dict__[MARK] = True
    return function
