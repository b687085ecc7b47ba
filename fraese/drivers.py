"""Drivers as configured: one function and one row for each kind of port.

    kind         who plays the blocks                         time
    simulation   the core, in this thread, on a mill          virtual, or paced by the wall
    ppdev        the core, in a process of its own            the machine's
    devport      likewise

Another one is a class behind the ``StepDriver`` seam, and a row in ``DRIVERS``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final, Literal, NamedTuple

from fraese.config import AXIS_NAMES, Config
from fraese.endswitches import contact_bits
from fraese.journal import Kept
from fraese.machine import Machine
from fraese.motor.clock import MonotonicClock, PacedClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.sim import RotorState, SimulatedMill
from fraese.motor.seams import Card, Clock, Port, StepDriver
from fraese.motor.switches import SwitchInput
from fraese.simulation import simulated_mill

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
        machine: axes and conversions.
        card: what the registers mean, with its phases as they were kept.
        clock: for a simulated mill, how its time passes.
        kept: how a simulated mill was left.
    """

    config: Config
    machine: Machine
    card: Card
    clock: ClockName
    kept: Kept | None

    @property
    def switch(self) -> SwitchInput:
        """The shared end-switch input."""
        switches = self.config.switches
        return SwitchInput(*contact_bits(switches), switches.readings)

    @property
    def settle_s(self) -> float:
        """Wait after energising."""
        return self.config.standstill.settle_ms / 1000

    @property
    def safe_outputs(self) -> int:
        """Outputs that are off whenever the motors stand."""
        return self.config.outputs.mask("laser")


class Made(NamedTuple):
    """A driver, and what belongs to it.

    Attributes:
        driver: what plays the blocks.
        clock: its time.
        slice_s: how long one poll may take, s.
        mill: the simulated mill that it drives; None: there is metal.
        notes: what a person should know from the start.
    """

    driver: StepDriver
    clock: Clock
    slice_s: float
    mill: SimulatedMill | None = None
    notes: tuple[str, ...] = ()


def _on_simulated_mill(order: Order) -> Made:
    clock = CLOCKS[order.clock]()
    mill = simulated_mill(order.config, order.machine, clock)
    if order.kept is not None and order.kept.simulation:
        mill.set_states([RotorState(*values) for values in order.kept.simulation])
    core = MotorCore(
        mill,
        order.card,
        clock,
        switch=order.switch,
        settle_s=order.settle_s,
        safe_outputs=order.safe_outputs,
    )
    return Made(core, clock, _SLICE_S[order.clock], mill)


def _in_real_time(open_port: Callable[[], Port], order: Order) -> Made:
    # Only where there is such a port: what the child needs exists on Linux only.
    from fraese.motor.realtime.driver import RealtimeDriver
    from fraese.motor.realtime.setup import ChargePump, RealtimeOptions, Setup

    config = order.config
    heartbeat = config.outputs.bit("heartbeat")
    pump = None if heartbeat is None else ChargePump(heartbeat, config.realtime.heartbeat_hz)
    options = RealtimeOptions(
        top_rate_hz=max(getattr(config.axes, name).max_rate_hz for name in AXIS_NAMES),
        core=config.realtime.core,
        silent_s=config.realtime.silent_s,
        pump=pump,
    )
    driver = RealtimeDriver(
        Setup(
            open_port,
            order.card,
            switch=order.switch,
            settle_s=order.settle_s,
            safe_outputs=order.safe_outputs,
            options=options,
        )
    )
    return Made(driver, MonotonicClock(), _METAL_SLICE_S)


def _on_ppdev(order: Order) -> Made:
    from fraese.motor.ports.ppdev import PpdevPort

    return _in_real_time(partial(PpdevPort, order.config.port.device), order)


def _on_devport(order: Order) -> Made:
    from fraese.motor.ports.devport import DevPort

    return _in_real_time(partial(DevPort, order.config.port.base), order)


DRIVERS: Final[Mapping[str, Callable[[Order], Made]]] = {
    "simulation": _on_simulated_mill,
    "ppdev": _on_ppdev,
    "devport": _on_devport,
}
