"""Files as lines of text, whatever their encoding, without ever holding a whole file.

UTF-8 (with or without mark) and UTF-16 (with mark) are recognised; a line that is not UTF-8
is taken as Latin-1, which only ever concerns comments. Lines end with LF, CR LF or CR.

Opening never waits and disturbs nothing: a pipe, a device or a folder is refused by its kind.
"""

import codecs
import errno
import io
import os
import stat
from collections.abc import Generator, Iterator
from functools import partial
from pathlib import Path
from typing import BinaryIO, Final

from fraese.errors import ProgramError
from fraese.phrases import phrase, reason

MAX_LINE: Final = 4096
WIDE_MARKS: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
#: What the system says of a name under which nothing can lie.
_NOT_THERE: Final = (errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG)
_FLAGS: Final = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def open_plain(path: Path, file: str = "") -> BinaryIO | None:
    """Open a plain file for reading; None: there is none.

    Args:
        path: the file.
        file: its name in messages; the path as given where empty.

    Raises:
        ProgramError: something else stands there, or it cannot be read.
    """
    file = file or str(path)
    try:
        # Before it is opened: merely opening a device may do something to it.
        _require_plain(os.stat(path).st_mode, file)
        stream = os.fdopen(os.open(path, _FLAGS), "rb")
    except ValueError:
        return None
    except OSError as error:
        if error.errno in _NOT_THERE:
            return None
        raise ProgramError(
            phrase("cannot be read: {reason}.", reason=reason(error)), file=file
        ) from error
    try:
        _require_plain(os.fstat(stream.fileno()).st_mode, file)
    except ProgramError:
        stream.close()
        raise
    return stream


def _require_plain(mode: int, file: str) -> None:
    if stat.S_ISDIR(mode):
        raise ProgramError(phrase("is a folder; name a file in it."), file=file)
    if not stat.S_ISREG(mode):
        raise ProgramError(
            phrase("is a pipe or a device; a program is read from a plain file."), file=file
        )


def require_inside(path: Path) -> None:
    """See that a name in a folder is no link that leads out of it.

    Raises:
        ProgramError: it is.
    """
    folder = Path(os.path.realpath(path.parent))
    if os.path.islink(path) and not Path(os.path.realpath(path)).is_relative_to(folder):
        raise ProgramError(
            phrase("is a link that leads out of its folder; copy the file."), file=str(path)
        )


def read_lines(path: Path, file: str = "") -> Generator[str, None, None]:
    """Yield the lines of a file without their ends.

    Args:
        path: the file.
        file: its name in messages; the path as given where empty.

    Raises:
        ProgramError: the file cannot be read, is binary, or has a line that is too long.
    """
    stream = open_plain(path, file)
    if stream is None:
        raise ProgramError(phrase("there is no such file."), file=file or str(path))
    yield from lines_of(stream, file or str(path))


def lines_of(stream: BinaryIO, file: str) -> Generator[str, None, None]:
    """The same of an open file, which is closed behind its last line.

    Args:
        stream: buffered, at its beginning.
        file: its name in messages.

    Raises:
        ProgramError: the file cannot be read, is binary, or has a line that is too long.
    """
    with stream:
        try:
            wide = stream.peek(2)[:2] in WIDE_MARKS  # type: ignore[attr-defined]
            encoding, errors = ("utf-16", "replace") if wide else ("utf-8-sig", "surrogateescape")
            with io.TextIOWrapper(stream, encoding, errors) as text_stream:
                yield from _lines(text_stream, file)
        except OSError as error:
            raise ProgramError(
                phrase("cannot be read: {reason}", reason=reason(error)), file=file
            ) from error


def _lines(stream: io.TextIOWrapper, file: str) -> Iterator[str]:
    # One more than allowed, and its end: so a longer line is noticed before it is all read.
    read = partial(stream.readline, MAX_LINE + 2)
    for line, text in enumerate(iter(read, ""), start=1):
        if "\0" in text:
            raise ProgramError(
                phrase("this is a binary file (a NUL byte), not a program"), line, file
            )
        if not text.isascii():
            text = _repaired(text)
        text = text.removesuffix("\n")
        if len(text) > MAX_LINE:
            raise ProgramError(
                phrase("the line is longer than {max_line} characters", max_line=MAX_LINE),
                line,
                file,
            )
        yield text


def _repaired(text: str) -> str:
    """Latin-1 where bytes were no UTF-8."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode(errors="surrogateescape").decode("latin-1")
    return text


def decoded(line: bytes) -> str:
    """A line of a file that is not UTF-16, without its end."""
    text = line.decode(errors="surrogateescape").removesuffix("\n").removesuffix("\r")
    return text if text.isascii() else _repaired(text)
