"""Processes of the guest, by fork: to start a Python anew takes seconds under emulation.

Forked            a module's main, spoken to over pipes
ForkedStepper     the real-time driver's step process, without the start of another Python
"""

import importlib
import os
import signal
import sys
import threading
import time
import traceback
from contextlib import suppress
from io import TextIOWrapper
from typing import Final

from fraese.motor.realtime import child

_LOOK_S: Final = 0.002


class Forked:
    """A child that runs ``main`` of a module, its input and output at the parent's end of pipes.

    Args:
        module: is imported already, best of all.
        arguments: of its ``main``.

    Attributes:
        returncode: as ``subprocess`` has it; None while it runs.
    """

    def __init__(self, module: str, *arguments: str) -> None:
        child_input, to_child = os.pipe()
        from_child, child_output = os.pipe()
        self.returncode: int | None = None
        self.pid = os.fork()
        if not self.pid:
            os.close(to_child)
            os.close(from_child)
            _become(module, arguments, child_input, child_output)
        os.close(child_input)
        os.close(child_output)
        self.stdin = TextIOWrapper(os.fdopen(to_child, "wb", 0), write_through=True)
        self.stdout = TextIOWrapper(os.fdopen(from_child, "rb"))

    def send_signal(self, number: int) -> None:
        """While it runs."""
        if self.returncode is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """At once."""
        self.send_signal(signal.SIGKILL)

    def communicate(self) -> tuple[str, None]:
        """Wait for its end; what it said until then."""
        # A reader that is gone takes no more input.
        with suppress(BrokenPipeError):
            self.stdin.close()
        said = self.stdout.read()
        self.stdout.close()
        if self.returncode is None:
            self.returncode = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        return said, None


def _become(module: str, arguments: tuple[str, ...], reading: int, writing: int) -> None:
    """The child: never returns."""
    code = 1
    try:
        os.dup2(reading, 0)
        os.dup2(writing, 1)
        os.close(reading)
        os.close(writing)
        sys.stdin, sys.stdout = os.fdopen(0, "r"), os.fdopen(1, "w")
        importlib.import_module(module).main(*arguments)
        sys.stdout.flush()
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


class ForkedStepper:
    """What the driver uses of ``subprocess.Popen``: in a session of its own, with no files of ours.

    Args:
        memory_fd: the shared memory.
        samples: as the child's.

    Attributes:
        stdin: the pipe to it.
        returncode: as ``subprocess`` has it; None while it runs.
    """

    def __init__(self, memory_fd: int, samples: int) -> None:
        reading, writing = os.pipe()
        self.returncode: int | None = None
        self._lock = threading.Lock()
        self.pid = os.fork()
        if not self.pid:
            _become_stepper(memory_fd, samples, reading)
        os.close(reading)
        self.stdin = os.fdopen(writing, "wb", 0)

    def poll(self) -> int | None:
        """How it ended; None: it runs. From any thread."""
        with self._lock:
            if self.returncode is None:
                pid, status = os.waitpid(self.pid, os.WNOHANG)
                self.returncode = os.waitstatus_to_exitcode(status) if pid else None
            return self.returncode

    def wait(self) -> int:
        """How it ended, when it has."""
        while (code := self.poll()) is None:
            time.sleep(_LOOK_S)
        return code

    def kill(self) -> None:
        """At once."""
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)


def _become_stepper(memory_fd: int, samples: int, reading: int) -> None:
    """The child: never returns."""
    code = 1
    try:
        os.setsid()
        os.dup2(reading, 0)
        os.closerange(3, memory_fd)
        os.closerange(memory_fd + 1, 1024)
        code = child.main(memory_fd, samples)
    finally:
        os._exit(code)
