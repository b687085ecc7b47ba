"""The functions for a C program: ``python -m fraese.x4step.server FD``.

    program --"X4Load 1000 0 0 0 1000 50"--> server
            <------------"0"----------------

Started by ``c/x4step.c`` and by nobody else, on a socket of its own.

Rule 1: the end of the socket is the end of the program, whatever it died of: brake, all off.
Rule 2: Ctrl-C in the terminal is the program's business.
"""

import contextlib
import signal
import socket
import sys
from collections.abc import Callable, Mapping
from typing import Final, TextIO

from fraese.x4step import functions

_NO_KEY: Final = -1


def _getch() -> int:
    try:
        return ord(functions.getch())
    except EOFError:
        return _NO_KEY


def _clear_timer() -> int:
    functions.X4ClearTimer()
    return 0


def _delay(ms: int) -> int:
    functions.pass_ms(ms)
    return 0


#: What the program may call, by name.
CALLS: Final[Mapping[str, Callable[..., int]]] = {
    "X4Init": functions.X4Init,
    "X4ReInit": functions.X4ReInit,
    "X4Load": functions.X4Load,
    "X4Start": functions.X4Start,
    "X4Brake": functions.X4Brake,
    "X4Stop": functions.X4Stop,
    "X4GetState": functions.X4GetState,
    "X4GetSteps": functions.X4GetSteps,
    "X4MovePos": functions.X4MovePos,
    "X4MoveNeg": functions.X4MoveNeg,
    "X4BrakeCodes": lambda *codes: functions.X4BrakeCodes(codes),
    "X4LastBrakeCode": functions.X4LastBrakeCode,
    "X4ClearTimer": _clear_timer,
    "X4GetTimer": functions.X4GetTimer,
    "X4GetIn": functions.X4GetIn,
    "X4SetOut": functions.X4SetOut,
    "getch": _getch,
    "kbhit": functions.kbhit,
    "last_scan_code": functions.last_scan_code,
    "delay": _delay,
}


def serve(stream: TextIO) -> None:
    """Answer line by line, until there are no more."""
    try:
        for line in stream:
            name, *arguments = line.split()
            stream.write(f"{int(CALLS[name](*map(int, arguments)))}\n")
            stream.flush()
    except ConnectionError:
        # It died while it was being answered.
        pass
    finally:
        functions.X4ReInit()


def main(descriptor: int) -> int:
    """Serve on that socket."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with socket.socket(fileno=descriptor) as line, line.makefile("rw", encoding="ascii") as stream:
        serve(stream)
        with contextlib.suppress(OSError):
            stream.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1])))
