"""Files as lines of text, whatever their encoding, without ever holding a whole file.

UTF-8 (with or without mark) and UTF-16 (with mark) are recognised; bytes that are not UTF-8
are taken as Latin-1, which only ever concerns comments. Lines end with LF or CR LF, or with
CR in a file that has no LF.
"""

import codecs
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Final

from fraese.errors import ProgramError

MAX_LINE: Final = 4096
_CHUNK: Final = 1 << 16
_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


def read_lines(path: Path, file: str = "") -> Iterator[str]:
    """Yield the lines of a file without their ends.

    Args:
        path: the file.
        file: its name in messages; the path as given where empty.

    Raises:
        ProgramError: the file cannot be read, is binary, or has an endless line.
    """
    file = file or str(path)
    try:
        with path.open("rb") as stream:
            yield from _lines(stream, file)
    except OSError as error:
        raise ProgramError(f"cannot be read: {error.strerror}", file=file) from error


def _lines(stream: BinaryIO, file: str) -> Iterator[str]:
    encoding, rest = _encoding(stream.read(4))
    newline = ""
    line = 0
    while True:
        chunk = stream.read(_CHUNK)
        if not chunk:
            break
        data = rest + chunk
        newline = newline or _newline(data, encoding)
        whole, found, rest = data.rpartition(newline.encode(encoding))
        if encoding != "utf-8" and found:
            whole, rest = _even(data, newline, encoding)
        if len(rest) > 4 * MAX_LINE:
            raise _endless(line + 1 + whole.count(b"\n"), file)
        if found:
            text = _decoded(whole, encoding)
            _check_binary(text, line, file)
            lines = text.split(newline)
            line += len(lines)
            yield from lines
    if rest:
        text = _decoded(rest, encoding)
        _check_binary(text, line, file)
        yield from text.split(newline or "\n")


def _encoding(head: bytes) -> tuple[str, bytes]:
    for mark, encoding in _MARKS:
        if head.startswith(mark):
            return encoding, head[len(mark) :]
    return "utf-8", head


def _newline(data: bytes, encoding: str) -> str:
    lf, cr = "\n".encode(encoding), "\r".encode(encoding)
    return "\r" if cr in data and lf not in data else "\n"


def _even(data: bytes, newline: str, encoding: str) -> tuple[bytes, bytes]:
    """Cut UTF-16 behind its last newline, at a place where a character starts."""
    even = data[: len(data) // 2 * 2]
    text = even.decode(encoding, "replace")
    cut = text.rfind(newline)
    kept = len(text[: max(cut, 0)].encode(encoding, "replace"))
    return even[:kept], data[kept + 2 if cut >= 0 else 0 :]


def _decoded(data: bytes, encoding: str) -> str:
    if encoding != "utf-8":
        return data.decode(encoding, "replace")
    try:
        return data.decode()
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _check_binary(text: str, line: int, file: str) -> None:
    if "\0" in text:
        line += text[: text.index("\0")].count("\n") + 1
        raise ProgramError("this is a binary file (a NUL byte), not a program", line, file)


def _endless(line: int, file: str) -> ProgramError:
    return ProgramError(f"the line is longer than {MAX_LINE} characters", line, file)
