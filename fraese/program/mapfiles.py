"""Where a height map is put down while it is probed: after every point, so that none is lost.

Rule 1: the first writing is waited for, and refused where it cannot be; all others are done in a
        thread of their own, since motors do not wait for a disk.
Rule 2: what is there under the name is whole at any moment. One that is replaced stays until a
        point of the new one is known.
"""

import os
import threading
from contextlib import suppress
from pathlib import Path

from fraese.errors import UsageError
from fraese.heightmap.mapfile import PartMap, encoded
from fraese.phrases import phrase, reason


class MapFile:
    """One file.

    Args:
        path: of it.

    Attributes:
        failure: why the last points are not in it, a sentence; empty: they are.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.failure = ""
        self._lock = threading.Lock()
        self._wanted: PartMap | None = None
        self._thread: threading.Thread | None = None

    def begin(self, part: PartMap) -> None:
        """Write it at once; where there is a file already, only see whether it can be.

        Raises:
            UsageError: it cannot be written.
        """
        try:
            self._write(part, replace=not self.path.exists())
        except OSError as error:
            raise UsageError(self._refusal(error)) from error

    def keep(self, part: PartMap) -> None:
        """Write it soon; what was wanted before and has not begun is no longer needed."""
        with self._lock:
            self._wanted = part
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="height map")
                self._thread.start()

    def close(self) -> None:
        """Wait until all of it is written."""
        while (thread := self._thread) is not None:
            thread.join()

    def _work(self) -> None:
        while True:
            with self._lock:
                part, self._wanted = self._wanted, None
                if part is None:
                    self._thread = None
                    return
            try:
                self._write(part)
                self.failure = ""
            except OSError as error:
                self.failure = self._refusal(error)

    def _write(self, part: PartMap, *, replace: bool = True) -> None:
        new = self.path.with_name(f"{self.path.name}.new")
        try:
            with new.open("w", encoding="utf-8") as file:
                file.write(encoded(part))
                file.flush()
                os.fsync(file.fileno())
            if replace:
                new.replace(self.path)
            else:
                new.unlink()
        except BaseException:
            with suppress(OSError):
                new.unlink(missing_ok=True)
            raise

    def _refusal(self, error: OSError) -> str:
        return phrase(
            "{path}: the height map cannot be written there: {reason}.",
            path=self.path,
            reason=reason(error),
        )
