"""The whole configuration, and what must fit together in it."""

import re
from fractions import Fraction
from typing import Literal

from pydantic import Field, field_validator, model_validator

from fraese.config.axes import VERTICAL, AxesConfig
from fraese.config.axis import AxisConfig
from fraese.config.chosen import known_card, known_port
from fraese.config.outputs import PULSED_PIN, OutputsConfig
from fraese.config.person import KeyNames, MacroConfig
from fraese.config.section import Section
from fraese.config.serving import ServeConfig
from fraese.config.simulation import SimulationConfig
from fraese.config.switches import ProbeConfig, SwitchesConfig, SwitchLine
from fraese.config.wiring import (
    CardConfig,
    PortConfig,
    RealtimeConfig,
    StandstillConfig,
)
from fraese.config.work import (
    HomingConfig,
    JogConfig,
    LogConfig,
    PlannerConfig,
    RunConfig,
    ToolConfig,
)
from fraese.config.x4step import X4StepConfig
from fraese.phrases import phrase

_TOOL = re.compile(r"[0-9]{1,9}")
#: Travel of an axis; the upper bound is what counters of 32 bits hold with room to spare.
_FEWEST_STEPS = 10
_MOST_STEPS = 1_000_000_000
#: Keys of a simulated axis that an axis of this kind has not.
_NOT_OF_KIND = {
    "linear": {"pitch_deg", "travel_deg"},
    "rotary": {"pitch_mm", "travel_mm"},
}


