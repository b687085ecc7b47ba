"""Which programs were opened last: a list in the state folder, newest first.

Rule 1: it is a convenience: what cannot be read is an empty list, what cannot be written is let go.
"""

import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Final

from fraese.errors import ConfigError
from fraese.journal.files import make_folder, open_plain, read_all, replace

_NAME: Final = "recent.json"
_MOST: Final = 20
_MOST_BYTES: Final = 1 << 17


class RecentPrograms:
    """Files that were opened, newest first.

    Args:
        folder: of the state.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / _NAME

    def paths(self) -> list[Path]:
        """All of them, also those that are gone."""
        with suppress(OSError, ValueError, RecursionError, ConfigError):
            fd = open_plain(self._path, os.O_RDONLY)
            if fd is None:
                return []
            try:
                found = json.loads(read_all(fd, _MOST_BYTES))
            finally:
                os.close(fd)
            if isinstance(found, list):
                return [Path(name) for name in found[:_MOST] if isinstance(name, str) and name]
        return []

    def add(self, path: Path) -> None:
        """This one was opened just now."""
        with suppress(OSError, ValueError, ConfigError):
            whole = Path(os.path.abspath(path))
            names = [str(whole), *(str(each) for each in self.paths() if each != whole)]
            make_folder(self._path.parent)
            replace(self._path, json.dumps(names[:_MOST], indent=1).encode())
