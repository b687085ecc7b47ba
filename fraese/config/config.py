"""The whole configuration, and what must fit together in it."""

import re
from fractions import Fraction

from pydantic import Field, field_validator, model_validator

from fraese.config.axes import AXIS_NAMES, AxesConfig
from fraese.config.section import Section
from fraese.config.simulation import SimulationConfig
from fraese.config.wiring import (
    CardConfig,
    OutputsConfig,
    PortConfig,
    ProbeConfig,
    RealtimeConfig,
    StandstillConfig,
    SwitchesConfig,
)
from fraese.config.work import (
    HomingConfig,
    JogConfig,
    LogConfig,
    PlannerConfig,
    RunConfig,
    ToolConfig,
)

_TOOL = re.compile(r"[0-9]{1,9}")
#: Travel of an axis; the upper bound is what counters of 32 bits hold with room to spare.
_FEWEST_STEPS = 10
_MOST_STEPS = 1_000_000_000


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
