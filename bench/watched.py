"""The app with a large program open and its path drawn: how soon it brakes, and what it costs.

Run: python -m bench.watched [LINES]

The app runs as a person starts it, in a pseudo-terminal of 120x40, on a simulated mill that keeps
step with the wall; the program draws circles at 10 mm/s, 2000 half-steps a second on one axis.

brake       from writing the stop key until the motors' core is asked to brake, and until the last
            step, of which the ramp takes 60 ms; while somebody reads the terminal, and after two
            seconds in which nobody did
moving      share of a core while the program runs and its path is drawn, and pictures a second
idle        share of a core in each view while nothing moves
"""

import itertools
import math
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

from bench.app import Terminal

LINES: Final = 100_000
_SIZE: Final = (40, 120)
_STOPS: Final = 5
_STOP_KEYS: Final = {"Escape": b"\x1b", "Ctrl+C": b"\x03"}
_VIEWS: Final = {
    "Move": b"\x1bOQ", "Program": b"\x1bOR", "Calibrate": b"\x1bOS", "Bench": b"\x1b[15~",
    "Log": b"\x1b[17~", "Settings": b"\x1b[18~",
}  # fmt: skip
#: A picture begins with this, where the terminal takes pictures whole.
_PICTURE: Final = b"\x1b[?2026h"
#: A terminal says so.
_TAKES_PICTURES: Final = b"\x1b[?2026;2$y"
_WATCHED_S: Final = 10.0
_PATIENCE_S: Final = 120.0
#: Where the child tells what happened: a letter and nanoseconds a line.
_TOLD_FD: Final = 3
_TELLING: Final = "BENCH_TELLING"


def program(lines: int) -> str:
    """Circles in short lines, so large that a run does not come to its end."""
    points = (
        f"G1 X{50 + 40 * math.cos(angle / 200):.3f} Y{50 + 40 * math.sin(angle / 200):.3f}"
        for angle in range(lines)
    )
    return "\n".join(["G21 G90 F600", *points, "M2", ""])


def child(folder: str) -> None:
    """The app; it tells of every byte for the motors, and of being asked to brake."""
    from unittest.mock import patch

    from fraese.assembly import drivers, simulation
    from fraese.cli.shared import Drive
    from fraese.cli.theapp import make_app
    from fraese.config import Config
    from fraese.motor.core import MotorCore
    from fraese.motor.ports.sim import SimulatedMill
    from fraese.motor.seams import Clock

    def tell(letter: str) -> None:
        os.write(_TOLD_FD, f"{letter}{time.monotonic_ns()}\n".encode())

    brake, simulated_mill = MotorCore.brake, simulation.simulated_mill

    def telling_brake(core: MotorCore) -> None:
        tell("b")
        brake(core)

    def telling(config: Config, clock: Clock) -> SimulatedMill:
        mill = simulated_mill(config, clock)
        write = mill.write_data

        def write_data(value: int) -> None:
            tell("w")
            write(value)

        mill.write_data = write_data
        return mill

    if os.environ.get(_TELLING):
        patch.object(MotorCore, "brake", telling_brake).start()
        patch.object(drivers, "simulated_mill", telling).start()
    on = Drive(config=None, state=Path(folder) / "state")
    plant = on.plant("paced")
    app = make_app(plant, Path(folder) / "large.ngc", on)
    app.run()
    plant.close()


class Watched(Terminal):
    """The app in a terminal, with the program open.

    Args:
        folder: where the program is.
        telling: it says when it writes and when it brakes; costs it some time.
    """

    def __init__(self, folder: str, *, telling: bool = False) -> None:
        os.environ[_TELLING] = "1" if telling else ""
        super().__init__(arguments=("-m", "bench.watched", "child", folder), size=_SIZE)
        self._telling = telling

    def wait_for(self, words: bytes) -> None:
        """Until this is drawn, after what was drawn before."""
        self.seen = b""
        assert self.read(_PATIENCE_S, words), (words, self.seen[-500:])

    def type(self, keys: bytes) -> int:
        """Press keys; when, ns."""
        at_ns = time.monotonic_ns()
        os.write(self.input, keys)
        return at_ns

    def start(self) -> None:
        """Run the program from its dialog, and let it come to speed."""
        self.type(b"s")
        self.wait_for(b"Frame first")
        self.read(1)
        self.type(b"\r")
        until_s = time.monotonic() + _PATIENCE_S
        while self._telling and not any(letter == "w" for letter, _ in self.told()):
            assert time.monotonic() < until_s, "nothing moves"
            self.read(0.1)
        self.read(3)

    def stop_ms(self, key: bytes, *, unread_s: float) -> tuple[float, float]:
        """From the key to the request, and to the last step.

        Args:
            key: that stops.
            unread_s: nobody reads for so long before it is pressed.
        """
        time.sleep(unread_s)
        self.told()
        at_ns = self.type(key)
        time.sleep(0.4) if unread_s else self.read(0.4)
        told = self.told()
        brakes = [ns for letter, ns in told if letter == "b" and ns >= at_ns]
        writes = [ns for letter, ns in told if letter == "w" and ns >= at_ns]
        gap = next(
            (before for before, after in itertools.pairwise(writes) if after - before > 50_000_000),
            writes[-1],
        )
        return (brakes[0] - at_ns) / 1e6, (gap - at_ns) / 1e6

    def watched(self) -> tuple[float, float]:
        """Share of a core and pictures a second, for some seconds."""
        self.seen, before_s = b"", self.cpu_s()
        self.read(_WATCHED_S)
        return (self.cpu_s() - before_s) / _WATCHED_S, self.seen.count(_PICTURE) / _WATCHED_S

    def told(self) -> list[tuple[str, int]]:
        """What the child has told since the last call."""
        return [(line[0], int(line[1:])) for line in self.told_lines()]


def stops(folder: str) -> None:
    """Key to braking."""
    app = Watched(folder, telling=True)
    try:
        app.wait_for(b"Start it with s")
        for name, key in _STOP_KEYS.items():
            for unread_s in (0.0, 2.0):
                times = []
                for _ in range(_STOPS):
                    app.start()
                    times.append(app.stop_ms(key, unread_s=unread_s))
                    app.read(1.5)
                    app.type(b"\x1b")
                    app.read(1.5)
                asked, still = zip(*times, strict=True)
                print(
                    f"{name:8} {'unread' if unread_s else 'read':8}"
                    f" asked to brake {statistics.median(asked):6.1f} ms (worst {max(asked):.1f}),"
                    f" last step {statistics.median(still):6.1f} ms (worst {max(still):.1f})"
                )
    finally:
        app.close()


def shares(folder: str) -> None:
    """Shares of a core."""
    app = Watched(folder)
    try:
        app.wait_for(b"Start it with s")
        app.type(_TAKES_PICTURES)
        app.start()
        app.read(3)
        share, pictures = app.watched()
        print(f"moving, path drawn   {share:6.1%} of a core, {pictures:.1f} pictures a second")
        app.type(b"\x1b")
        app.read(2)
        for name, key in _VIEWS.items():
            app.type(key)
            app.read(2)
            share, _ = app.watched()
            print(f"idle, {name:14} {share:6.1%}")
    finally:
        app.close()


def main(lines: int = LINES) -> None:
    """Print the figures."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "large.ngc").write_text(program(lines))
        stops(folder)
        shares(folder)
    print(f"load {os.getloadavg()[0]:.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["child"]:
        child(sys.argv[2])
    else:
        main(*map(int, sys.argv[1:]))
