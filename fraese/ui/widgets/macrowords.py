"""Macros in few words, where there is no room for their buttons."""

from collections.abc import Sequence
from typing import Final

from rich.cells import cell_len

from fraese.plaintext import plain
from fraese.ui.keyrows import Row

#: So many columns are free in the line of the job.
_ROOM: Final = 34


def few_words(macros: Sequence[Row], palette: str, room: int = _ROOM) -> str:
    """As many as there is room for, with their keys; all of them are in the palette.

    Args:
        macros: their rows.
        palette: its key.
        room: columns.
    """
    words = [plain(f"{row.shown} {row.title}".strip()) for row in macros]
    for count in range(len(words), -1, -1):
        left_out = count < len(words) or not all(row.shown for row in macros)
        parts = [*words[:count], *([f"… {palette}"] if left_out else [])]
        text = "  ".join(parts)
        if cell_len(text) <= room:
            return text
    return ""
