"""In which of grbl's states the machine is, for its sender.

Rule 1: one thread changes a field, whoever it is; every look is of plain values.
"""

from dataclasses import dataclass
from enum import Enum

from fraese.control.state import MachineState, Status


class Doing(Enum):
    """What of the sender's is being carried out."""

    NOTHING = ""
    PROGRAM = "program"
    JOG = "jog"
    HOMING = "homing"


@dataclass
class Modes:
    """What the sender has brought about.

    Attributes:
        doing: which job of his runs.
        resting: it waits for lines, and all of those that came have been made.
        alarm: number of the alarm that locks the machine; 0: none does.
        critical: only a reset is listened to.
        held: hold was said; nothing that waits is begun.
        door: it was said as an open door.
        check: lines are looked at, and not carried out.
        out: somebody at the machine has taken over.
    """

    doing: Doing = Doing.NOTHING
    resting: bool = False
    alarm: int = 0
    critical: bool = False
    held: bool = False
    door: bool = False
    check: bool = False
    out: bool = False

    def word(self, state: MachineState, *, holding: bool) -> str:
        """What a status report begins with.

        Args:
            state: of the machine.
            holding: the job in hand was told to wait.
        """
        if self.alarm or self.out or state.status is Status.ERROR:
            return "Alarm"
        runs = state.status is Status.RUN
        if (holding or state.question) if runs else self.held:
            stands = not runs or state.held or bool(state.question)
            return self._held_word(stands=stands)
        if not runs:
            return "Check" if self.check else "Idle"
        if self.doing is Doing.PROGRAM or self.doing is Doing.JOG:
            moving = "Run" if self.doing is Doing.PROGRAM else "Jog"
            return "Idle" if self.resting else moving
        return "Home" if self.doing is Doing.HOMING else "Run"

    def _held_word(self, *, stands: bool) -> str:
        if self.door:
            return "Door:0" if stands else "Door:2"
        return "Hold:0" if stands else "Hold:1"

    def let_go(self) -> None:
        """As after a reset; an alarm stays."""
        self.held = self.door = self.check = self.critical = False
        self.doing, self.resting = Doing.NOTHING, False
