"""``python -m fraese`` and the ``fraese`` command (SMCMAIN).

Rule 1: interrupts are looked for before the command line is read: until it is there nothing has
        been done, and a traceback would help nobody.
Rule 2: the app has its terminal from the first moment, see ``earlyterminal``.
"""

import os
import signal
import sys
from types import FrameType
from typing import Final

from fraese.earlyterminal import EARLY, starts_the_app

_INTERRUPTED: Final = 130


def _leave_at_once(number: int, frame: FrameType | None) -> None:
    EARLY.give_back()
    os._exit(_INTERRUPTED)


def main() -> None:
    """Entry point."""
    # Where interrupts are ignored they stay so.
    waits = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if waits:
        signal.signal(signal.SIGINT, _leave_at_once)
    if starts_the_app(sys.argv[1:]) and os.isatty(1):
        EARLY.take(0)
    try:
        from fraese.cli import main as command_line

        if waits:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        command_line()
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
    finally:
        EARLY.give_back()


if __name__ == "__main__":
    main()
