"""How many lines a second pass, over the pseudo-terminal: counting characters, and one by one.

    python -m rigs.senders.throughput [--fast]

With ``--fast`` the mill takes no time, and what is measured is the protocol; without it moves of a
tenth of a millimetre, which a planner may not make longer than they are.
"""

import os
import select
import sys
import tempfile
import time
from collections import deque
from pathlib import Path
from typing import Final

from rigs.senders import program
from rigs.senders.served import served

_GRBL_BYTES: Final = 128
_LINES: Final = 5_000


class Line:
    """One open pseudo-terminal."""

    def __init__(self, path: str) -> None:
        self._fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
        self._heard = b""

    def send(self, text: str) -> None:
        os.write(self._fd, text.encode())

    def answers(self) -> list[bytes]:
        """Waits for at least one."""
        while True:
            *lines, self._heard = self._heard.split(b"\n")
            found = [line for line in lines if line.startswith((b"ok", b"error"))]
            if found:
                return found
            assert select.select([self._fd], [], [], 30)[0], "no answer for 30 s"
            self._heard += os.read(self._fd, 4096)

    def close(self) -> None:
        os.close(self._fd)


def stream(line: Line, lines: list[str], *, counts: bool) -> float:
    """Send all of them; how long until the last one was answered, s."""
    begun_s, waiting = time.monotonic(), deque[int]()
    todo = deque(text + "\n" for text in lines)
    while todo or waiting:
        room = _GRBL_BYTES - sum(waiting) if counts else (0 if waiting else _GRBL_BYTES)
        if todo and len(todo[0]) <= room:
            text = todo.popleft()
            waiting.append(len(text))
            line.send(text)
            continue
        for answer in line.answers():
            assert answer.startswith(b"ok"), answer
            waiting.popleft()
    return time.monotonic() - begun_s


def measure(folder: Path, *options: str) -> dict[str, float]:
    """Lines a second, by how they are sent."""
    found = {}
    with served(folder, *options) as server:
        line = Line(server.at[0])
        for name, counts in (("counting", True), ("one by one", False)):
            took_s = stream(line, program.lines(_LINES), counts=counts)
            found[name] = _LINES / took_s
            line.send("G4 P0\n")
            line.answers()
        line.close()
    return found


def main() -> None:
    options = [word for word in sys.argv[1:] if word == "--fast"]
    with tempfile.TemporaryDirectory() as folder:
        for name, rate in measure(Path(folder) / "machine", *options).items():
            print(f"{name:12s} {rate:8.0f} lines/s")


if __name__ == "__main__":
    main()
