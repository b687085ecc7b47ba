"""Which kind of file it is, by what is in it, and who reads it.

Rule 1: the name of a file says nothing: what is in it does.
Rule 2: a reader raises ``UsageError`` and nothing else, whatever is in a file.
"""

import gzip
import importlib
import re
import zlib
from collections.abc import Callable
from pathlib import Path as FilePath
from typing import Final, NamedTuple, cast

from fraese.engrave.drawing import Drawing, Picture
from fraese.errors import UsageError
from fraese.phrases import phrase, reason

#: Files of more are no drawings, bytes.
_MOST: Final = 200_000_000
#: So much of a file shows what it is.
_HEAD: Final = 4096
_PACKED: Final = b"\x1f\x8b"
_MARK: Final = b"\xef\xbb\xbf"


class Source(NamedTuple):
    """A kind of file.

    Attributes:
        name: for people.
        fits: whether a file that begins so is one.
        reader: module and function that reads it: called with what is in it, and its name.
    """

    name: str
    fits: Callable[[bytes], bool]
    reader: str


def _begins(*marks: bytes) -> Callable[[bytes], bool]:
    return lambda head: head.startswith(marks)


def _matches(pattern: bytes) -> Callable[[bytes], bool]:
    compiled = re.compile(pattern, re.DOTALL)
    return lambda head: compiled.match(head.removeprefix(_MARK)) is not None


def _is_svg(head: bytes) -> bool:
    text = head.replace(b"\x00", b"")
    return text.removeprefix(_MARK).lstrip(b"\xfe\xff \t\r\n").startswith(b"<") and b"<svg" in text


_PICTURE: Final = "pictures:read"

#: In this order: the first that fits.
SOURCES: Final = (
    Source("PNG", _begins(b"\x89PNG"), _PICTURE),
    Source("JPEG", _begins(b"\xff\xd8\xff"), _PICTURE),
    Source("GIF", _begins(b"GIF8"), _PICTURE),
    Source("TIFF", _begins(b"II*\0", b"MM\0*"), _PICTURE),
    Source("BMP", _begins(b"BM"), _PICTURE),
    Source("WebP", _matches(rb"RIFF....WEBP"), _PICTURE),
    Source("PPM", _matches(rb"P[1-6]\s"), _PICTURE),
    Source("SVG", _is_svg, "svgfile:read"),
    Source("DXF", _begins(b"AutoCAD Binary DXF"), "dxffile:read"),
    # Comments (999) may stand before the first section.
    Source(
        "DXF",
        _matches(rb"\s*(?:999[^\n\r]*[\r\n]+[^\n\r]*[\r\n]+\s*)*0\s*[\r\n]+\s*SECTION\b"),
        "dxffile:read",
    ),
    Source(
        "HPGL",
        _matches(
            rb"(?:\s|;|\x1b\.[ -~](?:[\d;]*:)?|\x1b%[^A-Z]*[A-Z]|\x1bE|@PJL[^\n]*\n)*"
            rb"(?:IN|DF|SP|PU|PD|PA|PR|IP|SC|VS|PT|PW|FS|AS|LT|NP|RO|WU|TR|BP|PS|CO|LB|CI|AA|PE|PM)"
            rb"(?=[\s;,\d+.\"\-]|[A-Z]{2}|$)"
        ),
        "hpgl:read",
    ),
)


def read(file: FilePath) -> Drawing | Picture:
    """What is in a file.

    Raises:
        UsageError: if it cannot be read, or is of no kind that is known here.
    """
    data, name = _taken(file), file.name
    if not data.strip():
        raise UsageError(phrase("{name} is empty.", name=name))
    head = data[:_HEAD]
    source = next((source for source in SOURCES if source.fits(head)), None)
    if source is None:
        kinds = ", ".join(dict.fromkeys(source.name for source in SOURCES))
        raise UsageError(
            phrase(
                "{name} is none of the files that are read here: {kinds}.", name=name, kinds=kinds
            )
        )
    module, function = source.reader.split(":")
    reader = getattr(importlib.import_module(f"fraese.engrave.{module}"), function)
    return cast(Drawing | Picture, reader(data, name))


def _taken(file: FilePath) -> bytes:
    """All of it, unpacked."""
    try:
        # A pipe or a device would never end.
        if file.exists() and not file.is_file():
            raise UsageError(phrase("{name} is no file.", name=file.name or str(file)))
        if file.stat().st_size > _MOST:
            raise _too_large(file.name)
        data = file.read_bytes()
    except OSError as error:
        raise UsageError(
            phrase("{file} cannot be read: {reason}.", file=file, reason=reason(error))
        ) from error
    except ValueError as error:
        raise UsageError(phrase("{file} is no name of a file.", file=repr(str(file)))) from error
    return _unpacked(data, file.name) if data.startswith(_PACKED) else data


def _unpacked(data: bytes, name: str) -> bytes:
    """Of a packed file (svgz) what is in it."""
    unpacker = zlib.decompressobj(16 + zlib.MAX_WBITS)
    try:
        unpacked = unpacker.decompress(data, _MOST)
    except (zlib.error, gzip.BadGzipFile) as error:
        raise UsageError(phrase("{name} cannot be unpacked; it is broken.", name=name)) from error
    if unpacker.unconsumed_tail:
        raise _too_large(name)
    return unpacked


def _too_large(name: str) -> UsageError:
    return UsageError(
        phrase("{name} has more than {most:g} MB; that is no drawing.", name=name, most=_MOST / 1e6)
    )
