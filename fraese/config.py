"""The configuration: one TOML file, strictly read, every key with a sentence and its unit.

Rule 1: an unknown key is refused by name; a typing error never goes unnoticed.
Rule 2: every bound is stated here, in the field, and nowhere else.
"""

import re
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

AXIS_NAMES = ("x", "y", "z")
_GEAR = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?|[0-9]{1,9}/[0-9]{1,9}")
_TOOL = re.compile(r"[0-9]{1,9}")
_DEVICE = re.compile(r"(/[^\x00-\x1f\x7f]{1,200}|COM[0-9]{1,3})?")
#: Travel of an axis; the upper bound is what counters of 32 bits hold with room to spare.
_FEWEST_STEPS = 10
_MOST_STEPS = 1_000_000_000
AxisName = Literal["x", "y", "z"]

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Band = tuple[Positive, Positive]


class Section(BaseModel):
    """A table of the file; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class AxisConfig(Section):
    """One axis: how steps become millimetres, and what its motor can follow."""

    steps_per_rev: int = Field(
        400,
        ge=1,
        le=1_000_000,
        description=(
            "Smallest steps in one turn of the motor: half-steps on a phase card, else pulses."
        ),
    )
    pitch_mm: Decimal = Field(
        Decimal("2"),
        gt=0,
        le=1000,
        decimal_places=9,
        description=("Way of the carriage in one turn of the spindle, mm."),
    )
    gear: str = Field(
        "1",
        description=(
            'Turns of the motor for one turn of the spindle, a number or a ratio such as "5/2".'
        ),
    )
    travel_mm: Decimal = Field(
        Decimal("300"),
        gt=0,
        le=100_000,
        decimal_places=9,
        description=("Way from one end switch to the other, mm."),
    )
    inverted: bool = Field(
        False, description=("Whether the motor turns the other way round for positive moves.")
    )
    max_rate_hz: float = Field(
        4000, gt=0, le=200_000, description=("Highest step rate of the motor, steps/s.")
    )
    start_rate_hz: float = Field(
        800,
        gt=0,
        le=200_000,
        description=("Start/stop rate, steps/s: below it the motor needs no ramp."),
    )
    acceleration_hz_s: float = Field(
        20_000,
        gt=0,
        le=100_000_000,
        description=("Change of the step rate in a ramp, steps/s per second."),
    )
    home_end: Literal["min", "max"] = Field(
        "min", description=("The end switch to which the axis is referenced.")
    )
    backlash_mm: Decimal = Field(
        Decimal("0"),
        ge=0,
        le=10,
        decimal_places=9,
        description=("Way that is lost when the axis turns round, mm; made up for with steps."),
    )
    avoid_hz: tuple[Band, ...] = Field(
        (),
        max_length=8,
        description=(
            "Bands of step rates in which the motor resonates, pairs of steps/s: no move keeps a"
            " rate within one, ramps pass through."
        ),
    )

    @field_validator("gear", mode="before")
    @classmethod
    def _ratio(cls, value: Any) -> str:
        text = str(value).replace(":", "/").replace(" ", "")
        if not _GEAR.fullmatch(text) or not all(map(Fraction, text.split("/"))):
            raise ValueError('must be a positive number or ratio such as "5/2"')
        return text

    @field_validator("avoid_hz")
    @classmethod
    def _from_below(cls, value: tuple[Band, ...]) -> tuple[Band, ...]:
        if any(low_hz >= high_hz for low_hz, high_hz in value):
            raise ValueError("a band is a lower and a higher rate, in this order")
        return value

    @model_validator(mode="after")
    def _rates(self) -> "AxisConfig":
        if self.start_rate_hz > self.max_rate_hz:
            raise ValueError(
                f"start_rate_hz ({self.start_rate_hz:g}) must not be above"
                f" max_rate_hz ({self.max_rate_hz:g})"
            )
        return self

    def steps_per_mm(self) -> Fraction:
        """Exactly, as a fraction."""
        return Fraction(self.steps_per_rev) * Fraction(self.gear) / Fraction(self.pitch_mm)


class AxesConfig(Section):
    """The three axes."""

    x: AxisConfig = Field(AxisConfig(), description="The X axis.")
    y: AxisConfig = Field(AxisConfig(travel_mm=Decimal("200")), description="The Y axis.")
    z: AxisConfig = Field(
        AxisConfig(travel_mm=Decimal("60"), home_end="max"), description="The Z axis, vertical."
    )

    @model_validator(mode="before")
    @classmethod
    def _own_defaults(cls, value: Any) -> Any:
        """A table that names some keys of an axis leaves the others at that axis' defaults."""
        if not isinstance(value, dict):
            return value
        own: dict[str, dict[str, Any]] = {
            "y": {"travel_mm": Decimal("200")},
            "z": {"travel_mm": Decimal("60"), "home_end": "max"},
        }
        return {
            name: {**own.get(name, {}), **given} if isinstance(given, dict) else given
            for name, given in value.items()
        }


