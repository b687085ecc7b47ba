"""What a program finds when it starts: plain facts that can be sent to another process."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fraese.config import Config
from fraese.control.controller import Controller
from fraese.gcode.setup import Setup, ToolData
from fraese.machine import Machine, Steps
from fraese.planner.planner import Options
from fraese.workframe import TOOL_NUMBER


@dataclass(frozen=True, slots=True)
class ProgramContext:
    """The machine as a program finds it.

    Attributes:
        config: feeds, tools, options.
        machine: axes and conversions.
        start_steps: machine position.
        slack_steps: backlash between motor and carriage.
        referenced: per axis; only then the soft limits count.
        parameters: persistent parameters of the language.
    """

    config: Config
    machine: Machine
    start_steps: Steps
    slack_steps: Steps
    referenced: tuple[bool, ...]
    parameters: Mapping[int, float]

    @classmethod
    def of(cls, controller: Controller) -> "ProgramContext":
        """The machine as a program finds it now."""
        position = controller.position
        return cls(
            config=controller.config,
            machine=controller.machine,
            start_steps=position.position_steps,
            slack_steps=position.slack_steps,
            referenced=position.referenced,
            parameters=position.offsets.parameters,
        )

    @property
    def rate_factor(self) -> float:
        """Part of the axes' rates that a job may use: less on an unreferenced machine."""
        if all(self.referenced):
            return 1.0
        return self.config.run.unreferenced_percent / 100

    def options(self) -> Options:
        """Planner options as configured."""
        return Options.from_config(self.config.planner, self.rate_factor)

    def setup(self, path: Path) -> Setup:
        """What the interpreter is told."""
        x_mm, y_mm, z_mm = self.machine.to_mm(self.start_steps)
        tools = {
            int(number): ToolData(tool.length_mm, tool.diameter_mm)
            for number, tool in self.config.tools.items()
        }
        return Setup(
            position_mm=(x_mm, y_mm, z_mm),
            parameters=dict(self.parameters),
            tools=tools or None,
            tool=int(self.parameters.get(TOOL_NUMBER, 0.0)),
            block_delete=self.config.run.block_delete,
            file=str(path),
            folders=(path.parent,),
        )

    def retract_mm(self) -> float:
        """How far the tool is lifted while the program is held."""
        return self.config.run.retract_mm

    def safe_z_mm(self) -> float:
        """Height for moves above the work, machine coordinates."""
        configured = self.config.run.safe_z_mm
        return self.machine.axes[2].high_mm if configured is None else configured
