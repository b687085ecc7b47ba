"""Which core the steps are made on, and that their host keeps off it.

    named in the configuration  >  kept free by the kernel  >  far fewer interrupts  >  the last

Rule 1: a kernel without preemption lets whoever is inside a system call finish before it wakes the
        step process. So the threads of the host leave the core, and with them all that they start.
Rule 2: when the step process has ended they may use it again.
Rule 3: the thread that waits for that end stays where it likes: it sleeps until then, and then that
        core is free, while the others may be busy with anything.
"""

import contextlib
import os
import threading
from pathlib import Path
from typing import Final

from fraese.motor.realtime.kernel import KernelFacts

#: From so many times as many interrupts on, another core is quieter.
_BUSY_FACTOR: Final = 4
#: Fewer in all are no disturbance.
_FEW_INTERRUPTS: Final = 10_000
_THREADS: Final = Path("/proc/self/task")


def core_for_steps(named: int | None, kernel: KernelFacts) -> int | None:
    """The core to be asked for.

    Args:
        named: the one that the user wants.
        kernel: which there are, and what they have to do.

    Returns:
        Its number; None: there is no choice.
    """
    if named is not None:
        return named
    if kernel.isolated:
        return kernel.isolated[-1]
    if len(kernel.cores) < 2:
        return None
    quietest = quietest_core(kernel)
    return kernel.cores[-1] if quietest is None else quietest


def quietest_core(kernel: KernelFacts) -> int | None:
    """A core with far fewer interrupts than the busiest, if there is a great difference."""
    counts = kernel.device_interrupts
    known = [core for core in kernel.cores if core < len(counts)]
    if len(known) < 2:
        return None
    quiet = min(reversed(known), key=lambda core: counts[core])
    busiest = max(counts[core] for core in known)
    if busiest < max(_FEW_INTERRUPTS, _BUSY_FACTOR * counts[quiet]):
        return None
    return quiet


class KeptOff:
    """The threads of this process, off the only core of another for as long as that lives.

    Attributes:
        sleeper: number of a thread that sleeps all that time, and may be woken anywhere.
    """

    def __init__(self) -> None:
        self.sleeper: int | None = None
        self._lock = threading.Lock()
        self._before: set[int] | None = None
        self._over = False

    def leave_to(self, pid: int) -> None:
        """That process has its core to itself, as far as we are concerned.

        Nothing happens where it has several, or where none would be left to us.
        """
        with self._lock, contextlib.suppress(OSError):
            theirs, ours = os.sched_getaffinity(pid), os.sched_getaffinity(0)
            if not self._over and len(theirs) == 1 and ours - theirs and ours & theirs:
                self._before = ours
                _put_all_threads_on(ours - theirs, self.sleeper)

    def come_back(self) -> None:
        """It has ended."""
        with self._lock:
            self._over = True
            if self._before is not None:
                _put_all_threads_on(self._before)
                self._before = None


def _put_all_threads_on(cores: set[int], sleeper: int | None = None) -> None:
    for number in (int(thread.name) for thread in _THREADS.iterdir()):
        # It may have ended meanwhile.
        with contextlib.suppress(OSError):
            if number != sleeper:
                os.sched_setaffinity(number, cores)
