"""Putting a machine together: here the peers behind each seam are known by name.

Drivers with their ports and clocks have their table in ``drivers.py``, cards in ``cards.py``,
the simulated mill its own in ``simulation.py``.
"""

from dataclasses import dataclass
from pathlib import Path

import platformdirs

from fraese.assembly.cards import CARDS
from fraese.assembly.drivers import DRIVERS, ClockName, Order
from fraese.assembly.meaning import meaning, still_meant
from fraese.assembly.misfits import misfits
from fraese.assembly.onlooker import MillOnlooker
from fraese.assembly.tracing import Trace, wanted
from fraese.config import Config
from fraese.control.controller import Controller
from fraese.control.savedstate import StateFile
from fraese.log import LogFile
from fraese.machine import Machine
from fraese.motor.awake import Awake
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import Clock


@dataclass(frozen=True)
class Plant:
    """A machine that has been put together.

    Attributes:
        controller: what a person or program commands.
        clock: its time.
        port: the simulated mill, which can be asked and told things; None: there is metal.
        state_file: where its state is kept; None: nowhere.
        config: what it was made from.
        notes: what a person should know from the start.
        awake: keeps the computer from sleeping until all is closed; None: it may sleep.
        onlooker: sees the simulated mill in the machine's coordinates; None: there is metal.
        trace: a waveform in the making; None: none was asked for.
    """

    controller: Controller
    clock: Clock
    port: SimulatedMill | None
    state_file: StateFile | None
    config: Config
    notes: tuple[str, ...] = ()
    awake: Awake | None = None
    onlooker: MillOnlooker | None = None
    trace: Trace | None = None

    @property
    def is_simulated(self) -> bool:
        """There is no metal."""
        return self.port is not None

    @property
    def machine_name(self) -> str:
        """What is driven, for the title."""
        return "simulated mill" if self.is_simulated else self.config.port.kind

    def press(self, end_name: str, pressed: bool) -> None:
        """Press an end switch of a simulated mill by hand, or let it go, by its name (xmin)."""
        if self.port is None or self.onlooker is None:
            return
        end = self.onlooker.end(end_name)
        (self.port.press if pressed else self.port.let_go)(end)

    def save(self, *, moving: bool = False) -> None:
        """Keep the state; ``moving`` before motion, so that a crash is noticed.

        Raises:
            ConfigError: if it cannot be written.
        """
        if self.state_file is None:
            return
        simulation: tuple[tuple[float, float, float, float], ...] = ()
        if self.port is not None:
            simulation = tuple((*state,) for state in self.port.states())
        also = {
            "simulation": simulation,
            "moving": moving,
            "axes": meaning(self.config, self.controller.machine),
        }
        self.state_file.save(self.controller.keep().model_copy(update=also))

    def close(self) -> None:
        """Motors off, state kept, port given back."""
        try:
            self.controller.close()
            self.save()
        finally:
            if self.trace is not None:
                self.trace.close()
            if self.awake is not None:
                self.awake.let_go()


def state_folder() -> Path:
    """The user's state folder."""
    return Path(platformdirs.user_state_dir("fraese"))


def assemble(
    config: Config,
    *,
    clock: ClockName = "virtual",
    state: Path | None = None,
    fresh: bool = False,
    at_desk: bool = False,
    trace: Path | None = None,
) -> Plant:
    """Put a machine together as configured.

    Args:
        config: from ``fraese.config.file.load``.
        clock: of a simulated mill: virtual for speed, paced where a person watches.
        state: folder in which the state is kept; None: it is not kept.
        fresh: forget what was kept.
        at_desk: nothing is to move: a simulated mill will do, metal is left alone.
        trace: a waveform file to be written; None: none is.

    Raises:
        TraceError: if the waveform file cannot be written.
        ConfigError: if the configuration cannot be built, or the kept state is damaged.
        PortError: if the port cannot be opened.
    """
    machine = Machine.from_config(config)
    card = CARDS[config.card.kind](config)
    state_file = StateFile(state) if state is not None else None
    notes = []
    kept = state_file.load(len(machine.axes)) if state_file is not None and not fresh else None
    if kept is not None:
        kept, forgotten = still_meant(kept, config, machine)
        notes += [forgotten] if forgotten else []
    if kept is not None:
        card.set_phases(kept.phases)
    kind = "simulation" if at_desk else config.port.kind
    made = DRIVERS[kind](Order(config, card, clock, kept, wanted(config, trace)))
    log = LogFile(
        Path(config.log.file) if config.log.file else (state or state_folder()) / "fraese.log"
    )
    log.switch(config.log.enabled)
    onlooker = None if made.mill is None else MillOnlooker(config, made.mill)
    controller = Controller(
        machine,
        made.driver,
        made.clock,
        config,
        log,
        slice_s=made.slice_s,
        step_word=card.step_word,
        onlooker=onlooker,
    )
    if kept is not None:
        controller.take_up(kept)
        if kept.moving:
            notes.append("The program ended while the machine moved: reference it again.")
    every = (*notes, *made.notes, *misfits(config))
    rest = made.awake, onlooker, made.trace
    return Plant(controller, made.clock, made.mill, state_file, config, every, *rest)
