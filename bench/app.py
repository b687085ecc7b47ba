"""What the app costs: start-up, key latency, idle load.

Run: python bench/app.py [journal]

The app runs in a pseudo-terminal of its own, on a simulated mill that keeps step with the wall.

start       from the start of the process to the first complete picture on the terminal
key         from writing a key into the terminal to the first register write of the move: without a
            journal, with one, and with one whose mark "in motion" was lifted before each key
stop        from writing the stop key until the last register write, ramp included
idle        share of a core that the process takes while nobody touches it
"""

import fcntl
import os
import pty
import select
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time
from collections.abc import Sequence
from pathlib import Path

#: Where the child tells when it wrote registers: one line of nanoseconds a write.
_WRITES_FD = 3
_KEYS = 20
#: After so long at standstill the mark is lifted.
_AT_REST_S = 1.6
_RIGHT, _LEFT = b"\x1b[C", b"\x1b[D"
#: Where the child has its journal.
_STATE = "BENCH_STATE"
_STOP_KEYS = (b"\x1b", b"\x03")
_IDLE_S = 10.0
_PATIENCE_NS = 5_000_000_000
#: The last word that is drawn: the end of the footer.
_LAST_WORD = b"Hold"


def child() -> None:
    """The app, with a port that tells the time of every write to the data register."""
    from unittest.mock import patch

    from fraese.assembly import drivers
    from fraese.assembly import plant as plant_module
    from fraese.assembly.simulation import simulated_mill
    from fraese.config import Config
    from fraese.motor.ports.sim import SimulatedMill
    from fraese.motor.seams import Clock
    from fraese.ui import FraeseApp
    from fraese.ui.programs import Program

    def no_program(path: Path) -> Program:
        raise NotImplementedError

    def telling(config: Config, clock: Clock) -> SimulatedMill:
        mill = simulation(config, clock)
        write = mill.write_data

        def write_data(value: int) -> None:
            os.write(_WRITES_FD, b"%d\n" % time.monotonic_ns())
            write(value)

        mill.write_data = write_data
        return mill

    simulation = simulated_mill
    with patch.object(drivers, "simulated_mill", telling):
        state = Path(os.environ[_STATE]) if os.environ.get(_STATE) else None
        plant = plant_module.assemble(Config(), clock="paced", state=state)
    FraeseApp(plant.controller, open_program=no_program).run()
    plant.close()


