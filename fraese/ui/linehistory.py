"""The lines that were typed, kept from one day to the next: the latest last."""

import os
from contextlib import suppress
from pathlib import Path
from typing import Final

from fraese.errors import ConfigError
from fraese.journal.files import make_folder, open_plain, read_all, replace

MOST_LINES: Final = 200
_MOST_BYTES: Final = 1 << 18
#: Nobody types more.
_LONGEST: Final = 500


class LineHistory:
    """Lines to go back to.

    Args:
        file: where they are kept; None: nowhere. What cannot be read or written is no fault: a
            history is a comfort. What is no text in it is left out, what is no file never opened.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self.lines: list[str] = []
        if file is not None:
            with suppress(OSError, ConfigError):
                text = _content(file).decode("utf-8", "ignore")
                lines = [line.strip() for line in text.splitlines()]
                self.lines = [line for line in lines if _was_typed(line)][-MOST_LINES:]
        # How far back one is; 0: at the line that is being typed.
        self._back = 0

    def add(self, line: str) -> None:
        """This one was typed; the same one is kept once, as the latest."""
        self._back = 0
        self.lines = [*(old for old in self.lines if old != line), line][-MOST_LINES:]
        if self._file is not None:
            with suppress(OSError, ConfigError):
                make_folder(self._file.parent)
                replace(self._file, ("\n".join(self.lines) + "\n").encode("utf-8", "replace"))

    def back(self, by: int) -> str:
        """The line so many further back; empty: the one that is being typed."""
        self._back = min(max(self._back + by, 0), len(self.lines))
        return self.lines[-self._back] if self._back else ""


def _was_typed(line: str) -> bool:
    return 0 < len(line) <= _LONGEST and line.isprintable()


def _content(file: Path) -> bytes:
    """What stands in it; of a very long one its beginning.

    Raises:
        ConfigError: if it is no plain file.
        OSError: if it cannot be read.
    """
    fd = open_plain(file, os.O_RDONLY)
    if fd is None:
        return b""
    try:
        return read_all(fd, _MOST_BYTES)
    finally:
        os.close(fd)
