"""``python -m fraese`` and the ``fraese`` command (SMCMAIN).

Rule 1: interrupts are looked for before the command line is read: until it is there nothing has
        been done, and a traceback would help nobody.
"""

import os
import signal
import sys
from types import FrameType
from typing import Final

_INTERRUPTED: Final = 130


def _leave_at_once(number: int, frame: FrameType | None) -> None:
    os._exit(_INTERRUPTED)


def main() -> None:
    """Entry point."""
    # Where interrupts are ignored they stay so.
    waits = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if waits:
        signal.signal(signal.SIGINT, _leave_at_once)
    from fraese.cli import main as command_line

    try:
        if waits:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        command_line()
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)


if __name__ == "__main__":
    main()
