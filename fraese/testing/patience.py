"""How long a test waits for what no machine time passes for.

Only a test that fails takes so long, or a computer that is busy with something else.
"""

import time
from typing import Final

from fraese.testing.failures import TookTooLong

REAL_S: Final = 60.0


class Patience:
    """Runs out.

    Args:
        what: is waited for, or done.
        limit_s: real time; None: as long as usual.
    """

    def __init__(self, what: str, limit_s: float | None = None) -> None:
        self._what = what
        self._limit_s = REAL_S if limit_s is None else limit_s
        self._until_s = time.monotonic() + self._limit_s

    def require(self) -> None:
        """Go on.

        Raises:
            TookTooLong: not any more.
        """
        if time.monotonic() > self._until_s:
            raise TookTooLong(self._what, self._limit_s, "real")
