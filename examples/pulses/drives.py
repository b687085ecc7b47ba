"""The paper's drives on a simulated port: two motors, direction and pulse in one byte.

    D0  direction of motor 1        D2  direction of motor 2
    D1  pulse of motor 1            D3  pulse of motor 2

Of the paper are the wiring, the two bytes and the speeds; what plays them is the motor core, as for
every other machine. The motors are those of its table: 1.8 degrees a step, eight pulses a step.
"""

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from fraese.assembly.tracing import LocalTrace, Wanted
from fraese.blocks import Block
from fraese.kinds.lines import step_direction_pins
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import StepDirElectronics
from fraese.motor.meaning import Meaning
from fraese.motor.mill import Mill, Slide
from fraese.motor.ports.recorder import Recorder
from fraese.motor.ports.sim import SimulatedMill, Wiring
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import DATA, Port
from fraese.motor.switches import NO_SWITCH
from fraese.x4step.motion import Motion

MOTORS = 2
STEP_ANGLE_DEG = 1.8
SUBDIVISION = 8
TOP_RATE_HZ = 133_333
#: Pulses in which the field turns once: four full steps.
TURN_PULSES = 4 * SUBDIVISION
#: Half-steps of the motor, in which the simulated mill counts, for a pulse.
HALF_STEPS = 2 / SUBDIVISION

#: Follows whatever it is told.
TIRELESS = RotorLimits(1e9, 1e9, 1e12)
#: A good hybrid motor: starts at 180 rev/min, gains 9000 rev/min a second, turns 6000 at most.
HYBRID = RotorLimits(max_rate_hz=40_000, jump_hz=1200, acceleration_hz_s=60_000)

_SLICE_S = 0.1


@dataclass
class Drives:
    """Two motors and what was written for them.

    Attributes:
        motion: plays blocks.
        mill: what the motors did.
        recorder: every access to the port.
    """

    motion: Motion
    mill: SimulatedMill
    recorder: Recorder

    def play(self, path: Iterable[Block]) -> None:
        """Play blocks to their end."""
        self.motion.start(iter(path))
        while self.motion.moving:
            self.motion.look(_SLICE_S)

    def bytes_written(self) -> list[tuple[int, int]]:
        """Times in ns, and bytes on the data lines, from the first pulse on."""
        data = [(a.at_ns, a.value) for a in self.recorder.accesses if a.register == DATA]
        first = next((n for n, (_, value) in enumerate(data) if value & 0b1010), len(data))
        return data[first:]


@contextmanager
def drives(
    *, duty: float = 0.5, motor: RotorLimits = TIRELESS, trace: Path | None = None
) -> Iterator[Drives]:
    """Two drives on a simulated port, on virtual time.

    Args:
        duty: share of its interval for which a pulse is high.
        motor: what it can follow.
        trace: a waveform file to be written.
    """
    profile = STEPDIR_PROFILES["paper"]._replace(duty=duty)
    clock = VirtualClock()
    mill = Mill([Slide(math.inf, motor, steps_in_turn=TURN_PULSES)] * MOTORS)
    simulated = SimulatedMill(mill, StepDirElectronics(mill, clock), clock, Wiring(mask=0))
    recorder = Recorder(simulated, clock)
    port: Port = recorder
    waveform = None
    if trace:
        meaning = Meaning(step_direction_pins({0: "motor1", 1: "motor2"}))
        waveform = LocalTrace(Wanted(trace, "pulses", meaning).begin(), clock)
        port = waveform.on(recorder)
    core = MotorCore(port, StepDirCard(profile, motors=MOTORS), clock, NO_SWITCH, settle_s=0.0)
    try:
        yield Drives(Motion(core), simulated, recorder)
    finally:
        core.close()
        if waveform:
            waveform.close()
