"""What a sender has told a grbl to keep and this machine has no use for: settings, start lines.

Rule 1: what cannot be read is as if nothing had been kept; what cannot be written is refused.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from fraese.errors import ConfigError
from fraese.journal.files import replace
from fraese.phrases import phrase, reason

#: In the state folder.
FILE_NAME: Final = "serve.json"
#: How many start lines there are.
START_LINES: Final = 2
_MOST_BYTES: Final = 100_000


class Store:
    """Kept in a file.

    Args:
        path: of it; None: kept nowhere.

    Attributes:
        settings: numbers and values.
        start_lines: done after every reset; empty: none.
        info: what ``$I`` shows.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        kept = self._read()
        settings, lines = kept.get("settings"), kept.get("start_lines")
        self.settings: dict[int, float] = _numbers(settings) if isinstance(settings, dict) else {}
        self.start_lines: list[str] = [""] * START_LINES
        for place, line in enumerate(lines[:START_LINES] if isinstance(lines, list) else ()):
            self.start_lines[place] = line if isinstance(line, str) else ""
        info = kept.get("info", "")
        self.info = info if isinstance(info, str) else ""

    def _read(self) -> Mapping[str, Any]:
        try:
            if self._path is None or self._path.stat().st_size > _MOST_BYTES:
                return {}
            kept = json.loads(self._path.read_text("utf-8"))
        except (OSError, ValueError):
            return {}
        return kept if isinstance(kept, dict) else {}

    def keep(self) -> None:
        """Write it all.

        Raises:
            ConfigError: if that cannot be done.
        """
        if self._path is None:
            return
        values = {
            "settings": {str(number): value for number, value in self.settings.items()},
            "start_lines": self.start_lines,
            "info": self.info,
        }
        try:
            replace(self._path, json.dumps(values, indent=1).encode())
        except OSError as error:
            raise ConfigError(
                phrase(
                    "{path}: cannot be written: {reason}.", path=self._path, reason=reason(error)
                )
            ) from error


def _numbers(kept: Mapping[str, Any]) -> dict[int, float]:
    return {
        int(key): float(value)
        for key, value in kept.items()
        if key.isdigit() and isinstance(value, int | float)
    }
