"""The other side of ``looker.py``: a process that looks a program through, and ends with it."""

import os
import pickle
import queue
import sys
import threading
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

from fraese.phrases import phrase
from fraese.program.check import Facts, check_program
from fraese.program.context import ProgramContext
from fraese.program.looker import receive_file, send_file
from fraese.program.taken import Taken
from fraese.program.telling import Stage, Tell


def main(most_bytes: int) -> None:
    """Answer questions until standard input ends.

    Args:
        most_bytes: of memory.
    """
    # What it takes along is not counted as memory of the program.
    import_module("fraese.program.outline")
    _bound_memory(most_bytes)
    asked: queue.SimpleQueue[tuple[Taken, ProgramContext, bool]] = queue.SimpleQueue()
    threading.Thread(target=_hear, args=(sys.stdin.buffer, asked.put), daemon=True).start()
    out = sys.stdout.buffer
    while True:
        taken, context, plan = asked.get()
        before = set(taken.files)
        facts = _looked(taken, context, plan, most_bytes, partial(_say, out))
        for path in taken.files.keys() - before:
            send_file(out, path, taken.files[path])
        _say(out, facts)


def _say(out: BinaryIO, said: Facts | Stage) -> None:
    pickle.dump(said, out)
    out.flush()


def _hear(stream: BinaryIO, put: Callable[[tuple[Taken, ProgramContext, bool]], None]) -> None:
    """Questions as they come; when nobody can ask any more, that is the end, whatever runs."""
    taken: Taken | None = None
    try:
        while True:
            first, second = pickle.load(stream)
            if isinstance(first, ProgramContext):
                assert taken is not None
                put((taken, first, second))
                continue
            content = receive_file(stream, second)
            if taken is not None:
                taken.files[first] = content
            elif content is not None:
                taken = Taken(first, content, {})
    finally:
        os._exit(0)


def _looked(
    taken: Taken, context: ProgramContext, plan: bool, most_bytes: int, tell: Tell
) -> Facts:
    try:
        return check_program(taken, context, plan=plan, tell=tell)
    except MemoryError:
        return Facts.refused(
            phrase(
                "to look it through would need more than {most_bytes} MB of memory.",
                most_bytes=most_bytes >> 20,
            )
        )


def _bound_memory(most_bytes: int) -> None:
    """An endless program must not take the machine's computer with it."""
    try:
        import resource
    except ImportError:  # no such bounds here
        return
    bound = most_bytes + _taken_already()
    resource.setrlimit(resource.RLIMIT_AS, (bound, bound))


def _taken_already() -> int:
    """Bytes that the interpreter and its libraries reserve, whatever is looked through."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError, IndexError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    main(int(sys.argv[1]))
