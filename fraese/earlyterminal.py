r"""The terminal is taken before the app is there.

    start --> taken: no echo, every key as it is --> the app's driver takes it over --> given back
                      '-- any other end -----------------------------------------------^

What the app is made of takes Python about a second to read. Until then the terminal would take
Ctrl+Q and Ctrl+S for itself, as flow control, and show every other key as text.

Rule 1: only for the app, and only a terminal whose foreground this is.
Rule 2: on every way out the terminal is as it was; after the driver has it that is the driver's.
Rule 3: Ctrl+C stays an interrupt: nothing has been done yet. Ctrl+Z and Ctrl+\ are keys, as in the
        app, since whoever is stopped or killed by them gives nothing back.
Rule 4: nothing is imported here that takes time.
"""

import contextlib
import os
import signal
from collections.abc import Sequence
from types import FrameType
from typing import Any, Final

#: Options of the app that take a value; and those that do not.
VALUED: Final = ("--config", "--state", "--open", "--trace", "--language")
PLAIN: Final = ("--fresh",)
#: They would kill the program before it gives anything back.
_KILLING: Final = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)


def starts_the_app(words: Sequence[str]) -> bool:
    """Whether these arguments name no command, and ask for no help."""
    rest = iter(words)
    return all(
        word in PLAIN
        or (word.partition("=")[0] in VALUED and ("=" in word or next(rest, None) is not None))
        for word in rest
    )


class EarlyTerminal:
    """A terminal from the first moment to the driver's."""

    def __init__(self) -> None:
        self._fd = -1
        self._before: list[Any] | None = None

    def take(self, fd: int) -> None:
        """From here on every key is left for the app; does nothing where that cannot be."""
        with contextlib.suppress(ImportError, OSError, ValueError, AttributeError):
            import termios

            with contextlib.suppress(termios.error):
                if not os.isatty(fd) or os.tcgetpgrp(fd) != os.getpgrp():
                    return
                self._before = termios.tcgetattr(fd)
                self._fd = fd
                for number in _KILLING:
                    if signal.getsignal(number) is signal.SIG_DFL:
                        signal.signal(number, self._die_of)
                termios.tcsetattr(fd, termios.TCSANOW, _early(termios, fd, self._before))

    @property
    def before(self) -> list[Any] | None:
        """Its attributes as they were, while it is taken; None: it is not."""
        return self._before

    def is_the_drivers(self) -> None:
        """Whoever draws on it gives it back."""
        self._before = None

    def give_back(self) -> None:
        """It is as it was, if nobody else has it by now."""
        before, self._before = self._before, None
        if before is not None:
            import termios

            with contextlib.suppress(OSError, termios.error):
                termios.tcsetattr(self._fd, termios.TCSANOW, before)

    def _die_of(self, number: int, frame: FrameType | None) -> None:
        self.give_back()
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)


def _early(termios: Any, fd: int, before: list[Any]) -> list[Any]:
    iflag, oflag, cflag, lflag, ispeed, ospeed, cc = before
    cc = list(cc)
    nothing = os.fpathconf(fd, "PC_VDISABLE")
    for name in ("VQUIT", "VSUSP", "VDSUSP"):
        if hasattr(termios, name):
            cc[getattr(termios, name)] = bytes([nothing])
    cc[termios.VMIN], cc[termios.VTIME] = 1, 0
    iflag &= ~(termios.IXON | termios.IXOFF | termios.ICRNL | termios.INLCR | termios.IGNCR)
    lflag &= ~(termios.ECHO | termios.ICANON | termios.IEXTEN)
    return [iflag, oflag, cflag, lflag, ispeed, ospeed, cc]


#: The one that this program was started in.
EARLY: Final = EarlyTerminal()