class OutputConfig(Section):
    """One free output on a control pin."""

    pin: Literal[1, 14, 16, 17] = Field(description="DB25 pin of the control register.")
    active_high: bool = Field(True, description="Whether a high pin means on.")


class OutputsConfig(Section):
    """What hangs on the free outputs; what is not named is switched by hand."""

    spindle: OutputConfig | None = Field(None, description="Spindle relay.")
    coolant: OutputConfig | None = Field(None, description="Coolant or extraction relay.")
    laser: OutputConfig | None = Field(
        None,
        description=(
            "Laser: follows M3, M4 and M5 without a stop, and is off whenever the motors stand."
        ),
    )
    enable: OutputConfig | None = Field(
        None,
        description=(
            "Enable line of step/direction drives; without it their current cannot be switched off."
        ),
    )

    heartbeat: OutputConfig | None = Field(
        None,
        description=(
            "Charge pump: toggles while the step loop of a parallel port lives, for drives that"
            " switch off without it."
        ),
    )

    def configured(self) -> list[tuple[str, OutputConfig]]:
        """Names and pins of the outputs there are; the place is the bit that a driver knows."""
        return [(name, output) for name, output in self if output is not None]

    def bit(self, name: str) -> int | None:
        """Bit of an output, or None where nothing hangs on it."""
        names = [name for name, _ in self.configured()]
        return names.index(name) if name in names else None

    def mask(self, *names: str) -> int:
        """Bits of those of these outputs that there are."""
        bits = (self.bit(name) for name in names)
        return sum(1 << bit for bit in bits if bit is not None)


class CardConfig(Section):
    """The electronics between port and motors."""

    kind: Literal["smc1500", "stepdir"] = Field(
        "smc1500",
        description=(
            'Phase-current card ("smc1500", also SMC800) or step/direction drives ("stepdir").'
        ),
    )
    table: str = Field(
        "motrun",
        description=("Phase table: motrun, field-60, field-20, full-step, or its bytes in hex."),
    )
    levels: Literal["field", "seed"] = Field(
        "field",
        description=(
            "What the middle current codes mean: field 01 = 60 %, 10 = 20 %; seed: vice versa."
        ),
    )
    holding_percent: int = Field(
        0,
        ge=0,
        le=100,
        description=(
            "Current at standstill when it is held, per cent of the running current; 0: off."
        ),
    )
    profile: Literal["x4step", "paper"] = Field(
        "x4step", description=("Pulse timing of step/direction drives.")
    )
    clock_idles_high: bool = Field(False, description="Resting level of the clock lines.")
    forward_high: bool = Field(True, description="Level of the direction lines for positive steps.")


class PortConfig(Section):
    """How the registers are reached."""

    kind: Literal["simulation", "ppdev", "devport", "bridge"] = Field(
        "simulation",
        description=(
            "The simulated mill; a parallel port by its driver, or by its address (root only); a"
            " bridge on a serial port."
        ),
    )
    device: str = Field(
        "",
        description=(
            'Full path, for "ppdev" and "bridge"; empty: /dev/parport0, or the only board that'
            " looks like an Arduino."
        ),
    )
    baud: int = Field(
        250_000,
        ge=9_600,
        le=2_000_000,
        description='Rate of the serial port, for "bridge": the one the firmware was built for.',
    )
    base: int = Field(
        0x378,
        ge=0x100,
        le=0xFFFC,
        multiple_of=4,
        description=(
            'I/O address of the data register, for "devport"; 888 is 0x378, the first port of most'
            " machines."
        ),
    )

    @field_validator("device")
    @classmethod
    def _full_path(cls, value: str) -> str:
        if not _DEVICE.fullmatch(value):
            raise ValueError("must be the full path of a device file, such as /dev/parport0")
        return value

    @property
    def parallel_device(self) -> str:
        """Device file for ppdev."""
        return self.device or "/dev/parport0"


