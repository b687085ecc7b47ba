"""Which core the steps are made on, and who keeps off it."""

import os
import signal
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from fraese.errors import PortError
from fraese.motor.realtime.cores import KeptOff, core_for_steps
from fraese.motor.realtime.kernel import KernelFacts, kernel_facts
from tests.motor.distantmill import ChildBench
from tests.realtime.test_lives import poll_for_ever

HERE = sorted(os.sched_getaffinity(0))
several = pytest.mark.skipif(len(HERE) < 2, reason="this machine has one core")


def facts(
    cores: tuple[int, ...], interrupts: tuple[int, ...] = (), isolated: tuple[int, ...] = ()
) -> KernelFacts:
    nothing_said = kernel_facts(50, Path("/nowhere"))
    return replace(nothing_said, cores=cores, device_interrupts=interrupts, isolated=isolated)


@pytest.mark.parametrize(
    ("named", "kernel", "core"),
    [
        (0, facts((0, 1), isolated=(1,)), 0),
        (None, facts((0,), isolated=(1,)), 1),
        (None, facts((0,)), None),
        (None, facts(()), None),
        (None, facts((0, 1, 2)), 2),
        (None, facts((0, 1), (20_000, 200_000)), 0),
        (None, facts((0, 1), (200_000, 20_000)), 1),
        (None, facts((0, 1), (20_000, 70_000)), 1),
        (None, facts((0, 1), (0, 9_999)), 1),
        (None, facts((0, 1, 2), (0, 50_000, 0)), 2),
        (None, facts((2, 3), (0, 0, 90_000, 5)), 3),
        (None, facts((2, 3), (0, 0, 5, 90_000)), 2),
    ],
)
def test_the_core_that_is_disturbed_least(
    named: int | None, kernel: KernelFacts, core: int | None
) -> None:
    assert core_for_steps(named, kernel) == core


@several
def test_the_host_keeps_off_the_core_as_long_as_the_child_lives() -> None:
    started, over = threading.Event(), threading.Event()
    seen: list[set[int]] = []

    def stay() -> None:
        started.set()
        over.wait()
        seen.append(os.sched_getaffinity(0))

    thread = threading.Thread(target=stay)
    thread.start()
    started.wait()
    bench = ChildBench("smc", capacity=8, safe_outputs=0)
    core = os.sched_getaffinity(bench.driver.pid)
    assert len(core) == 1
    assert os.sched_getaffinity(0) == set(HERE) - core
    over.set()
    thread.join()
    assert seen == [set(HERE) - core]
    bench.remove()
    assert os.sched_getaffinity(0) == set(HERE)


@several
def test_who_waits_for_its_death_may_be_woken_on_its_core_and_comes_first() -> None:
    """That core is free then, and the others may be busy with anything."""
    bench = ChildBench("smc", capacity=8, safe_outputs=0)
    (watcher,) = [thread for thread in threading.enumerate() if thread.name == "step process"]
    number = watcher.native_id
    assert number is not None
    assert os.sched_getaffinity(number) == set(HERE)
    granted = os.sched_getscheduler(bench.driver.pid) & ~os.SCHED_RESET_ON_FORK
    assert os.sched_getscheduler(number) & ~os.SCHED_RESET_ON_FORK == granted
    assert os.sched_getscheduler(0) == os.SCHED_OTHER
    bench.remove()


@several
def test_a_child_that_dies_gives_the_core_back() -> None:
    bench = ChildBench("smc", capacity=8, safe_outputs=0)
    os.kill(bench.driver.pid, signal.SIGKILL)
    with pytest.raises(PortError, match="SIGKILL"):
        poll_for_ever(bench.driver)
    assert os.sched_getaffinity(0) == set(HERE)
    bench.remove()


@several
def test_who_has_several_cores_is_left_none() -> None:
    kept = KeptOff()
    kept.leave_to(os.getpid())
    assert os.sched_getaffinity(0) == set(HERE)
    kept.come_back()
