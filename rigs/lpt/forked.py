"""Processes of the guest, by fork: to start a Python anew takes seconds under emulation."""

import importlib
import os
import signal
import sys
import traceback
from contextlib import suppress
from io import TextIOWrapper


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
