"""Threads that sleep until something is to be done at once are woken before all others.

On a machine that is busy with other things a thread waits for its turn for up to a second, also one
that has only to say "brake".

Rule 1: only for threads that sleep but for moments; such a one disturbs nobody.
Rule 2: whoever may not ask for it waits like everybody; nothing is said, nothing fails.
"""

import contextlib
import os
from typing import Final

#: Of SCHED_FIFO, as the step process's.
_PRIORITY: Final = 50


def come_first_when_woken() -> None:
    """For the calling thread; what it starts is as usual."""
    with contextlib.suppress(AttributeError, OSError):
        policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
        os.sched_setscheduler(0, policy, os.sched_param(_PRIORITY))
