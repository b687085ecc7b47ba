"""Every alarm there is: its number, what happened, what the position is worth, what to do now.

    1x  end switches      2x  reference runs      3x  probes           4x  the program itself
    5x  ports             6x  the step process    7x  the bridge         8x  the journal

Rule 1: a number belongs to one alarm for ever; what is no longer raised leaves a gap.
Rule 2: the sentence that is shown is made where the alarm arises and knows the place; what is the
        same every time stands here, once.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Final

from fraese.phrases import joined, phrase


class Trust(Enum):
    """What the position is worth after an alarm; the words are for people."""

    KEPT = phrase("The position can be relied on.")
    RAMPED = phrase(
        "An axis that was stopped at speed without ramp is not referenced any more; the"
        " others can be relied on."
    )
    AXIS = phrase("The axis is not referenced; the others can be relied on.")
    LOST = phrase("No axis is referenced any more.")
    UNMOVED = phrase("Nothing has moved.")


@dataclass(frozen=True, slots=True)
class AlarmKind:
    """One kind of alarm.

    Attributes:
        number: for ever.
        name: for programs, as in ``--json``.
        what: what happened, a sentence.
        trust: what the position is worth.
        remedy: what to do now, in the imperative.
    """

    number: int
    name: str
    what: str
    trust: Trust
    remedy: str

    def advice(self) -> str:
        """What the position is worth, and what to do now."""
        return joined(" ", (self.trust.value, self.remedy))


END_SWITCH: Final = AlarmKind(
    10,
    "end_switch",
    phrase("An end switch closed where none was expected."),
    Trust.RAMPED,
    phrase(
        "Jog away from the switch or reference the machine; see why the end was reached: a"
        " wrong zero, lost steps, or a loose wire."
    ),
)
END_NOT_FOUND: Final = AlarmKind(
    20,
    "end_not_found",
    phrase("A reference run went as far as it may and met no end switch."),
    Trust.AXIS,
    phrase(
        "Press the switch by hand and watch it (fraese switches); compare the axis'"
        " travel_mm with the machine."
    ),
)
END_NOT_AGAIN: Final = AlarmKind(
    21,
    "end_not_again",
    phrase("An end switch closed once and not again."),
    Trust.AXIS,
    phrase("Look for a loose switch or wire, then reference again."),
)
END_STUCK: Final = AlarmKind(
    22,
    "end_stuck",
    phrase("An end switch does not open when the axis backs off."),
    Trust.AXIS,
    phrase(
        "Look for a switch that sticks or a wire that is cut, or make homing.back_off_max_mm"
        " longer."
    ),
)
END_AT_PULL_OFF: Final = AlarmKind(
    23,
    "end_at_pull_off",
    phrase("An end switch is still closed where the reference run ends."),
    Trust.AXIS,
    phrase("Make homing.pull_off_mm longer."),
)
END_UNKNOWN: Final = AlarmKind(
    24,
    "end_unknown",
    phrase(
        "A switch is closed at the start, and backing off opens it at none of the ends it may be."
    ),
    Trust.AXIS,
    phrase(
        "Look which switch is closed, or whether its wire is cut; move the axis away by hand"
        " with the motors off."
    ),
)
PROBE_TOUCHES: Final = AlarmKind(
    30,
    "probe_already",
    phrase("A probing move found the probe already as it should be found at its end."),
    Trust.KEPT,
    phrase("Look at the probe and its wire; lift it off the work before the move."),
)
PROBE_NEVER: Final = AlarmKind(
    31,
    "probe_never",
    phrase("A probing move came to its end without contact."),
    Trust.KEPT,
    phrase("Begin nearer to the work, or let the move go further; try the probe by hand."),
)
SILENCE: Final = AlarmKind(
    40,
    "silence",
    phrase(
        "The program did not look after the motors for too long: they braked and were switched off."
    ),
    Trust.KEPT,
    phrase(
        "See what held the program up (a debugger, a stopped process, a busy computer);"
        " motors without current may have been moved: look, or reference."
    ),
)
STRAY_STOP: Final = AlarmKind(
    41,
    "stray_stop",
    phrase("The motors stopped, and this program had not asked for it."),
    Trust.RAMPED,
    phrase("Look at the line and at who else uses it."),
)
NO_PROGRESS: Final = AlarmKind(
    42,
    "no_progress",
    phrase("The motors were to move and did not get on for 3 s."),
    Trust.LOST,
    phrase(
        "Look at the line to the machine and at its supply; then reference. If it comes"
        " again without a fault there, it is one of this program: keep the log."
    ),
)
PORT: Final = AlarmKind(
    50,
    "port",
    phrase("The port cannot be opened, or another program has it."),
    Trust.UNMOVED,
    phrase("See the sentence; fraese doctor looks at the port and says what is missing."),
)
PORT_LOST: Final = AlarmKind(
    51,
    "port_lost",
    phrase("The port does not answer any more."),
    Trust.LOST,
    phrase("Switch the motors' supply off, look at plug and card, then reference."),
)
STEP_PROCESS_START: Final = AlarmKind(
    60,
    "step_process_start",
    phrase("The step process did not start."),
    Trust.UNMOVED,
    phrase("See the sentence; fraese doctor tries the step process."),
)
STEP_PROCESS_DIED: Final = AlarmKind(
    61,
    "step_process_died",
    phrase("The step process died or was killed."),
    Trust.LOST,
    phrase(
        "Reference the machine; where it says that the motors could not be switched off, cut"
        " their power first."
    ),
)
BRIDGE_MISSING: Final = AlarmKind(
    70,
    "bridge_missing",
    phrase("No bridge answers."),
    Trust.UNMOVED,
    phrase(
        "Plug the board in and name its port in port.device (fraese ports lists them); if it"
        " is the right one, flash its firmware (fraese bridge flash)."
    ),
)
BRIDGE_UNFIT: Final = AlarmKind(
    71,
    "bridge_unfit",
    phrase("The board's firmware is another one, or cannot play this card."),
    Trust.UNMOVED,
    phrase("Flash the firmware that belongs to this program (fraese bridge flash)."),
)
BRIDGE_LOST: Final = AlarmKind(
    72,
    "bridge_lost",
    phrase("The bridge does not answer any more, was reset, or its plug was pulled."),
    Trust.LOST,
    phrase(
        "Look at plug and supply; the bridge brakes and switches off by itself. Then reference."
    ),
)
BRIDGE_STUCK: Final = AlarmKind(
    73,
    "bridge_stuck",
    phrase("The bridge answers, but does not do what it is told."),
    Trust.LOST,
    phrase(
        "Unplug the board and plug it in again, then reference; if it comes again, flash it anew."
    ),
)
NOT_KEPT: Final = AlarmKind(
    80,
    "not_kept",
    phrase("Where the machine is could not be put down while it moved: it was braked."),
    Trust.KEPT,
    phrase(
        "See what the disk says; until that is mended, a restart may not know where the machine is."
    ),
)
MACHINE_BUSY: Final = AlarmKind(
    81,
    "machine_busy",
    phrase("Another program drives the machine."),
    Trust.UNMOVED,
    phrase("End that program first; fraese where works meanwhile."),
)

ALARMS: Final[tuple[AlarmKind, ...]] = (
    END_SWITCH,
    END_NOT_FOUND,
    END_NOT_AGAIN,
    END_STUCK,
    END_AT_PULL_OFF,
    END_UNKNOWN,
    PROBE_TOUCHES,
    PROBE_NEVER,
    SILENCE,
    STRAY_STOP,
    NO_PROGRESS,
    PORT,
    PORT_LOST,
    STEP_PROCESS_START,
    STEP_PROCESS_DIED,
    BRIDGE_MISSING,
    BRIDGE_UNFIT,
    BRIDGE_LOST,
    BRIDGE_STUCK,
    NOT_KEPT,
    MACHINE_BUSY,
)
BY_NUMBER: Final = {kind.number: kind for kind in ALARMS}
