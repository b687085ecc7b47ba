"""The lines that were typed, kept from one day to the next: the latest last."""

from contextlib import suppress
from pathlib import Path
from typing import Final

from fraese.plaintext import plain

MOST_LINES: Final = 200


class LineHistory:
    """Lines to go back to.

    Args:
        file: where they are kept; None: nowhere. What cannot be read or written is no fault: a
            history is a comfort.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self.lines: list[str] = []
        if file is not None:
            with suppress(OSError, UnicodeDecodeError):
                text = file.read_text(encoding="utf-8")
                self.lines = [plain(line) for line in text.splitlines() if line][-MOST_LINES:]
        # How far back one is; 0: at the line that is being typed.
        self._back = 0

    def add(self, line: str) -> None:
        """This one was typed; the same one is kept once, as the latest."""
        self._back = 0
        self.lines = [*(old for old in self.lines if old != line), line][-MOST_LINES:]
        if self._file is not None:
            with suppress(OSError):
                self._file.parent.mkdir(parents=True, exist_ok=True)
                self._file.write_text("\n".join(self.lines) + "\n", encoding="utf-8")

    def back(self, by: int) -> str:
        """The line so many further back; empty: the one that is being typed."""
        self._back = min(max(self._back + by, 0), len(self.lines))
        return self.lines[-self._back] if self._back else ""
