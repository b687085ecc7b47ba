r"""What commands say: no machine waits for it, and no exit code depends on it.

    note, progress --> queue --> thread --> standard error      foreign text made plain
    result         --> queue --> thread --> standard output     after what was noted
    say            ------------------------> standard output     of commands that move nothing

Rule 1: while a machine may move, nothing waits until somebody reads: a terminal that is stopped
        with Ctrl+S, a stalled line. Progress that was not read yet is replaced by newer progress;
        a result is never dropped.
Rule 2: what cannot be written (closed, full, nobody there) is not written, and no more than that.
"""

import contextlib
import io
import os
import select
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple, TextIO

from fraese.errors import OutputError
from fraese.phrases import phrase, reason, shown
from fraese.plaintext import plain, plain_lines

#: More than this waits only if it is a result; what is noted after it is counted and left out.
_ROOM_CHARACTERS: Final = 1_000_000
#: A write of more would wait longer than it must in a terminal that is read slowly.
_PIECE_BYTES: Final = 1024
_LOOK_EVERY_S: Final = 0.05
#: After a signal nobody is waited for any longer than this.
_LAST_WORDS_S: Final = 0.15
_WIPE: Final = "\r\x1b[K"
_STANDARD: Final = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))


class _Piece(NamedTuple):
    """Something to write; what passes makes way for what comes after it."""

    text: str
    passes: bool


class Outlet:
    """An open file, written by a thread of its own.

    Args:
        fd: its number.
        encoding: of what reads it; what it has no character for is written as an escape.

    Attributes:
        failure: why it cannot be written any more.
    """

    def __init__(self, fd: int, encoding: str = "utf-8") -> None:
        self._fd = fd
        self._encoding = encoding
        self._news = threading.Condition()
        self._waiting: deque[_Piece] = deque()
        self._characters = 0
        self._left_out = 0
        self._writing = False
        self._thread: threading.Thread | None = None
        self.failure: OSError | None = None

    def put(self, text: str, *, passes: bool = False, must: bool = False) -> None:
        """Write this when it can be written; never waits.

        Args:
            text: as it is; foreign text was made plain.
            passes: left out if something else comes before it could be written.
            must: also if there is no room for it.
        """
        with self._news:
            if self.failure is not None:
                return
            if self._waiting and self._waiting[-1].passes:
                self._characters -= len(self._waiting.pop().text)
            if self._characters > _ROOM_CHARACTERS and not must:
                self._left_out += not passes
                return
            self._waiting.append(_Piece(text, passes))
            self._characters += len(text)
            if self._thread is None:
                self._thread = threading.Thread(target=self._write, name="output", daemon=True)
                self._thread.start()
            self._news.notify_all()

    def is_written(self, timeout_s: float) -> bool:
        """Wait at most so long until nothing is left to write."""
        with self._news:
            return self._news.wait_for(lambda: not (self._waiting or self._writing), timeout_s)

    def _write(self) -> None:
        while True:
            with self._news:
                self._writing = False
                self._news.notify_all()
                self._news.wait_for(lambda: self._waiting)
                text = self._waiting.popleft().text
                self._characters -= len(text)
                if not self._waiting and self._left_out:
                    text += phrase(
                        "({left_out} lines are left out here: nobody read them.)\n",
                        left_out=self._left_out,
                    )
                    self._left_out = 0
                self._writing = True
            try:
                _write_all(self._fd, text.encode(self._encoding, "backslashreplace"))
            except OSError as error:
                with self._news:
                    self.failure = error
                    self._waiting.clear()
                    self._writing = False
                    self._news.notify_all()
                return


def _write_all(fd: int, data: bytes) -> None:
    while data:
        try:
            data = data[os.write(fd, data[:_PIECE_BYTES]) :]
        except BlockingIOError:
            # Somebody else who has this terminal open does not wait in it.
            select.select([], [fd], [])


