"""Files as lines of text, whatever their encoding, without ever holding a whole file.

UTF-8 (with or without mark) and UTF-16 (with mark) are recognised; a line that is not UTF-8
is taken as Latin-1, which only ever concerns comments. Lines end with LF, CR LF or CR.
"""

import codecs
import io
from collections.abc import Generator, Iterator
from functools import partial
from pathlib import Path
from typing import Final

from fraese.errors import ProgramError

MAX_LINE: Final = 4096
_WIDE_MARKS: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_lines(path: Path, file: str = "") -> Generator[str, None, None]:
    """Yield the lines of a file without their ends.

    Args:
        path: the file.
        file: its name in messages; the path as given where empty.

    Raises:
        ProgramError: the file cannot be read, is binary, or has a line that is too long.
    """
    file = file or str(path)
    try:
        with path.open("rb") as stream:
            wide = stream.peek(2)[:2] in _WIDE_MARKS
            encoding, errors = ("utf-16", "replace") if wide else ("utf-8-sig", "surrogateescape")
            with io.TextIOWrapper(stream, encoding, errors) as text_stream:
                yield from _lines(text_stream, file)
    except OSError as error:
        raise ProgramError(f"cannot be read: {error.strerror}", file=file) from error


def _lines(stream: io.TextIOWrapper, file: str) -> Iterator[str]:
    # One more than allowed, and its end: so a longer line is noticed before it is all read.
    read = partial(stream.readline, MAX_LINE + 2)
    for line, text in enumerate(iter(read, ""), start=1):
        if "\0" in text:
            raise ProgramError("this is a binary file (a NUL byte), not a program", line, file)
        if not text.isascii():
            text = _repaired(text)
        text = text.removesuffix("\n")
        if len(text) > MAX_LINE:
            raise ProgramError(f"the line is longer than {MAX_LINE} characters", line, file)
        yield text


def _repaired(text: str) -> str:
    """Latin-1 where bytes were no UTF-8."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode(errors="surrogateescape").decode("latin-1")
    return text
