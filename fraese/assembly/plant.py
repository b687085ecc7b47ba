"""Putting a machine together: here the peers behind each seam are known by name.

Drivers with their clocks have their table in ``drivers.py``, cards and ports their records in
``kinds/``, the simulated mill is put together in ``simulation.py``.
"""

import secrets
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import platformdirs

from fraese.assembly.drivers import ClockName, Made, Order, driver
from fraese.assembly.keeping import Keeping, closed_on_failure
from fraese.assembly.meaning import meaning
from fraese.assembly.misfits import misfits
from fraese.assembly.onlooker import MillOnlooker
from fraese.assembly.survivors import Opening
from fraese.assembly.tracing import Trace, Wanted, recorded, wanted
from fraese.assembly.workbench import Workbench
from fraese.config import Config
from fraese.control.asleft import left_by_crash
from fraese.control.controller import Controller
from fraese.control.recorder import JournalRecorder, Recorder
from fraese.control.savedstate import SavedState
from fraese.kinds.card import card_kind, card_of
from fraese.log import LogFile
from fraese.machine import Machine
from fraese.motor.awake import Awake
from fraese.motor.bridge.ledger import TOKEN_BYTES
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import Clock
from fraese.phrases import phrase

_NOBODY: Final = Recorder()
#: A run loop that looks at its driver so often is late by no more than this.
_SLICES_S: Final = 0.1
#: A step process looks at its lease every 0.01 s, and its throttle lags by as much.
_STEP_PROCESS_S: Final = 0.03