class RealtimeConfig(Section):
    """The process that makes the steps on a parallel port."""

    core: int | None = Field(
        None,
        ge=0,
        description="Processor that it stays on; without one, the one that is disturbed least.",
    )
    silent_s: float = Field(
        2,
        ge=0.2,
        le=60,
        description=(
            "When it, or the bridge, hears nothing from the program for so long while motors run,"
            " it brakes and switches off, s."
        ),
    )
    heartbeat_hz: float = Field(
        100, gt=0, le=500, description="Periods a second of outputs.heartbeat."
    )


class SwitchesConfig(Section):
    """The shared end-switch input."""

    mode: Literal["stop", "ignore"] = Field(
        "stop",
        description=("What a contact does: stop the motors, or nothing (for trying things out)."),
    )
    pin: Literal[10, 11, 12, 13, 15] = Field(11, description="DB25 pin of the status register.")
    closed_reads: Literal[0, 1] = Field(
        0, description=("How the pin's register bit reads with contact.")
    )
    readings: int = Field(
        3,
        ge=1,
        le=100,
        description=(
            "Equal readings in a row that make or end a contact; 1 is the original's behaviour."
        ),
    )


class StandstillConfig(Section):
    """Current between jobs."""

    current: Literal["off", "hold"] = Field(
        "off", description=("Motors off at standstill, or on holding current.")
    )
    delay_s: float = Field(
        0,
        ge=0,
        le=3600,
        description=("Wait after the end of a run before the current is changed, s."),
    )
    settle_ms: float = Field(
        20,
        ge=0,
        le=5000,
        description=("Wait after switching the current on, before the first step, ms."),
    )


class HomingConfig(Section):
    """The reference run."""

    order: tuple[AxisName, ...] = Field(
        ("z", "x", "y"),
        min_length=1,
        description=("Axes in the order in which they are referenced; the vertical one first."),
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
    def _no_axis_twice(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(value)) != len(value):
            raise ValueError("names an axis twice")
        return value


class JogConfig(Section):
    """Moving by hand."""

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
    confirm_spindle: bool = Field(
        False,
        description=(
            "Whether the operator must confirm that a spindle switched by hand runs or stands."
        ),
    )
    spin_up_s: float = Field(
        2, ge=0, le=60, description="Wait after switching a configured spindle output on, s."
    )
    safe_z_mm: float | None = Field(
        None,
        description=(
            "Height for moves above the work, machine coordinates, mm; without it, the upper end"
            " of the travel."
        ),
    )
    retract_mm: NotNegative = Field(
        0, description="How far the tool is lifted while a program is held, mm; 0: it stays."
    )
    list_unit: Literal["mm", "inch"] = Field(
        "mm", description="Unit of coordinate lists that do not say theirs."
    )
    lead_s: float = Field(
        0.3, ge=0.05, le=10, description=("Motion kept in the queue ahead of the motors, s.")
    )


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
        1,
        ge=0.1,
        le=3600,
        description=(
            "Longer moves are cut into blocks of this time, s, so that an override acts soon."
        ),
    )
    window: int = Field(
        200, ge=8, le=10_000, description=("Segments that the look-ahead holds at most.")
    )


class ToolConfig(Section):
    """One tool of the tool table."""

    length_mm: float = Field(0, description="Length offset that G43 applies, mm.")
    diameter_mm: NotNegative = Field(0, description="Diameter, mm.")


class ProbeConfig(Section):
    """The probe of G38.2 to G38.5."""

    pin: Literal[10, 11, 12, 13, 15] | None = Field(
        None,
        description=(
            "DB25 pin of the status register; without one the probe shares the end switches' input."
        ),
    )
    closed_reads: Literal[0, 1] = Field(
        0, description="How the register bit of a pin of its own reads with contact."
    )


