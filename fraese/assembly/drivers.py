"""Drivers as configured: one function and one row for each kind of port.

    kind         who plays the blocks                         time
    simulation   the core, in this thread, on a mill          virtual, or paced by the wall
    ppdev        the core, in a process of its own            the machine's
    devport      likewise, and every port that lives in a package of its own
    bridge       a microcontroller, fed from this thread      the machine's

Another port is a class behind the ``Port`` seam, and its record: ``kinds/port.py``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

from fraese.assembly.simulation import simulated_mill
from fraese.assembly.survivors import Opening, ledger_of, words_to
from fraese.assembly.tracing import LocalTrace, Trace, Wanted, closed_on_failure
from fraese.config import Config
from fraese.config.wiring import PortConfig
from fraese.control.endswitches import contact_bits
from fraese.control.savedstate import SavedState
from fraese.kinds.card import card_kind
from fraese.kinds.port import port_opener
from fraese.motor.awake import Awake
from fraese.motor.bridge.cards import CardFacts
from fraese.motor.clock import MonotonicClock, PacedClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.sim import RotorState, SimulatedMill
from fraese.motor.seams import Card, Clock, StepDriver
from fraese.motor.switches import SwitchInput
from fraese.motor.waveform import Waveform

if TYPE_CHECKING:
    from fraese.motor.realtime.driver import RealtimeDriver
    from fraese.motor.realtime.setup import RealtimeOptions, Setup

ClockName = Literal["virtual", "paced"]

#: Time on a simulated mill.
CLOCKS: Final[Mapping[str, Callable[[], Clock]]] = {"virtual": VirtualClock, "paced": PacedClock}

#: How long one poll may take: short where a person watches, long where nobody does.
_SLICE_S: Final[Mapping[str, float]] = {"virtual": 0.1, "paced": 0.02}
_METAL_SLICE_S: Final = 0.02


@dataclass(frozen=True)
class Order:
    """What a driver is made from.

    Attributes:
        config: all of it.
        card: what the registers mean, with its phases as they were kept.
        clock: for a simulated mill, how its time passes.
        kept: how a simulated mill was left.
        trace: a waveform that is wanted; None: none is.
        lock: descriptor that says who drives the machine, for a process that makes the steps.
        opening: which opening of the machine it is; None: nothing is kept.
    """

    config: Config
    card: Card
    clock: ClockName
    kept: SavedState | None
    trace: Wanted | None = None
    lock: int | None = None
    opening: Opening | None = None

    @property
    def switch(self) -> SwitchInput:
        """The inputs of the end switches."""
        switches = self.config.switches
        return SwitchInput(*contact_bits(self.config), switches.readings)

    @property
    def settle_s(self) -> float:
        """Wait after energising."""
        return self.config.standstill.settle_ms / 1000

    @property
    def safe_outputs(self) -> int:
        """Outputs that are off whenever the motors stand."""
        return self.config.outputs.off_at_rest


class Made(NamedTuple):
    """A driver, and what belongs to it.

    Attributes:
        driver: what plays the blocks.
        clock: its time.
        slice_s: how long one poll may take, s.
        mill: the simulated mill that it drives; None: there is metal.
        notes: what a person should know from the start.
        awake: keeps the machine from sleeping as long as the port is open; None: it may sleep.
        trace: a waveform in the making, to be closed after the driver.
        lease: lets who makes the steps go on until then; None: it cannot be told.
    """

    driver: StepDriver
    clock: Clock
    slice_s: float
    mill: SimulatedMill | None = None
    notes: tuple[str, ...] = ()
    awake: Awake | None = None
    trace: Trace | None = None
    lease: Callable[[int], None] | None = None


def _on_simulated_mill(order: Order) -> Made:
    clock = CLOCKS[order.clock]()
    trace = LocalTrace(order.trace.begin(), clock) if order.trace else None
    mill = simulated_mill(order.config, clock)
    if order.kept is not None and order.kept.simulation:
        mill.set_states([RotorState(*values) for values in order.kept.simulation])
    core = MotorCore(
        trace.on(mill) if trace else mill,
        order.card,
        clock,
        switch=order.switch,
        settle_s=order.settle_s,
        safe_outputs=order.safe_outputs,
    )
    return Made(core, clock, _SLICE_S[order.clock], mill, trace=trace)


def realtime_options(config: Config) -> "RealtimeOptions":
    """How the step process gets its time, as configured."""
    from fraese.motor.realtime.setup import ChargePump, RealtimeOptions

    heartbeat = config.outputs.bit("heartbeat")
    pump = None if heartbeat is None else ChargePump(heartbeat, config.realtime.heartbeat_hz)
    return RealtimeOptions(
        top_rate_hz=max(axis.max_rate_hz for axis in config.axes.table.values()),
        core=config.realtime.core,
        silent_s=config.realtime.silent_s,
        pump=pump,
    )


def in_real_time(order: Order) -> Made:
    """The core on the port as configured, in a process of its own."""
    # Only where there is such a port: what the child needs exists on Linux only.
    from fraese.motor.realtime.setup import Setup

    setup = Setup(
        port_opener(order.config),
        order.card,
        switch=order.switch,
        settle_s=order.settle_s,
        safe_outputs=order.safe_outputs,
        options=realtime_options(order.config),
        inherited=() if order.lock is None else (order.lock,),
        last_words=words_to(order.opening),
    )
    driver, trace = real_time_driver(setup, order.trace)
    return on_metal(driver, MonotonicClock(), trace, driver.lease)


def real_time_driver(
    setup: "Setup", wanted: Wanted | None
) -> "tuple[RealtimeDriver, Trace | None]":
    """A step process, and the waveform of what it writes, if one is wanted.

    Raises:
        PortError: if it does not start.
        TraceError: if the waveform cannot be written; nothing was started.
    """
    from fraese.motor.realtime.accesses import ChildTrace
    from fraese.motor.realtime.driver import RealtimeDriver

    if wanted is None:
        return RealtimeDriver(setup), None
    trace = ChildTrace(wanted.begin())
    try:
        return RealtimeDriver(trace.on(setup)), trace
    except BaseException:
        trace.close()
        raise


def on_metal(
    driver: StepDriver,
    clock: Clock,
    trace: Trace | None = None,
    lease: Callable[[int], None] | None = None,
) -> Made:
    """Where real motors hang on the other end, the computer must not fall asleep."""
    return Made(driver, clock, _METAL_SLICE_S, awake=Awake(), trace=trace, lease=lease)


def _on_bridge(order: Order) -> Made:
    return bridge_driver(
        order.config,
        order.config.port,
        order.card,
        order.trace,
        switch=order.switch,
        settle_s=order.settle_s,
        safe_outputs=order.safe_outputs,
        opening=order.opening,
        facts=card_kind(order.config).facts(order.card, order.config.card.kind),
    )


def bridge_driver(
    config: Config,
    port: PortConfig,
    card: Card,
    wanted: Wanted | None,
    *,
    switch: SwitchInput,
    settle_s: float = 0.0,
    safe_outputs: int = 0,
    opening: Opening | None = None,
    facts: CardFacts | None = None,
) -> Made:
    """A microcontroller, and the waveform of what it plays, if one is wanted.

    Raises:
        PortError: if it is not there, or somebody else has it.
        TraceError: if the waveform cannot be written.
    """
    # Nobody else needs pyserial.
    from fraese.motor.bridge.driver import BridgeDriver
    from fraese.motor.bridge.lifesign import LifeSign
    from fraese.motor.bridge.line import SerialLine, chosen_port

    device = chosen_port(port.device)
    clock = MonotonicClock()
    waveform = wanted.begin() if wanted else None
    driver: StepDriver
    with closed_on_failure(waveform):
        driver = bridge = BridgeDriver(
            partial(SerialLine, device, port.baud),
            card,
            clock,
            switch=switch,
            settle_s=settle_s,
            safe_outputs=safe_outputs,
            silence_s=config.realtime.silence_of_bridge_s,
            name=device,
            baud=port.baud,
            ledger=ledger_of(opening),
            facts=facts,
        )
        sign = LifeSign(bridge, config.realtime.busy_s)
        sign.start()
    trace = None
    if waveform is not None:
        driver, trace = planned_driver(driver, waveform, card, clock, settle_s, safe_outputs)
    return on_metal(driver, clock, trace, sign.lease)


def planned_driver(
    driver: StepDriver,
    waveform: Waveform,
    card: Card,
    clock: Clock,
    settle_s: float = 0.0,
    safe_outputs: int = 0,
) -> "tuple[StepDriver, Trace]":
    """A driver whose steps are timed elsewhere, and the waveform of what it plays."""
    from fraese.motor.planned import PlannedTrace

    trace = PlannedTrace(waveform, card, clock, settle_s, safe_outputs)
    return trace.on(driver), trace


#: Drivers of their own; every other port is driven by a step process.
DRIVERS: Final[Mapping[str, Callable[[Order], Made]]] = {
    "simulation": _on_simulated_mill,
    "bridge": _on_bridge,
}


def driver(kind: str, order: Order) -> Made:
    """The driver of that kind of port.

    Raises:
        ConfigError: if the card cannot be driven by it.
        TraceError: if a waveform cannot be written.
        PortError: if the port cannot be opened.
    """
    return DRIVERS.get(kind, in_real_time)(order)
