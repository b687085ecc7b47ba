"""What a program finds when it starts: plain facts that can be sent to another process."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

from fraese.config import Config
from fraese.control.controller import Controller
from fraese.errors import ProgramError
from fraese.gcode.setup import Setup
from fraese.heightmap.bend import Site
from fraese.heightmap.heights import HeightMap
from fraese.machine import Machine, Millimetres, Steps
from fraese.phrases import phrase
from fraese.planner.planner import Options
from fraese.program.taken import Taken
from fraese.program.userwords import user_word
from fraese.tooldata import ToolData
from fraese.workframe import TOOL_NUMBER


class Height(NamedTuple):
    """A place of the axis that lifts the tool: its number, and where."""

    axis: int
    mm: float

    def at(self, point: Millimetres) -> Millimetres:
        """A point at this height."""
        return tuple(self.mm if axis == self.axis else mm for axis, mm in enumerate(point))

    def at_least(self, mm: float) -> "Height":
        """The same, or higher."""
        return Height(self.axis, max(self.mm, mm))


def tool_table(config: Config) -> dict[int, ToolData]:
    """The tools of the configuration, by number."""
    return {
        int(number): ToolData(tool.length_mm, tool.diameter_mm)
        for number, tool in config.tools.items()
    }


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
        block_delete: lines that begin with a slash are left out.
        left: what is kept of a program that was cut short.
        heights: of the work, to which moves are bent; None: they are not.
    """

    config: Config
    machine: Machine
    start_steps: Steps
    slack_steps: Steps
    referenced: tuple[bool, ...]
    parameters: Mapping[int, float]
    block_delete: bool = False
    left: Mapping[str, Any] | None = field(default=None, compare=False)
    heights: HeightMap | None = None

    @classmethod
    def of(cls, controller: Controller, heights: HeightMap | None = None) -> "ProgramContext":
        """The machine as a program finds it now."""
        position = controller.position
        return cls(
            config=controller.config,
            machine=controller.machine,
            start_steps=position.position_steps,
            slack_steps=position.slack_steps,
            referenced=position.referenced,
            parameters=position.offsets.parameters,
            block_delete=controller.handling.block_delete,
            left=controller.cut_short(),
            heights=heights,
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

    def setup(self, taken: Taken) -> Setup:
        """What the interpreter is told."""
        axes = self.machine.axes
        return Setup(
            axes="".join(axis.name for axis in axes),
            rotary="".join(axis.name for axis in axes if axis.kind == "rotary"),
            position_mm=self.start_mm,
            parameters=dict(self.parameters),
            tools=tool_table(self.config) or None,
            tool=int(self.parameters.get(TOOL_NUMBER, 0.0)),
            block_delete=self.block_delete,
            unreferenced="".join(
                axis.name for axis, known in zip(axes, self.referenced, strict=True) if not known
            ),
            file=taken.main.file,
            folders=(taken.path.parent, *self.config.run.folders),
            ignored_m_codes=frozenset(self.config.run.ignored_m_codes),
            user_word=partial(user_word, self.config),
            file_lines=taken.lines,
        )

    def site(self) -> Site:
        """Where a height map is used.

        Raises:
            ProgramError: on a machine without the axes for it.
        """
        axes, vertical = self.machine.axes, self.machine.vertical
        names = "".join(self.machine.names)
        if vertical is None or not {"x", "y"} <= set(names):
            raise ProgramError(phrase("a height map is of X, Y and Z, and the machine lacks one"))
        known = self.referenced[vertical] and not axes[vertical].is_endless
        return Site(
            axes=names,
            parameters=self.parameters,
            start_mm=self.start_mm,
            chord_mm=self.options().chord_tolerance_mm,
            top_mm=axes[vertical].high_mm if known else math.inf,
        )

    @property
    def has_laser(self) -> bool:
        """M3 switches a beam, not a spindle."""
        return bool(self.config.outputs.mask("laser"))

    def retract_mm(self) -> float:
        """How far the tool is lifted while the program is held."""
        return self.config.run.retract_mm

    @property
    def start_mm(self) -> Millimetres:
        """The same in millimetres and degrees."""
        return self.machine.to_mm(self.start_steps)

    def safe_height(self) -> Height | None:
        """Height for moves above the work, machine coordinates: the top of the travel.

        Where nobody knows the top, where it stands. None: nothing lifts the tool.
        """
        vertical = self.machine.vertical
        if vertical is None:
            return None
        configured = self.config.run.safe_z_mm
        if configured is not None:
            return Height(vertical, configured)
        axis = self.machine.axes[vertical]
        known = self.referenced[vertical] and not axis.is_endless
        return Height(vertical, axis.high_mm if known else self.start_mm[vertical])