class Borrowed:
    """A stream that is no file: whoever put it there reads it at once."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None

    def put(self, text: str, *, passes: bool = False, must: bool = False) -> None:
        """Write this."""
        with contextlib.suppress(OSError, ValueError):
            print(text, end="", file=self._stream, flush=True)

    def is_written(self, timeout_s: float) -> bool:
        """Nothing is left to write."""
        return True


_outlets: dict[int, Outlet] = {}


def _to(fd: int, stream: TextIO | None, own: TextIO | None) -> Outlet | Borrowed:
    """Where the text of this stream goes."""
    if stream is not None and stream is not own:
        return Borrowed(stream)
    if fd not in _outlets:
        _outlets[fd] = Outlet(fd, getattr(stream, "encoding", None) or "utf-8")
    return _outlets[fd]


def _errors() -> Outlet | Borrowed:
    return _to(2, sys.stderr, sys.__stderr__)


def note(text: str, end: str = "\n") -> None:
    """A line for people; nothing waits until it is read."""
    _errors().put(plain(shown(text)) + end)


def show_progress(line: str) -> None:
    """Replace the line of progress; left out while nobody reads."""
    _errors().put(_WIPE + plain(shown(line)), passes=True)


def wipe_progress() -> None:
    """Remove it."""
    _errors().put(_WIPE)


def say(text: str, end: str = "\n") -> None:
    """A line on standard output, after what was noted; nothing may move meanwhile.

    Raises:
        OutputError: if it cannot be written, but for want of a reader.
    """
    settle()
    with contextlib.suppress(BrokenPipeError):
        write(plain_lines(shown(text)) + end)


def tell(text: str, end: str = "\n", *, over: bool = False) -> None:
    """The same while something may move: nothing waits until it is read.

    Args:
        text: the line.
        end: what comes after it.
        over: in place of the line before.
    """
    outlet = _to(1, sys.stdout, sys.__stdout__)
    outlet.put((_WIPE if over else "") + plain_lines(shown(text)) + end)


def write(text: str) -> None:
    """The same for text of our own making, as it is; for much of it, until nobody reads.

    Raises:
        BrokenPipeError: if nobody reads any more.
        OutputError: if it cannot be written.
    """
    with _told_of():
        sys.stdout.write(text)


def flush() -> None:
    """All of it is written now.

    Raises:
        OutputError: if it cannot be written, but for want of a reader.
    """
    with contextlib.suppress(BrokenPipeError), _told_of():
        sys.stdout.flush()


@contextlib.contextmanager
def _told_of() -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        _give_up_output()
        raise
    except OSError as error:
        _give_up_output()
        raise OutputError(
            phrase("Standard output cannot be written: {reason}.", reason=reason(error))
        ) from error


def _give_up_output() -> None:
    """What is still in the buffer would be tried once more at the end, and spoil the exit code."""
    with contextlib.suppress(OSError, ValueError):
        _open_nothing(sys.stdout.fileno())


def result(text: str, hurries: Callable[[], bool] = lambda: False) -> None:
    """The last line, on standard output; waits until it is read, or there is no time.

    Args:
        text: the line.
        hurries: the program has been told to end.
    """
    settle(hurries)
    with contextlib.suppress(OSError, OutputError, ValueError):
        # What was said comes before it.
        flush()
    outlet = _to(1, sys.stdout, sys.__stdout__)
    outlet.put(plain_lines(shown(text)) + "\n", must=True)
    _wait_for(outlet, hurries)
    failure = outlet.failure
    if failure is not None and not isinstance(failure, BrokenPipeError):
        note(phrase("fraese: the result cannot be written: {reason}.", reason=reason(failure)))
    settle(hurries)


def settle(hurries: Callable[[], bool] = lambda: False) -> None:
    """Wait until what was noted and told is read, or there is no time."""
    _wait_for(_errors(), hurries)
    if 1 in _outlets:
        _wait_for(_outlets[1], hurries)


def _wait_for(outlet: Outlet | Borrowed, hurries: Callable[[], bool]) -> None:
    while not outlet.is_written(_LOOK_EVERY_S):
        if hurries():
            outlet.is_written(_LAST_WORDS_S)
            return


class PlainStream(io.TextIOWrapper):
    """Standard error for whoever writes to it directly: nothing in it commands a terminal."""

    def write(self, text: str) -> int:
        """Write the text, made plain."""
        return super().write(plain_lines(text))


def open_standard_files() -> None:
    """Let standard input, output and error be there, whatever the program was started with.

    A closed one would be the next file that is opened, and be written to.
    """
    for fd, (name, mode) in enumerate(_STANDARD):
        try:
            os.fstat(fd)
        except OSError:
            _open_nothing(fd)
        stream = getattr(sys, name)
        if stream is None:
            stream = open(fd, mode, encoding="utf-8", closefd=False)  # noqa: SIM115
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace" if mode == "w" else "replace")
    if isinstance(sys.stderr, io.TextIOWrapper) and sys.stderr is sys.__stderr__:
        encoding = sys.stderr.encoding
        plainly = PlainStream(
            sys.stderr.detach(), encoding, errors="backslashreplace", line_buffering=True
        )
        sys.stderr = sys.__stderr__ = plainly  # type: ignore[misc]


def _open_nothing(fd: int) -> None:
    nothing = os.open(os.devnull, os.O_RDWR)
    if nothing != fd:
        os.dup2(nothing, fd)
        os.close(nothing)
    os.set_inheritable(fd, True)
