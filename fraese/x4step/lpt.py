"""Ports LPT1 to LPT4: what stands behind each, and its opening.

    kind         who makes the steps                      time
    simulation   the core, in the owner's thread          paced by the wall, or virtual
    ppdev        the core, in a process of its own        the machine's
    devport      likewise
    bridge       a microcontroller                        the machine's

Rule 1: without a table in the configuration all four are simulated; with one, only those exist
        that have a table.
Rule 2: a simulated port carries four motors that follow anything, and inputs that a hand sets.
        They rest high, as the pull-ups of a real port hold them.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from fraese.assembly import tracing
from fraese.assembly.drivers import bridge_driver, on_metal, real_time_driver
from fraese.config import Config
from fraese.config.x4step import LptConfig
from fraese.errors import PortError
from fraese.kinds.port import port_opener
from fraese.motor.awake import Awake
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.stepdir import ACTIVE_PIN, BOOST_PIN, STEPDIR_PROFILES, StepDirCard
from fraese.motor.clock import MonotonicClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import StepDirElectronics
from fraese.motor.meaning import Meaning
from fraese.motor.mill import Mill, Slide
from fraese.motor.pins import STATUS_PINS
from fraese.motor.ports.recorder import Recorder
from fraese.motor.ports.sim import SimulatedMill, Wiring
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import Clock, Port, StepDriver
from fraese.motor.switches import NO_SWITCH
from fraese.phrases import phrase
from fraese.x4step.codes import AXES, FREQ_HZ
from fraese.x4step.codes import PORTS as LPTS

if TYPE_CHECKING:
    from fraese.motor.realtime.setup import Setup

MOTORS: Final = 4
#: Signals 1 and 2, in the order of a driver's bits.
SIGNAL_PINS: Final = (1, 14)
#: What hangs on the pins.
LINE_NAMES: Final[Mapping[int, str]] = {
    **{2 * axis: f"direction{axis}" for axis in AXES},
    **{2 * axis + 1: f"clock{axis}" for axis in AXES},
    1: "signal1",
    14: "signal2",
    BOOST_PIN: "boost",
    ACTIVE_PIN: "active",
    **dict.fromkeys(STATUS_PINS, "input"),
}
#: Follows whatever it is told: what a real motor can follow is not this library's business.
_TIRELESS: Final = RotorLimits(1e9, 1e9, 1e12)
_SLICE_S: Final = 0.004
#: Simulated time passes in such steps while the axes stand.
_SIMULATED_IDLE_S: Final = 0.002
METAL_IDLE_S: Final = 0.01
#: A report costs the microcontroller as much time as forty steps.
_BRIDGE_S: Final = 0.015


@dataclass(frozen=True)
class Opened:
    """A port that is open.

    Attributes:
        driver: plays blocks on it.
        clock: its time.
        slice_s: how long one poll may take while axes move, s.
        idle_s: between two polls while they stand, s.
        mill: what is simulated behind it; None: there is metal.
        recorder: every access to the simulated port; None: nobody asked for it.
        awake: keeps the computer from sleeping; None: it may.
        trace: a waveform in the making, to be closed after the driver.
    """

    driver: StepDriver
    clock: Clock
    slice_s: float
    idle_s: float
    mill: SimulatedMill | None = None
    recorder: Recorder | None = None
    awake: Awake | None = None
    trace: tracing.Trace | None = None

    def let_go(self, complain: Callable[[str], None]) -> None:
        """The driver is closed: the rest as well. A waveform that is not whole is told of."""
        if self.awake is not None:
            self.awake.let_go()
        if self.trace is not None:
            self.trace.close()
            if not self.trace.waveform.is_whole:
                complain(self.trace.waveform.sentence())


@dataclass(frozen=True)
class Wanted:
    """What is to be opened.

    Attributes:
        lpt: 1 to 4.
        config: all of it.
        port: its own table.
        make_clock: the time of a simulated port.
        record: write every access down.
        trace: waveform file; None: as ``record`` of the port says.
    """

    lpt: int
    config: Config
    port: LptConfig
    make_clock: Callable[[], Clock]
    record: bool = False
    trace: Path | None = None

    @property
    def waveform(self) -> tracing.Wanted | None:
        """The waveform that is wanted."""
        path = self.trace or tracing.recorded(self.port)
        return tracing.Wanted(path, f"lpt{self.lpt}", Meaning(LINE_NAMES)) if path else None


def port_config(config: Config, lpt: int) -> LptConfig:
    """The table of a port.

    Raises:
        PortError: if it does not exist in this configuration.
    """
    tables = {number: getattr(config.x4step, f"lpt{number}") for number in LPTS}
    if not any(tables.values()):
        return LptConfig()
    table = tables[lpt]
    if table is None:
        there = ", ".join(f"LPT{number}" for number, found in tables.items() if found)
        raise PortError(
            phrase("LPT{lpt} is not configured; there is {there}.", lpt=lpt, there=there)
        )
    assert isinstance(table, LptConfig)
    return table


def open_lpt(wanted: Wanted) -> Opened:
    """Open a port; nothing steps, all control pins go low.

    Raises:
        PortError: if it is not there, forbidden, or somebody else has it.
    """
    return OPENERS.get(wanted.port.kind, _in_real_time)(wanted)


def set_pin(mill: SimulatedMill, pin: int, high: bool) -> None:
    """Put a level on an input of a simulated port.

    Raises:
        ValueError: if the pin is no input.
    """
    if pin not in STATUS_PINS:
        inputs = ", ".join(str(number) for number in sorted(STATUS_PINS))
        raise ValueError(
            phrase("pin {pin} is no input; the inputs are {inputs}", pin=pin, inputs=inputs)
        )
    bit, inverted = STATUS_PINS[pin]
    mill.inputs = mill.inputs | bit if high != inverted else mill.inputs & ~bit


def x4step_card(port: LptConfig) -> StepDirCard:
    """Four motors with the manual's timing, and its two free signals."""
    return StepDirCard(
        STEPDIR_PROFILES["x4step"],
        clock_idles_high=port.clock_idles_high,
        forward_high=port.forward_high,
        outputs=[OutputPin(pin) for pin in SIGNAL_PINS],
        motors=MOTORS,
    )


