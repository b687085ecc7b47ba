"""Frozen facts about the machine, for whoever displays them."""

from dataclasses import dataclass, field
from enum import Enum


class Status(Enum):
    """Where the controller is (seed: CNC_OK, CNC_RUN, CNC_CANCEL; and an error)."""

    OK = "OK"
    RUN = "RUN"
    CANCEL = "CANCEL"
    ERROR = "ERROR"


@dataclass(frozen=True, slots=True)
class JobProgress:
    """The job in hand.

    Attributes:
        name: what is being done, for people.
        line: line of the program now being played; 0 outside a program.
        lines: how many lines the program has; 0 where that is not known.
        blocks: blocks pushed so far.
        elapsed_s: machine time since the start.
        expected_s: planned duration; 0 where that is not known.
    """

    name: str
    line: int = 0
    lines: int = 0
    blocks: int = 0
    elapsed_s: float = 0.0
    expected_s: float = 0.0


@dataclass(frozen=True, slots=True)
class MachineState:
    """Everything that can be shown, as it was at one moment.

    Attributes:
        status: OK, RUN, CANCEL, ERROR.
        message: the last thing that a person should know; empty if there is none.
        axes: names, in the order of all tuples here.
        position_steps: machine position.
        position_mm: the same, in mm.
        work_mm: seen from the work zero.
        offset_mm: where the work zero lies.
        referenced: per axis.
        low_mm: soft limits; they count for a referenced axis.
        high_mm: likewise.
        speed_mm_min: along the path, now.
        running: steps are being made.
        held: feed hold: the motors stand, the job waits.
        energised: the coils have full current.
        switch_closed: contact.
        ends: names of the ends that the contact may be ("xmin"); one: certain.
        switch_ignored: contacts do not stop the motors.
        inputs: the five inputs as pin levels, by DB25 pin (11, 10, 12, 13, 15).
        job: what is being done, or None.
        log_on: the log is being written.
        late_ticks: ticks that came late since the start.
        dry_queues: times the queue ran dry since the start.
        override: feed override, a factor.
        question: what the operator is asked, with the job waiting; empty if nothing.
    """

    status: Status
    message: str
    axes: tuple[str, ...]
    position_steps: tuple[int, ...]
    position_mm: tuple[float, ...]
    work_mm: tuple[float, ...]
    offset_mm: tuple[float, ...]
    referenced: tuple[bool, ...]
    low_mm: tuple[float, ...]
    high_mm: tuple[float, ...]
    speed_mm_min: float = 0.0
    running: bool = False
    held: bool = False
    energised: bool = False
    switch_closed: bool = False
    ends: tuple[str, ...] = ()
    switch_ignored: bool = False
    inputs: dict[int, bool] = field(default_factory=dict)
    job: JobProgress | None = None
    log_on: bool = False
    late_ticks: int = 0
    dry_queues: int = 0
    question: str = ""
    override: float = 1.0
