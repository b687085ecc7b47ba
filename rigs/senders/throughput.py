"""How many lines a second pass, over the pseudo-terminal: counting characters, and one by one.

    python -m rigs.senders.throughput [--fast] [--grbl grbl.elf]

With ``--fast`` the mill takes no time, and what is measured is the protocol; without it moves of a
tenth of a millimetre, which a planner may not make longer than they are. Beside it, in the same
run, stands what passes a line of 115200 baud to a simulated ATmega328P that answers at once
(``okline.c``): more than any grbl can do; and a grbl itself, where somebody has an image of one.
"""

import os
import select
import sys
import tempfile
import time
import tty
from collections import deque
from pathlib import Path
from typing import Final

from rigs.avr import build
from rigs.avr.host import SimHost
from rigs.senders import program
from rigs.senders.served import served

_GRBL_BYTES: Final = 128
_LINES: Final = 5_000


class Line:
    """One open pseudo-terminal."""

    def __init__(self, path: str) -> None:
        self._fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self._fd)
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

    def wait_for(self, word: bytes) -> None:
        """Until this was said."""
        while word not in self._heard:
            assert select.select([self._fd], [], [], 30)[0], "no greeting for 30 s"
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


def _both(line: Line) -> dict[str, float]:
    """Lines a second, by how they are sent."""
    found = {}
    for name, counts in (("counting", True), ("one by one", False)):
        found[name] = _LINES / stream(line, program.lines(_LINES), counts=counts)
        line.send("G4 P0\n")
        line.answers()
    return found


def measure(folder: Path, *options: str) -> dict[str, float]:
    """Of ``fraese serve``."""
    with served(folder, *options) as server:
        line = Line(server.at[0])
        found = _both(line)
        line.close()
    return found


def measure_avr(image: Path, folder: Path, greeting: bytes = b"") -> dict[str, float]:
    """Of what runs in a simulated microcontroller, behind 115200 baud.

    Args:
        image: of it.
        folder: for the rig.
        greeting: it says so when it is ready; empty: it says nothing.
    """
    folder.mkdir()
    with SimHost(image, folder, ("--any-baud",)) as host:
        line = Line(host.port)
        if greeting:
            line.wait_for(greeting)
            line.send("$X\n")
            line.answers()
        else:
            time.sleep(2)
        found = _both(line)
        line.close()
    return found


def main() -> None:
    words = sys.argv[1:]
    grbl = Path(words[words.index("--grbl") + 1]) if "--grbl" in words else None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rates = {"fraese serve": measure(folder / "machine", *({"--fast"} & set(words)))}
        if absent := build.missing():
            print(f"beside it: nothing, {absent}")
        else:
            image = build.firmware(Path(__file__).with_name("okline.c"))
            rates["115200 baud, simulated"] = measure_avr(image, folder / "line")
            if grbl is not None:
                rates["grbl, simulated"] = measure_avr(grbl, folder / "grbl", b"Grbl")
    for who, found in rates.items():
        print(f"{who:24s}" + ", ".join(f"{how} {rate:.0f} lines/s" for how, rate in found.items()))


if __name__ == "__main__":
    main()
