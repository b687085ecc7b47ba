"""What one needs to know before a machine is trusted with steel: looked over, measured, judged.

    config --> patient --> checks of the port, checks of the kernel --> findings
           --> duty ----> measured --> judged --------------------------'  --> exit code

Rule 1: facts and judgement only; who prints is ``fraese/cli/doctor.py``.
Rule 2: a check is a function in a table. What it judges lies in the ``Patient``, so that it can be
        tried on any patient.
Rule 3: for the simulated mill and the bridge the timing is never bad: their steps are timed by
        somebody else.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Final

from fraese.assembly.drivers import realtime_options
from fraese.assembly.tracing import LocalTrace, recorded, wanted
from fraese.config import Config
from fraese.doctor import timing
from fraese.doctor.board import try_board
from fraese.doctor.findings import Finding, Patient, State, ask
from fraese.doctor.kernel import KERNEL_CHECKS
from fraese.doctor.motors import MOTOR_CHECKS
from fraese.doctor.opening import Opening
from fraese.doctor.parallel import try_port
from fraese.doctor.port import port_checks
from fraese.doctor.program import PROGRAM_CHECKS
from fraese.doctor.timing import Say, Timing
from fraese.kinds.card import card_of
from fraese.kinds.port import port_opener
from fraese.motor.awake import Awake
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.facts import describe
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.setup import SLEEP_GAP_S, Setup
from fraese.motor.realtime.system import PRIORITY
from fraese.motor.seams import Card

#: The worst that the timing may be, by kind of port.
_WORST_TIMING: Final = {"simulation": State.WARN, "bridge": State.WARN}


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Everything that was found.

    Attributes:
        port: kind of port that was looked at.
        findings: in the order of the checks.
        timing: the measurements.
        advice: what would make the steps more punctual still, a sentence each.
    """

    port: str
    findings: tuple[Finding, ...]
    timing: Timing
    advice: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Nothing is bad."""
        return all(finding.state is not State.BAD for finding in self.findings)


def examine(
    config: Config,
    seconds: float,
    load: bool,
    say: Say,
    root: Path = Path("/"),
    trace: Path | None = None,
) -> Diagnosis:
    """Look a machine over, and measure how late its steps are.

    Args:
        config: of the machine; its port is opened, unless it is simulated.
        seconds: for each measurement.
        load: measure with all cores busy, too.
        say: is told what is being done.
        root: where the file system begins, for what is read about the kernel.
        trace: waveform file of what is done with a parallel port; None: as ``port.record`` says.

    Raises:
        TraceError: if that cannot be written.
        ConfigError: if the card cannot be built as configured.
        PortError: if the step process does not start.
    """
    card = card_of(config)
    patient = admit(config, card, root, trace or recorded(config.port))
    checks = (*PROGRAM_CHECKS, *port_checks(config.port.kind), *MOTOR_CHECKS, *KERNEL_CHECKS)
    findings = list(ask(checks, patient))
    duty = timing.duty_of(card, realtime_options(config))
    cores = max(1, len(patient.kernel.cores))
    taken = timing.take(duty, timing.limit_hz(config), seconds, cores, load, say)
    worst = _WORST_TIMING.get(config.port.kind, State.BAD)
    findings += (_no_worse(finding, worst) for finding in timing.judge(taken))
    return Diagnosis(
        config.port.kind,
        tuple(findings),
        taken,
        tuple(timing.advice(taken, patient.kernel)),
    )


def admit(config: Config, card: Card, root: Path = Path("/"), trace: Path | None = None) -> Patient:
    """Collect all that the checks look at; opens the port, and asks for an inhibitor once."""
    options = realtime_options(config)
    awake = Awake()
    held, note = awake.held, awake.note
    awake.let_go()
    return Patient(
        config=config,
        card=card,
        port=describe(config.port.parallel_device, root),
        opening=_OPENINGS.get(config.port.kind, partial(_really, trace))(config, card, root),
        kernel=kernel_facts(PRIORITY, root),
        sleeps=Setup(NullPort, card, options=options).gap_s() >= SLEEP_GAP_S,
        awake=held,
        awake_note=note,
    )


def _really(trace: Path | None, config: Config, card: Card, _root: Path) -> Opening:
    open_port = port_opener(config)
    waveform = wanted(config, trace)
    if waveform is None:
        return try_port(open_port, card)
    noted = LocalTrace(waveform.begin(), MonotonicClock())
    try:
        return try_port(lambda: noted.on(open_port()), card)
    finally:
        noted.close()


def _nothing(_config: Config, _card: Card, _root: Path) -> Opening:
    return Opening()


#: How to try what is not a parallel port.
_OPENINGS: Final[Mapping[str, Callable[[Config, Card, Path], Opening]]] = {
    "simulation": _nothing,
    "bridge": try_board,
}


def _no_worse(finding: Finding, worst: State) -> Finding:
    order = list(State)
    return replace(finding, state=min(finding.state, worst, key=order.index))