@dataclass(frozen=True)
class Plant:
    """A machine that has been put together.

    Attributes:
        controller: what a person or program commands.
        clock: its time.
        port: the simulated mill, which can be asked and told things; None: there is metal.
        keeping: where its state is kept; None: nowhere, or it is only looked at.
        config: what it was made from.
        notes: what a person should know from the start.
        awake: keeps the computer from sleeping until all is closed; None: it may sleep.
        onlooker: sees the simulated mill in the machine's coordinates; None: there is metal.
        trace: a waveform in the making; None: none was asked for.
        recorder: says there what the machine does.
        bench: the machine as it lies open on a bench.
    """

    controller: Controller
    clock: Clock
    port: SimulatedMill | None
    keeping: Keeping | None
    config: Config
    notes: tuple[str, ...] = ()
    awake: Awake | None = None
    onlooker: MillOnlooker | None = None
    trace: Trace | None = None
    recorder: Recorder = _NOBODY
    bench: Workbench | None = None

    @property
    def is_simulated(self) -> bool:
        """There is no metal."""
        return self.port is not None

    @property
    def machine_name(self) -> str:
        """What is driven, for the title."""
        return phrase("simulated mill") if self.is_simulated else self.config.port.kind

    def press(self, end_name: str, pressed: bool) -> None:
        """Press an end switch of a simulated mill by hand, or let it go, by its name (xmin)."""
        if self.port is None or self.onlooker is None:
            return
        end = self.onlooker.end(end_name)
        (self.port.press if pressed else self.port.let_go)(end)

    def close(self) -> None:
        """Motors off, state kept, port given back.

        Raises:
            ConfigError: if the state cannot be written.
        """
        try:
            self.controller.close()
        finally:
            try:
                self.recorder.close()
            finally:
                if self.keeping is not None:
                    self.keeping.close()
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
        at_desk: nothing is to move or to be written: a simulated mill will do, metal is left
            alone, and another program may drive it.
        trace: a waveform file to be written; None: as ``port.record`` says, none at a desk.

    Raises:
        TraceError: if the waveform file cannot be written.
        ConfigError: if the configuration cannot be built, or the kept state is damaged.
        BusyError: if another program drives the machine.
        PortError: if the port cannot be opened.
    """
    machine = Machine.from_config(config)
    if trace is None and not at_desk:
        trace = recorded(config.port)
    kept = _what_is_kept(config, machine, state, fresh=fresh, at_desk=at_desk)
    with closed_on_failure(kept.keeping):
        return _put_together(config, machine, kept, clock, wanted(config, trace), state)


class _Kept(NamedTuple):
    """Of an earlier start."""

    keeping: Keeping | None
    state: SavedState | None
    notes: list[str]
    at_desk: bool
    is_driven: bool = False


def _what_is_kept(
    config: Config, machine: Machine, folder: Path | None, *, fresh: bool, at_desk: bool
) -> _Kept:
    if folder is None:
        return _Kept(None, None, [], at_desk)
    keeping, notes = Keeping(folder, config, machine), list[str]()
    holder = keeping.holder() if at_desk else None
    if not at_desk:
        keeping.take_lock()
    elif holder is not None:
        notes.append(
            phrase(
                "The machine is driven by {in_words} now; this is its last record.",
                in_words=holder.in_words(),
            )
        )
    with closed_on_failure(keeping):
        state = None
        if fresh:
            keeping.start_anew()
        else:
            state, forgotten = keeping.load(to_write=not at_desk)
            notes += forgotten
    if state is not None and holder is not None:
        # Its program runs, and was not cut short.
        state = state.model_copy(update={"job": None})
    is_driven = holder is not None
    return _Kept(None if at_desk else keeping, state, notes, at_desk, is_driven)


def _put_together(
    config: Config,
    machine: Machine,
    kept: _Kept,
    clock: ClockName,
    trace: Wanted | None,
    folder: Path | None,
) -> Plant:
    keeping, state, notes, at_desk, _ = kept
    card = card_of(config)
    if state is not None:
        card.set_phases(state.phases)
    kind = "simulation" if at_desk else config.port.kind
    lock = None if keeping is None else keeping.descriptor
    session = secrets.token_hex(TOKEN_BYTES // 2)
    opening = None if keeping is None else Opening(session.encode(), keeping.path)
    made = driver(kind, Order(config, card, clock, state, trace, lock, opening))
    log = LogFile(
        Path(config.log.file) if config.log.file else (folder or state_folder()) / "fraese.log"
    )
    log.switch(config.log.enabled)
    # At a desk a simulated mill stands for metal; it is not that machine.
    mill = made.mill if config.port.kind == "simulation" else None
    onlooker = None if mill is None else MillOnlooker(config, mill)
    recorder = _NOBODY if keeping is None else _recorder(keeping, machine, config, made, clock)
    controller = Controller(
        machine,
        made.driver,
        made.clock,
        config,
        log,
        slice_s=made.slice_s,
        step_word=card.step_word,
        onlooker=onlooker,
        recorder=recorder,
    )
    controller.position.turn_steps = card_kind(config).turn_steps(config)
    if state is not None:
        controller.take_up(state)
        left = left_by_crash(controller)
        notes += [left.sentence] if left and not kept.is_driven else []
    recorder.begin(_facts(controller, config, mill, session))
    every = (*notes, *made.notes, *misfits(config))
    bench = Workbench(config, controller, card, made.driver, made.clock, mill)
    rest = made.awake, onlooker, made.trace, recorder, bench
    return Plant(controller, made.clock, mill, keeping, config, every, *rest)


def _recorder(
    keeping: Keeping, machine: Machine, config: Config, made: Made, clock: ClockName
) -> Recorder:
    """Who keeps where the machine is, and when motors brake after the last word about it."""
    settle_s: float | None = _STEP_PROCESS_S
    if made.mill is not None:
        settle_s = None if clock == "virtual" else _SLICES_S
    elif config.port.kind == "bridge":
        settle_s = config.realtime.silence_of_bridge_s + _SLICES_S
    lead_s = config.run.lead_s
    return JournalRecorder(keeping.write, machine, settle_s, grant=made.lease, lead_s=lead_s)


def _facts(
    controller: Controller, config: Config, mill: SimulatedMill | None, session: str
) -> Callable[[], SavedState]:
    """What is to be kept; called in the run loop's thread.

    Args:
        controller: knows where the machine is,
        config: and what its steps mean.
        mill: knows how it is left.
        session: which opening of the machine this is.
    """
    always = {"axes": meaning(config, controller.machine), "session": session}

    def facts() -> SavedState:
        simulation = () if mill is None else tuple((*state,) for state in mill.states())
        return controller.keep().model_copy(update={**always, "simulation": simulation})

    return facts