def _simulation(wanted: Wanted) -> Opened:
    clock = wanted.make_clock()
    mill = Mill([Slide(math.inf, _TIRELESS)] * MOTORS)
    port = wanted.port
    electronics = StepDirElectronics(mill, clock, port.clock_idles_high, port.forward_high)
    simulated = SimulatedMill(mill, electronics, clock, Wiring(mask=0))
    for pin in STATUS_PINS:
        set_pin(simulated, pin, pin not in port.low_pins)
    recorder = Recorder(simulated, clock) if wanted.record else None
    seen: Port = recorder or simulated
    waveform = wanted.waveform
    trace = tracing.LocalTrace(waveform.begin(), clock) if waveform else None
    seen = trace.on(seen) if trace else seen
    core = MotorCore(seen, x4step_card(port), clock, NO_SWITCH, settle_s=0.0)
    return Opened(core, clock, _SLICE_S, _SIMULATED_IDLE_S, simulated, recorder, trace=trace)


def _in_real_time(wanted: Wanted) -> Opened:
    driver, trace = real_time_driver(realtime_setup(wanted), wanted.waveform)
    made = on_metal(driver, MonotonicClock(), trace)
    return Opened(driver, made.clock, _SLICE_S, METAL_IDLE_S, awake=made.awake, trace=trace)


def realtime_setup(wanted: Wanted, open_port: Callable[[], Port] | None = None) -> "Setup":
    """What the step process is told.

    Args:
        wanted: the port.
        open_port: opens something else in its place.
    """
    from fraese.motor.realtime.setup import RealtimeOptions, Setup

    realtime = wanted.config.realtime
    as_port = wanted.config.model_copy(update={"port": wanted.port})
    return Setup(
        open_port or port_opener(as_port),
        x4step_card(wanted.port),
        switch=NO_SWITCH,
        settle_s=0.0,
        options=RealtimeOptions(
            top_rate_hz=FREQ_HZ[1], core=realtime.core, silent_s=realtime.silent_s
        ),
    )


def _on_bridge(wanted: Wanted) -> Opened:
    made = bridge_driver(
        wanted.config, wanted.port, x4step_card(wanted.port), wanted.waveform, switch=NO_SWITCH
    )
    return Opened(made.driver, made.clock, _BRIDGE_S, _BRIDGE_S, awake=made.awake, trace=made.trace)


OPENERS: Final[Mapping[str, Callable[[Wanted], Opened]]] = {
    "simulation": _simulation,
    "bridge": _on_bridge,
}
