"""What ports behind a device file have in common: how they end."""

import os
from contextlib import suppress
from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.phrases import phrase, reason

#: A descriptor that is none: every call with it is refused.
_CLOSED: Final = 1 << 30


class HeldFile:
    """A device file that is held until it is given back.

    Args:
        name: of the port, as a sentence begins.
        fd: its descriptor.
    """

    def __init__(self, name: str, fd: int) -> None:
        self._name = name
        self._fd = fd

    def close(self) -> None:
        """Give it back. What is on the pins stays there. Safe to call twice."""
        fd, self._fd = self._fd, _CLOSED
        if fd == _CLOSED:
            return
        # Linux takes it back even where it complains.
        with suppress(OSError):
            self._give_back(fd)
        with suppress(OSError):
            os.close(fd)

    def _give_back(self, fd: int) -> None:
        """What must be done before it is closed."""

    def _gone(self, error: OSError) -> PortError:
        """Why an access failed."""
        if self._fd == _CLOSED:
            return PortError(phrase("{name} is used after it was given back.", name=self._name))
        return PortError(
            phrase(
                "{name} does not answer any more: {reason}; position and motor currents are"
                " unknown, switch the motors' supply off.",
                name=self._name,
                reason=reason(error),
            ),
            alarms.PORT_LOST,
        )
