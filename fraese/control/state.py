"""Frozen facts about the machine, for whoever displays them."""

from dataclasses import dataclass, field
from enum import Enum
from typing import Final

from fraese.alarms import AlarmKind
from fraese.blocks import OVERRIDES as OVERRIDES
from fraese.blocks import RAPID_OVERRIDES as RAPID_OVERRIDES
from fraese.config.work import ToolConfig
from fraese.control.cutting import NO_CUTTING, Cutting
from fraese.machine import three_decimals as three_decimals
from fraese.phrases import joined, phrase
from fraese.tooldata import ToolData
from fraese.workframe import SYSTEMS, WorkFrame


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
        elapsed_s: machine time since the start, without what was waited.
        expected_s: planned duration; 0 where that is not known.
        doing: what it does now, half a sentence; empty: it does not say.
        move: number of the move now being made; 0: none yet, or outside a program.
        share: what is done of it by the plan, 0 to 1; None where there is none.
        left_s: how long the rest takes with the overrides as they are; likewise.
        height_map: name of the one to which its moves are bent; empty: none.
    """

    name: str
    line: int = 0
    lines: int = 0
    blocks: int = 0
    elapsed_s: float = 0.0
    expected_s: float = 0.0
    doing: str = ""
    move: int = 0
    share: float | None = None
    left_s: float | None = None
    height_map: str = ""


@dataclass(frozen=True, slots=True)
class CutShort:
    """A program that can be gone on with: its name, and the line where it was cut short."""

    name: str
    line: int


@dataclass(frozen=True, slots=True)
class SenderFacts:
    """Another program that is connected, and may drive the machine.

    Attributes:
        name: where it is, for people; empty: there is none.
        is_out: somebody at the machine has taken over: nothing that it sends is done.
    """

    name: str = ""
    is_out: bool = False


#: Nobody is connected.
NO_SENDER: Final = SenderFacts()


@dataclass(frozen=True, slots=True)
class WorkFacts:
    """What makes work coordinates of machine coordinates, where the motors are.

    Attributes:
        system: name of the work offset in force.
        g92: whether a shift by G92 or G52 is in force.
        rotation_deg: of X and Y about Z.
        tool: number of the tool in the spindle; 0: none, or not known.
        tool_offset_mm: in force, in the order of the axes; Z is the tool's length.
        tool_length_mm: that of Z; 0 without such an axis.
        tool_diameter_mm: by the tool table; 0: it does not say.
    """

    system: str = SYSTEMS[0]
    g92: bool = False
    rotation_deg: float = 0.0
    tool: int = 0
    tool_offset_mm: tuple[float, ...] = ()
    tool_length_mm: float = 0.0
    tool_diameter_mm: float = 0.0

    @classmethod
    def of(
        cls, frame: WorkFrame, tool: int, data: ToolConfig | ToolData | None = None
    ) -> "WorkFacts":
        """Of a frame and the tool in the spindle; ``data``: what the tool table says of it."""
        return cls(
            system=SYSTEMS[frame.system - 1],
            g92=any(frame.g92),
            rotation_deg=frame.rotation_deg if frame.is_rotated else 0.0,
            tool=tool,
            tool_offset_mm=frame.tool,
            tool_length_mm=frame.tool[frame.axes.index("z")] if "z" in frame.axes else 0.0,
            tool_diameter_mm=data.diameter_mm if data is not None else 0.0,
        )

    def words(self) -> str:
        """What is not plain G54, for people; else empty."""
        said = [self.system] if self.system != SYSTEMS[0] else []
        return joined(", ", (*said, *self._others()))

    def more(self) -> str:
        """What else there is, behind the name of the system."""
        return joined("", [", " + text for text in self._others()])

    def _others(self) -> list[str]:
        said: list[str] = []
        if self.rotation_deg:
            said.append(
                phrase("rotated by {rotation_deg:g} degrees", rotation_deg=self.rotation_deg)
            )
        if self.g92:
            said.append("G92")
        if self.tool:
            said.append(phrase("tool {tool}", tool=self.tool))
        if any(self.tool_offset_mm):
            said.append(
                phrase("tool length {tool_length_mm:g} mm", tool_length_mm=self.tool_length_mm)
            )
        return said


@dataclass(frozen=True, slots=True)
class MachineState:
    """Everything that can be shown, as it was at one moment.

    Attributes:
        status: OK, RUN, CANCEL, ERROR.
        message: the last thing that a person should know; empty if there is none.
        alarm: which alarm ended the job and waits to be acknowledged; None: none.
        axes: names, in the order of all tuples here.
        position_steps: machine position.
        position_mm: the same, in mm; like all that is called so, in degrees on a rotary axis.
        work_mm: work coordinates, with everything that ``work`` says.
        offset_mm: where the work zero lies, machine coordinates.
        work: what is in force.
        cutting: feed and spindle of the program in hand, or of the last one.
        referenced: per axis.
        low_mm: soft limits; they count for a referenced axis; infinite on an endless one.
        high_mm: likewise.
        speed_mm_min: along the path, now.
        speed_unit: of the path: "mm", or "°" where only rotary axes move; a minute.
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
        rapid_override: of rapids, a factor.
        obeys_override: an override acts on what is done now.
        single_block: a program waits after every line that moves.
        optional_stop: M1 stops.
        block_delete: lines that begin with a slash are left out.
        question: what the operator is asked, with the job waiting; empty if nothing.
        waits_for: what it waits for then, in a word: "tool 2".
        units: "mm" or "°", per axis.
        step_word: what one step is called: half-step, quarter-step, pulse.
        carriages_mm: of a simulated mill, where the carriages really are; empty at metal. To be
            compared with ``position_mm``; for the zero see ``control/onlooker.py``.
        lost_steps: likewise, steps of this job that were asked for and not made, signed.
        lost_why: likewise, why, half a sentence; empty: none.
        to_go_mm: what is left of the move in hand, by hand or of a program, per axis; empty at
            rest.
        phases: phase index of every motor; on a drive of its own it says nothing.
        cut_short: the last program, if it was; None: it ended well, or another one runs.
        sender: another program that is connected.
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
    speed_unit: str = "mm"
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
    waits_for: str = ""
    override: float = 1.0
    rapid_override: float = 1.0
    obeys_override: bool = True
    single_block: bool = False
    optional_stop: bool = False
    block_delete: bool = False
    work: WorkFacts = WorkFacts()
    cutting: Cutting = NO_CUTTING
    units: tuple[str, ...] = ()
    step_word: str = "step"
    carriages_mm: tuple[float, ...] = ()
    lost_steps: tuple[float, ...] = ()
    lost_why: tuple[str, ...] = ()
    alarm: AlarmKind | None = None
    to_go_mm: tuple[float, ...] = ()
    cut_short: CutShort | None = None
    sender: SenderFacts = NO_SENDER
    phases: tuple[int, ...] = ()