class Config(Section):
    """The whole file."""

    language: Literal["en", "de"] | None = Field(
        default=None, description="Language of the program; by default the system's."
    )
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
    x4step: X4StepConfig = X4StepConfig()
    serve: ServeConfig = ServeConfig()
    log: LogConfig = LogConfig()
    keys: dict[str, KeyNames] = Field(
        default_factory=dict,
        description=(
            "Keys of the app that are changed: by the name of the action, a key or a list of keys;"
            " fraese config keys lists both. Escape and Ctrl+C always stop."
        ),
    )
    macros: tuple[MacroConfig, ...] = Field(
        (),
        max_length=30,
        description="Buttons of one's own in Move, with lines of G-code or a file.",
    )

    @field_validator("tools")
    @classmethod
    def _numbered(cls, value: dict[str, ToolConfig]) -> dict[str, ToolConfig]:
        for key in value:
            if not _TOOL.fullmatch(key):
                raise ValueError(
                    phrase(
                        'tools are named by number, as in [tools.1]; "{key}" is none', key=key[:40]
                    )
                )
        return value

    @model_validator(mode="after")
    def _fits_together(self) -> "Config":
        self.must_fit_together()
        return self

    def must_fit_together(self) -> None:
        """What no table can see by itself.

        Raises:
            ValueError: if two tables contradict each other.
        """
        self._check_sockets()
        for name, axis in self.axes.table.items():
            self._check_travel(name, axis)
        self._check_order()
        self._check_safe_z()
        self._check_probe()
        self._check_switches()
        self._check_outputs()
        self._check_simulation()

    def _check_sockets(self) -> None:
        kind = self.card.kind
        names, most = self.axes.names, known_card(kind).sockets
        if len(names) > most:
            raise ValueError(
                phrase(
                    'card.kind "{kind}" drives {most} motors at most, but axes.names has'
                    " {count}: {names}",
                    kind=kind,
                    most=most,
                    count=len(names),
                    names=", ".join(names),
                )
            )
        taken: dict[int, str] = {}
        for name, socket in zip(names, self.axes.sockets, strict=True):
            if socket >= most:
                raise ValueError(
                    phrase(
                        'axes.{name}.motor ({socket}) is no socket of card.kind "{kind}",'
                        " which has 1 to {most}",
                        name=name,
                        socket=socket + 1,
                        kind=kind,
                        most=most,
                    )
                )
            if socket in taken:
                raise ValueError(
                    phrase(
                        "axes.{taken}.motor and axes.{name}.motor are both {socket}; by"
                        " default an axis has its place in axes.names",
                        taken=taken[socket],
                        name=name,
                        socket=socket + 1,
                    )
                )
            taken[socket] = name

    def _check_travel(self, name: str, axis: AxisConfig) -> None:
        if axis.travel is None:
            return
        key = f"axes.{name}.travel_{axis.key_unit}"
        usable = Fraction(axis.travel) - 2 * Fraction(self.pull_off(axis))
        if usable <= 0:
            raise ValueError(
                phrase(
                    "homing.pull_off_mm ({pull_off_mm:g}) leaves nothing of {key} ({travel:g})",
                    pull_off_mm=self.homing.pull_off_mm,
                    key=key,
                    travel=axis.travel,
                )
            )
        steps = usable * axis.steps_per_unit()
        if not _FEWEST_STEPS <= steps <= _MOST_STEPS:
            raise ValueError(
                phrase(
                    "steps_per_rev, gear and pitch_{key_unit} of axes.{name} give its travel"
                    " {steps:.3g} steps; it must be {fewest_steps} to {most_steps}",
                    key_unit=axis.key_unit,
                    name=name,
                    steps=float(steps),
                    fewest_steps=_FEWEST_STEPS,
                    most_steps=_MOST_STEPS,
                )
            )

    def _check_order(self) -> None:
        for name in self.homing.order or ():
            axis = self.axes.table.get(name)
            if axis is None:
                raise ValueError(
                    phrase('homing.order names "{name}", which is not among axes.names', name=name)
                )
            if not axis.has_switches:
                raise ValueError(
                    phrase(
                        'homing.order names "{name}", which has no end switches: leave it'
                        " out; it is referenced by its name, home {name_2}",
                        name=name,
                        name_2=name.upper(),
                    )
                )

    def _check_safe_z(self) -> None:
        z, safe_mm = self.axes.table.get(VERTICAL), self.run.safe_z_mm
        if z is None and self.run.retract_mm:
            raise ValueError(phrase("run.retract_mm lifts Z, and there is no z in axes.names"))
        if safe_mm is None:
            return
        if z is None:
            raise ValueError(
                phrase("run.safe_z_mm is a height of Z, and there is no z in axes.names")
            )
        if z.travel is None:
            return
        usable_mm = float(z.travel) - 2 * self.pull_off(z)
        low_mm = 0 if z.home_end == "min" else -usable_mm
        if not low_mm <= safe_mm <= low_mm + usable_mm:
            raise ValueError(
                phrase(
                    "run.safe_z_mm ({safe_mm:g}) is outside the travel of Z, {low_mm:g} to"
                    " {low_mm_2:g} mm in machine coordinates",
                    safe_mm=safe_mm,
                    low_mm=low_mm,
                    low_mm_2=low_mm + usable_mm,
                )
            )

    def _check_probe(self) -> None:
        probe, switches = self.probe, self.switches
        if probe.pin == switches.pin and probe.closed_reads != switches.closed_reads:
            raise ValueError(
                phrase(
                    "probe.closed_reads ({closed_reads}) differs from switches.closed_reads"
                    " ({closed_reads_2}), on the same pin; leave out probe.pin",
                    closed_reads=probe.closed_reads,
                    closed_reads_2=switches.closed_reads,
                )
            )

    @property
    def switch_lines(self) -> tuple[SwitchLine, ...]:
        """Every input with switches on it."""
        return self.switches.lines(self._ends)

    @property
    def _ends(self) -> list[str]:
        """Names of all ends that have a switch."""
        axes = self.axes.table.items()
        return [name + end for name, axis in axes if axis.has_switches for end in ("min", "max")]

    def _check_switches(self) -> None:
        pins: dict[int, str]
        pins = {} if self.probe.pin in (None, self.switches.pin) else {self.probe.pin: "probe"}
        seen: set[tuple[str, bool]] = set()
        for line in self.switch_lines:
            key = f"switches.own.{line.name}" if line.name else "switches"
            if line.pin in pins:
                raise ValueError(
                    phrase(
                        "{key}.pin {pin} is that of {other} already",
                        key=key,
                        pin=line.pin,
                        other=pins[line.pin],
                    )
                )
            pins[line.pin] = key
            for end in sorted(line.ends):
                if end not in self._ends:
                    raise ValueError(
                        phrase(
                            '{key}.ends: there is no end switch "{end}"; there are {ends}',
                            key=key,
                            end=end[:40],
                            ends=", ".join(self._ends) or phrase("none"),
                        )
                    )
                if (end, line.stops) in seen:
                    raise ValueError(
                        phrase("{key}.ends: {end} is on another input already", key=key, end=end)
                    )
                seen.add((end, line.stops))

    def _check_outputs(self) -> None:
        taken = set(known_card(self.card.kind).taken_pins)
        for name, output in self.outputs.configured():
            if output.pin in taken:
                raise ValueError(
                    phrase(
                        "outputs.{name}.pin {pin} is taken already (card {kind})",
                        name=name,
                        pin=output.pin,
                        kind=self.card.kind,
                    )
                )
            taken.add(output.pin)
        self._check_laser()

    def _check_laser(self) -> None:
        laser = self.outputs.laser
        if laser is None or not laser.pwm:
            return
        if not known_port(self.port.kind).sets_power:
            raise ValueError(
                phrase(
                    "outputs.laser.pwm needs port.kind bridge; with {kind} a laser is on or off",
                    kind=self.port.kind,
                )
            )
        if laser.pin != PULSED_PIN:
            raise ValueError(
                phrase(
                    "outputs.laser.pwm needs outputs.laser.pin {wanted}, not {pin}",
                    wanted=PULSED_PIN,
                    pin=laser.pin,
                )
            )

    def _check_simulation(self) -> None:
        """What is said of a simulated axis is said of one that there is, in its unit."""
        for name, own in self.simulation.axes.items():
            if name not in self.axes.table:
                raise ValueError(
                    phrase("simulation.axes.{name}: there is no {name} in axes.names", name=name)
                )
            axis = self.axes.table[name]
            for key in sorted(own.model_fields_set & _NOT_OF_KIND[axis.kind]):
                stem = key.rpartition("_")[0]
                raise ValueError(
                    phrase(
                        "simulation.axes.{name}.{key}: {name} is a {kind} axis; its key is"
                        " {stem}_{key_unit}",
                        name=name,
                        key=key,
                        kind=axis.kind,
                        stem=stem,
                        key_unit=axis.key_unit,
                    )
                )
        taken: dict[int, str] = {}
        for axis_name, configured in self.axes.table.items():
            socket = self.simulation.own(axis_name).motor or configured.motor
            if socket in taken:
                raise ValueError(
                    phrase(
                        "simulation: the motors of {taken} and {axis_name} hang on the same"
                        " socket, {socket}; give simulation.axes.{axis_name}.motor another",
                        taken=taken[socket],
                        axis_name=axis_name,
                        socket=socket,
                    )
                )
            taken[socket] = axis_name

    def pull_off(self, axis: AxisConfig) -> float:
        """From a switch to the usable travel, in the unit of the axis; nothing without switches."""
        return self.homing.pull_off_mm if axis.has_switches else 0.0

    @property
    def home_order(self) -> tuple[str, ...]:
        """Axes of a reference run that is not told which, in order."""
        return self.homing.order or self.axes.home_order
