"""Motions as programs make them: a path, and perhaps a brake or a stop at some moment of it.

    python -m tests.x4step.motions PORT MOTIONS

drives them (a JSON list) on a real port, in virtual time, and prints the steps of each; it runs
under the preloaded fake port.
"""

import json
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.config.x4step import LptConfig
from fraese.motor.core import MotorCore
from fraese.motor.ports.recorder import Recorder
from fraese.motor.seams import Port
from fraese.motor.switches import NO_SWITCH
from fraese.x4step import X4Step
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.lpt import Opened, x4step_card
from fraese.x4step.paths import path
from fraese.x4step.surroundings import Surroundings
from fraese.x4step.testing import StageClock

Steps = tuple[int, ...]


class Motion(NamedTuple):
    """A path and its end.

    Attributes:
        way: steps of the four axes.
        freq: Hz.
        ramp: ms.
        end: "brake" or "stop"; empty: it is driven to its target.
        part: of its time, when that comes; from 1 on it may come too late.
    """

    way: Steps
    freq: int
    ramp: int
    end: str = ""
    part: float = 0.0

    def blocks(self) -> list[Block]:
        """What it is for the driver."""
        return list(path(self.way, self.freq, self.ramp))

    def duration_s(self) -> float:
        """How long it takes to its target."""
        return sum(block.duration_cycles() for block in self.blocks()) / 16e6


@st.composite
def motions(
    draw: st.DrawFn, freqs: tuple[int, int] = (10, 20_000), ends: tuple[str, ...] = ("",)
) -> Motion:
    """Any path that X4Load takes, of some seconds at most."""
    freq = draw(st.integers(*freqs))
    ramp = draw(st.sampled_from([0, 1]) | st.integers(0, min(1000, freq)))
    just = max(1, min(600, freq * ramp // 1000 + draw(st.integers(-3, 3))))
    most = draw(st.sampled_from([1, 2, 4, 7, 30, 120, just, 600]))
    way = [draw(st.integers(-most, most)) for _ in range(4)]
    way[draw(st.integers(0, 3))] = draw(st.sampled_from([most, -most]))
    end = draw(st.sampled_from(ends))
    return Motion(tuple(way), freq, ramp, end, draw(st.floats(0, 1.1)) if end else 0.0)


def drive(motors: X4Step, motion: Motion) -> Steps:
    """From standstill to standstill; the steps that it says were made."""
    motors.load(motion.way, motion.freq, motion.ramp)
    motors.start()
    if motion.end:
        motors.pass_time(motion.duration_s() * motion.part)
        if motors.moving:
            getattr(motors, motion.end)()
    motors.wait()
    return motors.facts.steps


def around(open_port: Callable[[StageClock], Port]) -> Surroundings:
    """Any LPT is that port, played by the core in virtual time."""

    def opened(lpt: int) -> Opened:
        clock = StageClock()
        core = MotorCore(open_port(clock), x4step_card(LptConfig()), clock, NO_SWITCH, settle_s=0)
        return Opened(core, clock, 0.004, 0.002)

    return Surroundings(opened, Keyboard(HandKeys()), is_lockstep=True)


def driven(open_port: Callable[[StageClock], Port], wanted: list[Motion]) -> Iterator[Steps]:
    """All of them, one after the other, and the port given back."""
    with X4Step(1, around(open_port)) as motors:
        for motion in wanted:
            yield drive(motors, motion)


def simulated_writes(port: Port, wanted: list[Motion]) -> list[tuple[int, int]]:
    """The registers that such a port gets, with their values."""
    recorders: list[Recorder] = []

    def open_port(clock: StageClock) -> Port:
        recorders.append(Recorder(port, clock))
        return recorders[0]

    list(driven(open_port, wanted))
    return recorders[0].writes()


def main(kind: str, said: str) -> None:
    """Drive them on a port that this process has."""
    from tests.rigs.lpt.play import PORTS

    wanted = [Motion(*fields) for fields in json.loads(said)]
    print(json.dumps(list(driven(lambda clock: PORTS[kind](), wanted))))  # noqa: T201


if __name__ == "__main__":
    main(*sys.argv[1:])