class Terminal:
    """The app in a pseudo-terminal.

    Args:
        state: folder of its journal; empty: it keeps none.
        arguments: what Python is started with.
        size: rows and columns.
    """

    def __init__(
        self,
        state: str = "",
        *,
        arguments: Sequence[str] = (__file__, "child"),
        size: tuple[int, int] = (24, 80),
    ) -> None:
        self.begun_s = time.monotonic()
        self._writes, told = os.pipe()
        pid, self.input = pty.fork()
        if pid == 0:
            os.dup2(told, _WRITES_FD)
            os.environ["TERM"] = "xterm-256color"
            os.environ[_STATE] = state
            os.execv(sys.executable, [sys.executable, *arguments])
        self.pid = pid
        fcntl.ioctl(self.input, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
        os.set_blocking(self._writes, False)
        self.seen = b""

    def read(self, seconds: float, until: bytes = b"") -> bool:
        """Take what is drawn for so long, or until this was drawn."""
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            if select.select([self.input], [], [], left_s)[0]:
                try:
                    self.seen += os.read(self.input, 65536)
                except OSError:  # the other side has closed
                    return False
                if until and until in self.seen:
                    return True
        return False

    def told_lines(self) -> list[str]:
        """What the child has told since the last call."""
        text = b""
        try:
            while part := os.read(self._writes, 1 << 20):
                text += part
        except BlockingIOError:
            pass
        return text.decode().split()

    def writes_ns(self) -> list[int]:
        """Times of the register writes since the last call."""
        return [int(line) for line in self.told_lines()]

    def key_latency_ms(self, key: bytes, rest_s: float = 0.2) -> float:
        """Press a key and wait for the first register write."""
        self.read(rest_s)
        self.writes_ns()
        at_ns = time.monotonic_ns()
        os.write(self.input, key)
        writes_ns: list[int] = []
        while not writes_ns and time.monotonic_ns() < at_ns + _PATIENCE_NS:
            self.read(0.25)
            writes_ns = self.writes_ns()
        return (writes_ns[0] - at_ns) / 1e6

    def stop_latency_ms(self, key: bytes) -> float:
        """Stop in the middle of a jog at 2000 steps/s; the ramp takes 60 ms of it."""
        os.write(self.input, b"\x1b[C")
        self.read(0.5)
        at_ns = time.monotonic_ns()
        os.write(self.input, key)
        self.read(0.6)
        # The last three switch the motors off.
        return (self.writes_ns()[-4] - at_ns) / 1e6

    def cpu_s(self) -> float:
        """Processor time so far."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def close(self) -> None:
        """Leave by signal, as a session that ends does."""
        os.kill(self.pid, signal.SIGTERM)
        self.read(2)
        os.waitpid(self.pid, 0)


def first_picture_s() -> float:
    """Start the app once."""
    terminal = Terminal()
    try:
        assert terminal.read(20, _LAST_WORD), "no picture"
        return time.monotonic() - terminal.begun_s
    finally:
        terminal.close()


def journal_costs() -> None:
    """Key to step without a journal and with one, key by key in turn."""
    with tempfile.TemporaryDirectory(dir=Path.home()) as folder:
        terminals = [Terminal(), Terminal(f"{folder}/1"), Terminal(f"{folder}/2")]
        rests_s = (0.2, 0.2, _AT_REST_S)
        times_ms: list[list[float]] = [[], [], []]
        try:
            for terminal in terminals:
                assert terminal.read(60, _LAST_WORD), "no picture"
                terminal.read(1)
            for number in range(_KEYS):
                key = _RIGHT if number % 2 == 0 else _LEFT
                for terminal, rest_s, times in zip(terminals, rests_s, times_ms, strict=True):
                    times.append(terminal.key_latency_ms(key, rest_s))
        finally:
            for terminal in terminals:
                terminal.close()
    for name, times in zip(
        ("no journal", "journal", "journal, mark lifted"), times_ms, strict=True
    ):
        print(
            f"key to first write, {name:22} {statistics.median(times):.1f} ms (median of {_KEYS}),"
            f" {max(times):.1f} ms (worst)"
        )


def main() -> None:
    """Print the figures."""
    journal_costs()
    starts_s = [first_picture_s() for _ in range(3)]
    terminal = Terminal()
    try:
        assert terminal.read(20, _LAST_WORD), "no picture"
        terminal.read(1)
        keys_ms = [terminal.key_latency_ms(b"\x1b[C") for _ in range(_KEYS)]
        os.write(terminal.input, b"5")
        terminal.read(0.2)
        stops_ms = [[terminal.stop_latency_ms(key) for _ in range(3)] for key in _STOP_KEYS]
        terminal.read(1)
        before_s = terminal.cpu_s()
        os.write(terminal.input, b"\x1b[D" * 2)
        terminal.read(2)
        moving = (terminal.cpu_s() - before_s) / 2
        terminal.read(1)
        before_s = terminal.cpu_s()
        terminal.read(_IDLE_S)
        idle = (terminal.cpu_s() - before_s) / _IDLE_S
    finally:
        terminal.close()
    load = subprocess.run(["uptime"], capture_output=True, text=True).stdout.strip()
    print(f"start to first picture    {min(starts_s):.2f} s (best of {len(starts_s)})")
    print(f"key to first write        {statistics.median(keys_ms):.1f} ms (median of {_KEYS})")
    print(f"                          {max(keys_ms):.1f} ms (worst)")
    for name, times_ms in zip(("Escape", "Ctrl+C"), stops_ms, strict=True):
        print(f"stop by {name} to standstill {max(times_ms):.0f} ms (worst of 3, ramp 60 ms)")
    print(f"moving at 2000 steps/s    {moving:.1%} of a core, simulated mill and display together")
    print(f"idle                      {idle:.1%} of a core over {_IDLE_S:g} s")
    print(f"machine                   {load.partition('load')[2] and load[load.index('load') :]}")


if __name__ == "__main__":
    {"child": child, "journal": journal_costs}.get("".join(sys.argv[1:]), main)()