class SimulationConfig(Section):
    """The simulated mill."""

    max_rate_hz: Positive = Field(6000, description="Above it a rotor stalls, steps/s.")
    jump_hz: Positive = Field(1200, description="Start/stop rate of a rotor, steps/s.")
    acceleration_hz_s: Positive = Field(
        60_000, description=("Change of rate that a rotor can follow, steps/s per second.")
    )
    snaps_to_pole: bool = Field(
        False,
        description=(
            "Whether a rotor without current turns to its nearest pole; else friction holds it."
        ),
    )
    overrun_mm: NotNegative = Field(
        2, description=("Way of a carriage behind its switch, to the mechanical end, mm.")
    )
    backlash_mm: NotNegative = Field(
        0, description="How far a spindle turns back before its carriage follows, mm."
    )
    lag_ms: float = Field(
        0, ge=0, le=1000, description=("From the carriage's arrival to the contact, ms.")
    )
    bounce_readings: int = Field(
        0, ge=0, le=100, description=("Readings after each change that bounce.")
    )


class LogConfig(Section):
    """The log file."""

    enabled: bool = Field(False, description="Whether the log is on from the start.")
    file: str = Field(
        "", description=("Where it is written; empty: fraese.log in the user's state folder.")
    )


class Config(Section):
    """The whole file."""

    axes: AxesConfig = AxesConfig()
    card: CardConfig = CardConfig()
    port: PortConfig = PortConfig()
    realtime: RealtimeConfig = RealtimeConfig()
    outputs: OutputsConfig = OutputsConfig()
    switches: SwitchesConfig = SwitchesConfig()
    standstill: StandstillConfig = StandstillConfig()
    homing: HomingConfig = HomingConfig()
    jog: JogConfig = JogConfig()
    run: RunConfig = RunConfig()
    planner: PlannerConfig = PlannerConfig()
    probe: ProbeConfig = ProbeConfig()
    tools: dict[str, ToolConfig] = Field(
        default_factory=dict,
        description="Tool table by tool number; empty: every tool is allowed and has length 0.",
    )
    simulation: SimulationConfig = SimulationConfig()
    log: LogConfig = LogConfig()

    @field_validator("tools")
    @classmethod
    def _numbered(cls, value: dict[str, ToolConfig]) -> dict[str, ToolConfig]:
        for key in value:
            if not _TOOL.fullmatch(key):
                raise ValueError(
                    f'tools are named by number, as in [tools.1]; "{key[:40]}" is none'
                )
        return value

    @model_validator(mode="after")
    def _fits_together(self) -> "Config":
        for name in AXIS_NAMES:
            travel_mm = getattr(self.axes, name).travel_mm
            usable_mm = Fraction(travel_mm) - 2 * Fraction(self.homing.pull_off_mm)
            if usable_mm <= 0:
                raise ValueError(
                    f"homing.pull_off_mm ({self.homing.pull_off_mm:g}) leaves nothing of"
                    f" axes.{name}.travel_mm ({travel_mm:g})"
                )
            steps = usable_mm * getattr(self.axes, name).steps_per_mm()
            if not _FEWEST_STEPS <= steps <= _MOST_STEPS:
                raise ValueError(
                    f"steps_per_rev, gear and pitch_mm of axes.{name} give its travel"
                    f" {float(steps):.3g} steps; it must be {_FEWEST_STEPS} to {_MOST_STEPS}"
                )
        self._check_safe_z()
        self._check_probe()
        taken = {"smc1500": {1}, "stepdir": {16, 17}}[self.card.kind]
        for name, output in self.outputs:
            if output is None:
                continue
            if output.pin in taken:
                raise ValueError(
                    f"outputs.{name}.pin {output.pin} is taken already (card {self.card.kind})"
                )
            taken.add(output.pin)
        return self

    def _check_safe_z(self) -> None:
        z, safe_mm = self.axes.z, self.run.safe_z_mm
        usable_mm = float(z.travel_mm) - 2 * self.homing.pull_off_mm
        low_mm = 0 if z.home_end == "min" else -usable_mm
        if safe_mm is not None and not low_mm <= safe_mm <= low_mm + usable_mm:
            raise ValueError(
                f"run.safe_z_mm ({safe_mm:g}) is outside the travel of Z,"
                f" {low_mm:g} to {low_mm + usable_mm:g} mm in machine coordinates"
            )

    def _check_probe(self) -> None:
        probe, switches = self.probe, self.switches
        if probe.pin == switches.pin and probe.closed_reads != switches.closed_reads:
            raise ValueError(
                f"probe.closed_reads ({probe.closed_reads}) differs from switches.closed_reads"
                f" ({switches.closed_reads}), on the same pin; leave out probe.pin"
            )
