"""Putting a machine together: the one place that knows every peer by name.

A new card, port or clock is one class in its room and one row in a table here.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Final, Literal

import platformdirs

from fraese.config import AXIS_NAMES, Config
from fraese.controller import Controller
from fraese.endswitches import contact_bits
from fraese.errors import ConfigError
from fraese.journal import Journal
from fraese.log import LogFile
from fraese.machine import Machine
from fraese.motor.cards import STEPDIR_PROFILES, OutputPin, SmcCard, StepDirCard
from fraese.motor.clock import MonotonicClock, PacedClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.mill import TURN_STEPS, Mill, RotorLimits
from fraese.motor.phases import LEVEL_MAPS, PHASE_TABLES
from fraese.motor.ports.sim import (
    Electronics,
    RotorState,
    SimulatedMill,
    SmcElectronics,
    StepDirElectronics,
    Wiring,
)
from fraese.motor.seams import Card, Clock, Port
from fraese.motor.switches import SwitchInput

ClockName = Literal["virtual", "paced", "monotonic"]

CLOCKS: Final[Mapping[str, Callable[[], Clock]]] = {
    "virtual": VirtualClock,
    "paced": PacedClock,
    "monotonic": MonotonicClock,
}

#: How long one poll may take: short where a person watches, long where nobody does.
_SLICE_S: Final[Mapping[str, float]] = {"virtual": 0.1, "paced": 0.02, "monotonic": 0.02}


def phase_table(name: str) -> bytes:
    """A drive table by name, or from its bytes in hex.

    Raises:
        ConfigError: if it is neither.
    """
    if name in PHASE_TABLES:
        return PHASE_TABLES[name]
    try:
        table = bytes.fromhex(name)
    except ValueError:
        table = b""
    if not 2 <= len(table) <= 32 or any(byte > 0x3F for byte in table):
        raise ConfigError(
            f"card.table: {name!r} is neither one of {', '.join(PHASE_TABLES)} nor 2 to 32 bytes"
            " in hex, each 00 to 3F."
        )
    return table


def _pins(config: Config) -> list[OutputPin]:
    """Configured outputs in the order of their bits."""
    return [OutputPin(output.pin, output.active_high) for _, output in config.outputs.configured()]


def _smc_card(config: Config) -> Card:
    return SmcCard(
        table=phase_table(config.card.table),
        holding_percent=config.card.holding_percent,
        levels=LEVEL_MAPS[config.card.levels],
        outputs=_pins(config),
        motors=len(AXIS_NAMES),
    )


def _stepdir_card(config: Config) -> Card:
    profile = STEPDIR_PROFILES[config.card.profile]
    for name in AXIS_NAMES:
        rate_hz = getattr(config.axes, name).max_rate_hz
        if rate_hz > profile.max_rate_hz:
            raise ConfigError(
                f"axes.{name}.max_rate_hz: {rate_hz:g} is above the {profile.max_rate_hz} steps/s"
                f" of card.profile {config.card.profile}."
            )
    return StepDirCard(
        profile=profile,
        clock_idles_high=config.card.clock_idles_high,
        forward_high=config.card.forward_high,
        outputs=_pins(config),
        enable=config.outputs.bit("enable"),
        motors=len(AXIS_NAMES),
    )


CARDS: Final[Mapping[str, Callable[[Config], Card]]] = {
    "smc1500": _smc_card,
    "stepdir": _stepdir_card,
}


def _smc_electronics(mill: Mill, clock: Clock, config: Config) -> Electronics:
    rest = phase_table(config.card.table)[0]
    return SmcElectronics(mill, clock, LEVEL_MAPS[config.card.levels], rest)


def _stepdir_electronics(mill: Mill, clock: Clock, config: Config) -> Electronics:
    card = config.card
    return StepDirElectronics(mill, clock, card.clock_idles_high, card.forward_high)


ELECTRONICS: Final[Mapping[str, Callable[[Mill, Clock, Config], Electronics]]] = {
    "smc1500": _smc_electronics,
    "stepdir": _stepdir_electronics,
}


#: What the simulated mill counts in one step of the card: half-steps, pulses.
_HALF_STEPS: Final[Mapping[str, Callable[[Config], Fraction]]] = {
    "smc1500": lambda config: Fraction(TURN_STEPS, len(phase_table(config.card.table))),
    "stepdir": lambda config: Fraction(1),
}


def _simulation(config: Config, machine: Machine, clock: Clock) -> SimulatedMill:
    simulation = config.simulation
    limits = RotorLimits(
        max_rate_hz=simulation.max_rate_hz,
        jump_hz=simulation.jump_hz,
        acceleration_hz_s=simulation.acceleration_hz_s,
        snaps_to_pole=simulation.snaps_to_pole,
    )
    scale = _HALF_STEPS[config.card.kind](config)
    mill = Mill(
        travel_steps=[round(axis.to_steps(axis.travel_mm) * scale) for axis in machine.axes],
        limits=[limits] * len(machine.axes),
        overrun_steps=max(
            round(axis.to_steps(simulation.overrun_mm) * scale) for axis in machine.axes
        ),
        lag_s=simulation.lag_ms / 1000,
        bounce_readings=simulation.bounce_readings,
        backlash_steps=[
            round(axis.to_steps(simulation.backlash_mm) * scale) for axis in machine.axes
        ],
    )
    wiring = Wiring(*contact_bits(config.switches))
    return SimulatedMill(mill, ELECTRONICS[config.card.kind](mill, clock, config), clock, wiring)


PORTS: Final[Mapping[str, Callable[[Config, Machine, Clock], Port]]] = {
    "simulation": _simulation,
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
        card.set_phases(kept.phases)
        if isinstance(port, SimulatedMill) and kept.simulation:
            port.set_states([RotorState(*values) for values in kept.simulation])
    driver = MotorCore(
        port,
        card,
        time,
        switch=SwitchInput(*contact_bits(config.switches), config.switches.readings),
        settle_s=config.standstill.settle_ms / 1000,
        safe_outputs=config.outputs.mask("laser"),
    )
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
