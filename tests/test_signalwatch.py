"""Signals are heard whatever the main thread waits for."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from fraese.signalwatch import ENDING, watched


@pytest.fixture(autouse=True)
def untouched() -> Iterator[None]:
    before = [signal.getsignal(number) for number in ENDING]
    yield
    assert [signal.getsignal(number) for number in ENDING] == before
    assert signal.set_wakeup_fd(-1) == -1


def test_a_thread_acts_and_the_main_thread_may_raise() -> None:
    heard: list[tuple[int, str]] = []
    acted = threading.Event()

    def act(number: int) -> None:
        heard.append((number, threading.current_thread().name))
        acted.set()

    def give_up(number: int) -> None:
        raise KeyboardInterrupt

    with watched(act, give_up), pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGTERM)
    assert acted.wait(10)
    assert heard == [(signal.SIGTERM, "signals")]


def test_elsewhere_nothing_changes() -> None:
    before = signal.getsignal(signal.SIGINT)
    seen: list[object] = []

    def go() -> None:
        with watched(lambda number: None):
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=go)
    thread.start()
    thread.join()
    assert seen == [before]


def test_a_storm_is_heard() -> None:
    heard: list[int] = []
    with watched(heard.append):
        for number in ENDING * 200:
            signal.raise_signal(number)
    assert set(heard) == set(ENDING)


BLOCKED = """
import os, signal, sys, time
from fraese.signalwatch import watched

def act(number):
    os.write(2, b"heard")
    os._exit(7)

read, write = os.pipe()
with watched(act):
    print("begun", flush=True)
    while True:
        # The terminal that nobody reads; a write that was interrupted is begun again.
        os.write(write, b"x" * 100_000)
"""


@pytest.mark.parametrize("number", ENDING)
def test_a_main_thread_that_waits_for_output_delays_nothing(number: int) -> None:
    program = subprocess.Popen(
        [sys.executable, "-c", BLOCKED], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert program.stdout is not None
    assert program.stdout.readline() == b"begun\n"
    time.sleep(0.05)
    os.kill(program.pid, number)
    _, said = program.communicate(timeout=20)
    assert (program.returncode, said) == (7, b"heard")


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has such priorities by thread")
def test_who_hears_is_woken_before_all_others_where_that_is_allowed() -> None:
    """On a machine that is busy with other things a thread waits for its turn, up to a second."""
    seen: list[int] = []

    def ask() -> None:
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        seen.append(os.sched_getscheduler(0))

    asking = threading.Thread(target=ask)
    asking.start()
    asking.join()
    heard = threading.Event()

    def act(_: int) -> None:
        seen.append(os.sched_getscheduler(0))
        heard.set()

    with watched(act):
        os.kill(os.getpid(), signal.SIGHUP)
        assert heard.wait(20)
    assert seen[1] & ~os.SCHED_RESET_ON_FORK == seen[0]
    # Nobody else.
    assert os.sched_getscheduler(0) == os.SCHED_OTHER
