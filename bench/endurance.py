"""A long life on the simulated mill: does anything grow, or slow down?

Run: python -m bench.endurance [scale]

With scale 1 (default): 100,000 jogs, 10,000 stops at random moments, 1,000 programs, and eight
hours of machine time in long programs; 0.01 is a hundredth of all. The state is kept in a folder of
its own, as by the app. After every twentieth part memory and processor time are noted; what is
said at the end is the last quarter beside the second one: the first one fills caches. After each
part counters and carriages are compared.

Exit code 1: something grew by more than 2 MB and 2 %, slowed down by more than a fifth, or a step
was lost.
"""

import random
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.state import Status
from fraese.program.program import open_program

_PARTS: Final = 20
_MOST_GROWTH_KB: Final = 2048
_MOST_GROWTH: Final = 1.02
_MOST_SLOWER: Final = 1.2
_HOURS: Final = 8
_SEED: Final = 7


@dataclass(frozen=True)
class Part:
    """What was seen in one twentieth.

    Attributes:
        seconds: of processor time that it took.
        machine_s: machine time that passed.
        memory_kb: resident at its end.
    """

    seconds: float
    machine_s: float
    memory_kb: int


class Life:
    """One machine, and what is done with it.

    Args:
        folder: for its state and its programs.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._random = random.Random(_SEED)
        self.plant: Plant = assemble(Config(), state=folder / "state")
        self._controller = self.plant.controller
        self._controller.home()
        self._run(Status.OK)

    def _run(self, *wanted: Status) -> None:
        ended = self._controller.run()
        if ended not in wanted:
            raise SystemExit(f"ended {ended.value}: {self._controller.state().message}")
        self._controller.acknowledge()
        self._controller.idle(0.0)

    def jog(self) -> None:
        """One way and, after two at most, back again."""
        axis = self._random.choice("xyz")
        at = self._controller.position.position_steps["xyz".index(axis)]
        sign = 1 if at < 0 or (axis != "z" and at < 2000) else -1
        self._controller.jog(axis, sign * self._random.choice((0.005, 0.1, 1.0)), clamp=True)
        self._run(Status.OK)

    def stop(self) -> None:
        """A move that is braked or, one in ten, held and gone on with first."""
        controller, ticks = self._controller, self._random.randrange(1, 12)
        holds = self._random.random() < 0.1
        targets = {"x": self._random.uniform(0, 290), "y": self._random.uniform(0, 190)}
        controller.move_to(targets, machine_coordinates=True)
        slices = 0

        def press() -> None:
            nonlocal slices
            slices += 1
            if holds and slices == ticks:
                controller.hold()
            elif holds and slices == ticks + 20:
                controller.resume()
            elif not holds and slices == ticks:
                controller.cancel()

        controller.set_break_key(press)
        self._run(Status.OK, Status.CANCEL)
        controller.set_break_key(lambda: None)

    def program(self) -> None:
        """One of ten files, checked and run."""
        number = self._random.randrange(10)
        path = self._folder / f"part{number}.ngc"
        if not path.exists():
            path.write_text(_outline(10 + number, number), "utf-8")
        program = open_program(path)
        program.check(self._controller)
        program.start(self._controller)
        self._run(Status.OK)

    def hours(self, minutes: float) -> None:
        """One program that takes so long."""
        path = self._folder / "long.ngc"
        # 3 mm/s on a way of 100 mm there and 100 mm back.
        rounds = max(1, round(minutes * 60 * 3 / 200))
        lines = "".join(f"X{100 + n % 7 * 0.01:.2f} Y50\nX0 Y50\n" for n in range(rounds))
        path.write_text(f"G21 G90\nG1 F180\n{lines}M2\n", "utf-8")
        open_program(path).start(self._controller)
        self._run(Status.OK)

    def require_whole(self) -> None:
        """Counters and carriages agree.

        Raises:
            SystemExit: if they do not.
        """
        state = self._controller.state()
        apart = [
            abs(counted - true)
            for counted, true in zip(state.position_mm, state.carriages_mm, strict=True)
        ]
        if max(apart) > 1e-6 or any(state.lost_steps):
            raise SystemExit(f"counted {state.position_mm}, carriages {state.carriages_mm}")


def _outline(points: int, seed: int) -> str:
    chosen = random.Random(seed)
    moves = [
        f"G1 X{chosen.uniform(1, 60):.3f} Y{chosen.uniform(1, 60):.3f}"
        f" F{chosen.choice((900, 2400))}"
        for _ in range(points)
    ]
    return "\n".join(["G21 G90", "G0 Z-1", *moves, "G2 X30 Y30 R40", "G0 Z0", "M2", ""])


def _memory_kb() -> int:
    for line in Path("/proc/self/status").read_text("ascii").splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    return 0


def _repeated(life: Life, once: Callable[[], None], times: int) -> list[Part]:
    parts = []
    for _ in range(_PARTS):
        since_s, since_ns = time.process_time(), life.plant.clock.now_ns()
        for _ in range(max(1, times // _PARTS)):
            once()
        machine_s = (life.plant.clock.now_ns() - since_ns) / 1e9
        parts.append(Part(time.process_time() - since_s, machine_s, _memory_kb()))
        life.require_whole()
    return parts


def _judge(name: str, parts: list[Part]) -> bool:
    """A line for what was done; whether nothing grew and nothing slowed down."""
    quarter = len(parts) // 4
    second, last = parts[quarter : 2 * quarter], parts[-quarter:]
    memory = [statistics.mean(part.memory_kb for part in some) for some in (second, last)]
    seconds = [statistics.median(part.seconds for part in some) for some in (second, last)]
    grown = memory[1] - memory[0] > _MOST_GROWTH_KB and memory[1] > memory[0] * _MOST_GROWTH
    slower = seconds[1] > seconds[0] * _MOST_SLOWER
    total_s, machine_s = sum(p.seconds for p in parts), sum(p.machine_s for p in parts)
    print(
        f"{'BAD' if grown or slower else 'ok ':3} {name:18} {total_s:7.1f} s"
        f"  machine {machine_s / 3600:6.2f} h"
        f"  memory {memory[0] / 1024:6.1f} -> {memory[1] / 1024:6.1f} MB"
        f"  a twentieth {seconds[0]:6.2f} -> {seconds[1]:6.2f} s",
        flush=True,
    )
    return not (grown or slower)


def main(scale: float) -> int:
    """All of it; the exit code."""
    with tempfile.TemporaryDirectory() as folder:
        life = Life(Path(folder))
        minutes = _HOURS * 60 * scale / _PARTS
        good = [
            _judge(name, _repeated(life, once, round(times * scale)))
            for name, once, times in (
                ("jogs", life.jog, 100_000),
                ("stops", life.stop, 10_000),
                ("programs", life.program, 1_000),
                ("hours", lambda: life.hours(minutes), _PARTS),
            )
        ]
        life.plant.close()
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 1.0))
