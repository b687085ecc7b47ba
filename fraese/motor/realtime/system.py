"""What Linux can do for a process that must be on time.

Rule 1: everything here may be refused. That is a fact to be told, not an error: the steps are made
        all the same, only later.
Rule 2: a process under SCHED_FIFO that never sleeps is stopped by the kernel for 50 ms in every
        second (``sched_rt_runtime_us``). So FIFO is for rates that leave time to sleep, and
        nice -20 for those that do not, unless the kernel has been told otherwise and there is a
        second core.
Rule 3: in a session of its own a process is in a scheduling group of its own, where the kernel
        makes such groups (autogroup). Its nice value then only counts within the group: the group
        must be nice, too.
Rule 4: sleeping is only exact without the timer slack of 50 us.
"""

import contextlib
import ctypes
import gc
import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from fraese.motor.realtime.cores import core_for_steps
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.setup import SLEEP_GAP_S, Setup
from fraese.phrases import phrase, reason

PRIORITY: Final = 50
_NICE: Final = -20
_RT_RUNTIME: Final = Path("/proc/sys/kernel/sched_rt_runtime_us")
_AUTOGROUP: Final = Path("/proc/self/autogroup")
_DMA_LATENCY: Final = Path("/dev/cpu_dma_latency")

# From sys/mman.h and sys/prctl.h.
_MCL_CURRENT: Final = 1
_MCL_FUTURE: Final = 2
_PR_SET_TIMERSLACK: Final = 29


def prepare(setup: Setup) -> list[str]:
    """Ask for all of it, for this process.

    Returns:
        What was granted and what was refused, a sentence each.
    """
    asked: tuple[Callable[[Setup], str], ...] = (
        _stay_on_one_core,
        _come_first,
        _lock_memory,
        _wake_exactly,
        _stay_awake,
        _collect_no_garbage,
    )
    return [ask(setup) for ask in asked]


def rt_is_unlimited() -> bool:
    """The kernel lets a SCHED_FIFO process run without a pause."""
    try:
        return int(_RT_RUNTIME.read_text("ascii")) < 0
    except (OSError, ValueError):
        return False


def _stay_on_one_core(setup: Setup) -> str:
    core = core_for_steps(setup.options.core, kernel_facts(PRIORITY))
    if core is None:
        return phrase("one core only: the steps share it with everything else")
    try:
        os.sched_setaffinity(0, {core})
    except OSError as error:
        return phrase("not on core {core}: {reason}", core=core, reason=reason(error))
    return phrase("on core {core}", core=core)


def _come_first(setup: Setup) -> str:
    """SCHED_FIFO where there is time to sleep, else nice -20."""
    sleeps = setup.gap_s() >= SLEEP_GAP_S
    if sleeps or (rt_is_unlimited() and (os.cpu_count() or 1) > 1):
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        except OSError as error:
            return phrase(
                "no SCHED_FIFO ({reason}); {be_nice}", reason=reason(error), be_nice=_be_nice()
            )
        return phrase("SCHED_FIFO {priority}", priority=PRIORITY)
    return _be_nice()


def _be_nice() -> str:
    try:
        os.setpriority(os.PRIO_PROCESS, 0, _NICE)
        with contextlib.suppress(FileNotFoundError):
            _AUTOGROUP.write_text(str(_NICE), "ascii")
    except OSError as error:
        return phrase("no nice {nice} ({reason})", nice=_NICE, reason=reason(error))
    return phrase("nice {nice}", nice=_NICE)


def _last() -> OSError:
    """What the C library's last call was refused for."""
    number = ctypes.get_errno()
    return OSError(number, os.strerror(number))


def _lock_memory(_: Setup) -> str:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE):
        return phrase("memory not locked: {reason}", reason=reason(_last()))
    return phrase("memory locked")


def _wake_exactly(_: Setup) -> str:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0):
        return phrase("timer slack unchanged: {reason}", reason=reason(_last()))
    return phrase("timer slack 1 ns")


def _stay_awake(_: Setup) -> str:
    """Held open as long as the process lives: a processor asleep wakes late."""
    try:
        fd = os.open(_DMA_LATENCY, os.O_WRONLY)
        os.write(fd, (0).to_bytes(4, "little"))
    except OSError as error:
        return phrase(
            "the processor may sleep: {dma_latency}: {reason}",
            dma_latency=_DMA_LATENCY,
            reason=reason(error),
        )
    return phrase("the processor does not sleep")


def _collect_no_garbage(_: Setup) -> str:
    gc.collect()
    gc.freeze()
    gc.disable()
    return phrase("no garbage collection")
