"""What survives a restart: position, reference, work zero, phase index.

Rule 1: written to a new file that replaces the old one in one step; never half a state.
Rule 2: while the machine may move the file says so. If it still says so at the next start, the
        program ended in the middle of something: the position is shown, the reference is not
        believed.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError, field_validator

from fraese.control.position import Position
from fraese.errors import ConfigError
from fraese.machine import Steps
from fraese.workframe import ACTIVE_SYSTEM, SYSTEMS

STATE_FILE: Final = "state.json"


class SavedState(BaseModel):
    """One state of one machine.

    Attributes:
        position_steps: machine position per axis.
        slack_steps: backlash between motor and carriage, per axis.
        parameters: persistent parameters of the language, work offsets among them.
        referenced: per axis.
        phases: phase index per motor.
        ends: which ends the contact may be; none: there was no contact.
        simulation: what the simulated mill needs to be found as it was left.
        axes: what gives the steps of each axis their meaning; configured otherwise, they have none.
        moving: written before motion, cleared after it.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    position_steps: tuple[int, ...]
    slack_steps: tuple[int, ...]
    parameters: dict[int, float]
    referenced: tuple[bool, ...]
    phases: tuple[int, ...]
    ends: tuple[str, ...] = ()
    simulation: tuple[tuple[float, float, float, float], ...] = ()
    axes: tuple[str, ...] = ()
    moving: bool = False

    @classmethod
    def of(cls, where: Position, phases: Steps, ends: Sequence[str]) -> "SavedState":
        """What is to be kept of a machine at standstill."""
        return cls(
            position_steps=where.position_steps,
            slack_steps=where.slack_steps,
            parameters=where.offsets.parameters,
            referenced=where.referenced,
            phases=phases,
            ends=tuple(ends),
        )

    def give_back(self, where: Position) -> None:
        """Let the axes stand where they were left."""
        where.take_up(self.position_steps, self.slack_steps, self.referenced, self.parameters)

    @field_validator("parameters")
    @classmethod
    def _a_system(cls, value: dict[int, float]) -> dict[int, float]:
        if value.get(ACTIVE_SYSTEM, 1) not in range(1, len(SYSTEMS) + 1):
            raise ValueError("no such work offset")
        return value


class StateFile:
    """The state file.

    Args:
        folder: made when first written.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / STATE_FILE

    def load(self, axes: int) -> SavedState | None:
        """What was kept for a machine of so many axes; None if nothing.

        Raises:
            ConfigError: if the file cannot be read or does not make sense.
        """
        try:
            text = self.path.read_text("utf-8")
        except FileNotFoundError:
            return None
        except (OSError, UnicodeDecodeError) as error:
            raise ConfigError(f"{self.path}: cannot be read; start with --fresh.") from error
        try:
            kept = SavedState.model_validate_json(text)
        except ValidationError as error:
            raise ConfigError(
                f"{self.path}: is damaged; start with --fresh and reference the machine."
            ) from error
        per_axis: list[tuple[object, ...]] = [
            kept.position_steps,
            kept.slack_steps,
            kept.referenced,
            kept.phases,
            kept.simulation or (None,) * axes,
        ]
        if any(len(values) != axes for values in per_axis):
            raise ConfigError(
                f"{self.path}: belongs to a machine with another number of axes; start with"
                " --fresh."
            )
        if kept.moving:
            # Nor what was known of a contact before it moved.
            return kept.model_copy(update={"referenced": (False,) * axes, "ends": ()})
        return kept

    def save(self, kept: SavedState) -> None:
        """Replace what was kept.

        Raises:
            ConfigError: if the folder cannot be written.
        """
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            fresh = self.path.with_suffix(f".{os.getpid()}.new")
            fresh.write_text(json.dumps(kept.model_dump(), indent=1) + "\n", "utf-8")
            fresh.replace(self.path)
        except OSError as error:
            raise ConfigError(
                f"{self.path}: the state cannot be written: {error.strerror}."
            ) from error
