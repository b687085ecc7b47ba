"""Putting a machine together: the one place that knows every peer by name.

A new port or clock is one class in its room and one row in a table here; cards have their table in
``cardmaker.py``, the simulated mill its own in ``simulation.py``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import platformdirs

from fraese.cardmaker import CARDS
from fraese.config import Config
from fraese.controller import Controller
from fraese.endswitches import contact_bits
from fraese.journal import Journal, Kept
from fraese.log import LogFile
from fraese.machine import Machine
from fraese.motor.clock import MonotonicClock, PacedClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.sim import RotorState, SimulatedMill
from fraese.motor.seams import Card, Clock, Port, StepDriver
from fraese.motor.switches import SwitchInput
from fraese.simulation import simulated_mill

ClockName = Literal["virtual", "paced", "monotonic"]

CLOCKS: Final[Mapping[str, Callable[[], Clock]]] = {
    "virtual": VirtualClock,
    "paced": PacedClock,
    "monotonic": MonotonicClock,
}

#: How long one poll may take: short where a person watches, long where nobody does.
_SLICE_S: Final[Mapping[str, float]] = {"virtual": 0.1, "paced": 0.02, "monotonic": 0.02}


PORTS: Final[Mapping[str, Callable[[Config, Machine, Clock], Port]]] = {
    "simulation": simulated_mill,
}


@dataclass(frozen=True)
class Plant:
    """A machine that has been put together.

    Attributes:
        controller: what a person or program commands.
        clock: its time.
        port: what the card hangs on; a ``SimulatedMill`` can be asked and told things.
        journal: where its state is kept; None: nowhere.
        config: what it was made from.
        notes: what a person should know from the start.
    """

    controller: Controller
    clock: Clock
    port: Port
    journal: Journal | None
    config: Config
    notes: tuple[str, ...] = ()

    @property
    def is_simulated(self) -> bool:
        """There is no metal."""
        return isinstance(self.port, SimulatedMill)

    @property
    def machine_name(self) -> str:
        """What is driven, for the title."""
        return "simulated mill" if self.is_simulated else self.config.port.kind

    def press(self, end_name: str, pressed: bool) -> None:
        """Press an end switch of a simulated mill by hand, or let it go, by its name (xmin)."""
        if not isinstance(self.port, SimulatedMill):
            return
        end = self.controller.switches.motor_end(end_name)
        (self.port.press if pressed else self.port.let_go)(end)

    def save(self, *, moving: bool = False) -> None:
        """Keep the state; ``moving`` before motion, so that a crash is noticed.

        Raises:
            ConfigError: if it cannot be written.
        """
        if self.journal is None:
            return
        simulation: tuple[tuple[float, float, float, float], ...] = ()
        if isinstance(self.port, SimulatedMill):
            simulation = tuple((*state,) for state in self.port.states())
        also = {
            "simulation": simulation,
            "moving": moving,
            "axes": _meaning(self.config, self.controller.machine),
        }
        self.journal.save(self.controller.keep().model_copy(update=also))

    def close(self) -> None:
        """Motors off, state kept, port given back."""
        self.controller.close()
        self.save()


def state_folder() -> Path:
    """The user's state folder."""
    return Path(platformdirs.user_state_dir("fraese"))


def _meaning(config: Config, machine: Machine) -> tuple[str, ...]:
    """What steps, phases and slack are counted in: a word per axis."""
    table = config.card.table if config.card.kind == "smc1500" else ""
    return tuple(
        f"{config.card.kind} {table} {axis.steps_per_mm} {axis.motor_sign} {axis.home_sign}"
        f" {axis.low_mm} {axis.high_mm} {axis.backlash_steps}"
        for axis in machine.axes
    )


def assemble(
    config: Config,
    *,
    clock: ClockName = "virtual",
    state: Path | None = None,
    fresh: bool = False,
) -> Plant:
    """Put a machine together as configured.

    Args:
        config: from ``fraese.configfile.load``.
        clock: virtual for speed, paced for a simulated mill that a person watches.
        state: folder in which the state is kept; None: it is not kept.
        fresh: forget what was kept.

    Raises:
        ConfigError: if the configuration cannot be built, or the kept state is damaged.
        PortError: if the port cannot be opened.
    """
    machine = Machine.from_config(config)
    time = CLOCKS[clock]()
    card = CARDS[config.card.kind](config)
    port = PORTS[config.port.kind](config, machine, time)
    journal = Journal(state) if state is not None else None
    notes = []
    kept = journal.load(len(machine.axes)) if journal is not None and not fresh else None
    if kept is not None and kept.axes != _meaning(config, machine):
        notes.append("The axes were configured otherwise before: the old position is forgotten.")
        kept = None
    if kept is not None:
        _restore(kept, card, port)
    driver = _driver(config, port, card, time)
    log = LogFile(
        Path(config.log.file) if config.log.file else (state or state_folder()) / "fraese.log"
    )
    log.switch(config.log.enabled)
    controller = Controller(machine, driver, time, config, log, slice_s=_SLICE_S[clock])
    if kept is not None:
        controller.take_up(kept)
        if kept.moving:
            notes.append("The program ended while the machine moved: reference it again.")
    return Plant(controller, time, port, journal, config, tuple(notes))


def _restore(kept: Kept, card: Card, port: Port) -> None:
    """Phases, and rotors where they are simulated, as another run left them."""
    card.set_phases(kept.phases)
    if isinstance(port, SimulatedMill) and kept.simulation:
        port.set_states([RotorState(*values) for values in kept.simulation])


def _driver(config: Config, port: Port, card: Card, clock: Clock) -> StepDriver:
    return MotorCore(
        port,
        card,
        clock,
        switch=SwitchInput(*contact_bits(config.switches), config.switches.readings),
        settle_s=config.standstill.settle_ms / 1000,
        safe_outputs=config.outputs.mask("laser"),
    )
