"""How the machine is worked with: reference run, jogging, programs, planning, tools, log."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, field_validator

from fraese.config.axes import AxisName
from fraese.config.chosen import NameOf
from fraese.config.section import NotNegative, Positive, Section
from fraese.peers import RAMPS
from fraese.phrases import phrase


class HomingConfig(Section):
    """The reference run; on a rotary axis read degrees for mm."""

    order: tuple[AxisName, ...] | None = Field(
        None,
        min_length=1,
        description=(
            "Axes in the order in which they are referenced; without it z first, then the others"
            " that have end switches."
        ),
    )
    approach_mm_min: Positive = Field(600, description="Feed towards the switch, mm/min.")
    slow_mm_min: Positive = Field(
        60, description=("Feed of backing off and of the second approach, mm/min.")
    )
    back_off_max_mm: Positive = Field(
        5, description=("Within this way the switch must open again, mm.")
    )
    resolve_mm: Positive = Field(
        1.5,
        description=(
            "How far a candidate is backed off when a switch is closed at the start, mm;"
            " shorter than the way from a switch to the mechanical end."
        ),
    )
    pull_off_mm: Positive = Field(
        2, description=("Distance from the switch that becomes machine zero, mm.")
    )
    search_factor: float = Field(
        1.1,
        ge=1,
        le=10,
        description=("The switch must be found within this many times the travel."),
    )
    measure: bool = Field(
        False, description=("Whether to run to the other end too and measure the travel.")
    )

    @field_validator("order")
    @classmethod
    def _no_axis_twice(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        if value is not None and len(set(value)) != len(value):
            raise ValueError(phrase("names an axis twice"))
        return value


class JogConfig(Section):
    """Moving by hand; on a rotary axis read degrees for mm."""

    feed_mm_min: Positive = Field(600, description="Feed of jog moves, mm/min.")
    max_mm: Positive = Field(50, description="Longest single jog, mm.")


class RunConfig(Section):
    """Working through a program."""

    unreferenced: Literal["slow", "forbid"] = Field(
        "slow",
        description=(
            "A job on a machine that is not referenced runs at reduced rate with a warning, or not."
        ),
    )
    unreferenced_percent: float = Field(
        50, gt=0, le=100, description=("Feed of such a job, per cent.")
    )
    default_feed_mm_min: Positive = Field(
        300, description=("Feed of straight moves commanded without one, mm/min.")
    )
    optional_stop: bool = Field(False, description="Whether M1 stops.")
    block_delete: bool = Field(
        False, description="Whether lines that start with a slash are left out."
    )
    confirm_spindle: Literal["first", "every", "never"] = Field(
        "first",
        description=(
            "When the operator confirms a spindle switched by hand: its first start in a job, every"
            " change, or never."
        ),
    )
    spin_up_s: float = Field(
        2, ge=0, le=60, description="Wait after switching a configured spindle output on, s."
    )
    safe_z_mm: float | None = Field(
        None,
        description=(
            "Height of Z for moves above the work, machine coordinates, mm; without it, the upper"
            " end of the travel."
        ),
    )
    retract_mm: NotNegative = Field(
        0, description="How far Z lifts the tool while a program is held, mm; 0: it stays."
    )
    subroutine_folders: tuple[str, ...] = Field(
        (),
        description=(
            "Where o<name> call looks for name.ngc behind the program's own folder, in this order;"
            " whole paths, or from ~ on."
        ),
    )
    ignored_m_codes: tuple[int, ...] = Field(
        (),
        description="Which of M100 to M199 programs may have without effect; others are refused.",
    )
    m_code_folder: str = Field(
        "",
        description=(
            "Folder with programs M100 to M199 that these codes carry out, with P and Q, and all"
            " rights that you have; empty: none is."
        ),
    )
    list_unit: Literal["mm", "inch"] = Field(
        "mm", description="Unit of coordinate lists that do not say theirs."
    )
    lead_s: float = Field(
        0.2,
        ge=0.05,
        le=10,
        description=(
            "Motion kept ahead of the motors, s; more where stopping takes longer. They brake when"
            " half of it is played and not recorded."
        ),
    )

    @field_validator("confirm_spindle", mode="before")
    @classmethod
    def _as_before(cls, value: object) -> object:
        """Once it was yes or no."""
        if isinstance(value, bool):
            return "every" if value else "never"
        return value

    @field_validator("subroutine_folders", "m_code_folder")
    @classmethod
    def _are_whole(cls, value: str | tuple[str, ...]) -> str | tuple[str, ...]:
        for folder in (value or "~",) if isinstance(value, str) else value:
            if not (folder.startswith("~") or Path(folder).is_absolute()):
                raise ValueError(
                    phrase('"{folder}" is no whole path; begin it with / or ~', folder=folder[:80])
                )
        return value

    @field_validator("ignored_m_codes")
    @classmethod
    def _are_free(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        for code in value:
            if not 100 <= code <= 199:
                raise ValueError(
                    phrase("M{code} is none of M100 to M199, which are the user's own", code=code)
                )
        return value

    @property
    def programs(self) -> Path | None:
        """Where programs for M100 to M199 lie; None: nowhere."""
        return Path(self.m_code_folder).expanduser() if self.m_code_folder else None

    @property
    def folders(self) -> tuple[Path, ...]:
        """Subroutine folders as paths."""
        return tuple(Path(folder).expanduser() for folder in self.subroutine_folders)


class PlannerConfig(Section):
    """How moves become motion."""

    chord_tolerance_mm: float = Field(
        0.005,
        gt=0,
        le=1,
        description=("Greatest distance of an arc's chords from the true arc, mm."),
    )
    min_block_ms: float = Field(
        4,
        ge=0,
        le=100,
        description=(
            "Time that blocks take at least, in the mean of eight, ms: very short segments are"
            " driven slower, so that a small queue is not outrun."
        ),
    )
    max_block_s: float = Field(
        0.05,
        ge=0.02,
        le=3600,
        description=(
            "Longer moves are cut into blocks of this time, s, so that an override acts soon."
        ),
    )
    ramp: Annotated[str, NameOf(RAMPS)] = Field(
        "linear",
        description=(
            "How rates change: with constant acceleration, or one that comes and goes, never above"
            " that of the axes."
        ),
    )
    jerk_ms: float = Field(
        50,
        gt=0,
        le=1000,
        description="Time in which the acceleration comes to its full value at least, s-curve, ms.",
    )
    window: int = Field(
        200, ge=8, le=10_000, description=("Segments that the look-ahead holds at most.")
    )


class ToolConfig(Section):
    """One tool of the tool table."""

    length_mm: float = Field(0, description="Length offset that G43 applies, mm.")
    diameter_mm: NotNegative = Field(0, description="Diameter, mm.")
    remark: str = Field("", max_length=40, description="What it is, for people.")


class LogConfig(Section):
    """The log file."""

    enabled: bool = Field(False, description="Whether the log is on from the start.")
    file: str = Field(
        "", description=("Where it is written; empty: fraese.log in the user's state folder.")
    )
