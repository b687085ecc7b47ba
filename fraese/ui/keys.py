"""The keys: one table that feeds bindings, footer, help, command list and palette.

Rule 1: a command is one row. Nothing else in the UI names a key.
Rule 2: the stop keys are the only ones with priority: they work while an input has the focus and
        while a dialog is open. Escape is the one to remember. Ctrl+C does the same and is a single
        byte, so that no terminal has to wait to see whether more follows.
Rule 3: keys that a plain terminal over SSH does not transmit are not used.
"""

from dataclasses import dataclass
from typing import Final

#: From this press on the half-step jog goes ten-fold.
REPEAT_FROM: Final = 21
REPEAT_FACTOR: Final = 10


class RepeatRule:
    """The original's repeat rule (TASTATUR.PAS, Eingabe).

    Presses 1 to 20 of the same key count single, from the 21st on ten-fold; only another key
    resets it, a pause does not.
    """

    def __init__(self) -> None:
        self._key = ""
        self._count = 0

    def press(self, key: str) -> None:
        """A key was pressed, any key."""
        if key == self._key:
            self._count += 1
        else:
            self._key, self._count = key, 1

    @property
    def factor(self) -> int:
        """What the press last seen counts."""
        return REPEAT_FACTOR if self._count >= REPEAT_FROM else 1


@dataclass(frozen=True, slots=True)
class Width:
    """A jog width.

    Attributes:
        mm: per press; None: one half-step, with the repeat rule.
        label: for the display.
    """

    mm: float | None
    label: str


WIDTHS: Final = (
    Width(None, "1 half-step"),
    Width(0.01, "0.01 mm"),
    Width(0.1, "0.1 mm"),
    Width(1.0, "1 mm"),
    Width(10.0, "10 mm"),
)
#: What the app starts with: 1 mm.
FIRST_WIDTH: Final = 3


@dataclass(frozen=True, slots=True)
class Command:
    """One row of the table.

    Attributes:
        keys: as Textual names them, comma-separated; the first is the one shown.
        shown: the key for people.
        action: of the app.
        title: in the palette and in the list of commands.
        help: a sentence for the help screen.
        group: heading in the help screen.
        footer: word for the footer; empty: not there.
        priority: works everywhere, even while typing.
    """

    keys: str
    shown: str
    action: str
    title: str
    help: str
    group: str
    footer: str = ""
    priority: bool = False


def _jog(keys: str, shown: str, axis: str, sign: int) -> Command:
    direction = "positive" if sign > 0 else "negative"
    return Command(
        keys,
        shown,
        f"jog('{axis}', {sign})",
        f"Jog {axis.upper()}{'+' if sign > 0 else '−'}",
        f"Move {axis.upper()} by one step width in {direction} direction.",
        "Jog",
    )


def _set_width(number: int, width: Width) -> Command:
    rule = "" if width.mm else f"; from press {REPEAT_FROM} of the same key on {REPEAT_FACTOR}"
    return Command(
        str(number),
        str(number),
        f"set_width({number - 1})",
        f"Step {width.label}",
        f"Step width {width.label}{rule}.",
        "Jog",
    )


def _zero(axis: str) -> Command:
    name = axis.upper()
    return Command(
        name, name, f"zero('{axis}')", f"Zero {name}", f"Let the work zero of {name} be here.",
        "Position",
    )  # fmt: skip


#: In the order in which the list of commands shows them, column by column.
LISTED: Final = (
    Command(
        "escape,ctrl+c", "Esc", "stop_machine", "Stop",
        "Brake with ramp and drop the rest of the job; pressed again while it still moves: stop"
        " without ramp. Works everywhere, also while typing; at standstill it closes dialogs."
        " Ctrl+C does the same.",
        "Stop", "Stop", True,
    ),
    Command(
        "space", "Space", "hold", "Hold, go on",
        "Brake with ramp and wait; once more: go on where it stands.", "Stop", "Hold",
    ),
    Command(
        "enter", "Enter", "acknowledge", "Acknowledge",
        "Take note of an error; before that nothing moves.", "Stop",
    ),
    _jog("pageup", "PgUp", "z", 1),
    _jog("pagedown", "PgDn", "z", -1),
    Command(
        "q", "q", "leave", "Quit",
        "Leave, motors off. While the machine runs, stop it first.", "Machine", "Quit",
    ),
    _jog("left", "←", "x", -1),
    _jog("right", "→", "x", 1),
    _jog("down", "↓", "y", -1),
    _jog("up", "↑", "y", 1),
    Command(
        "g", "g", "go_to", "Go to …",
        "Go straight to a position, in work or machine coordinates, or by a distance.",
        "Position", "Go",
    ),
    Command(
        "r", "r", "reference", "Reference …",
        "Run to the end switches: all axes or chosen ones; measure the travel if wanted.",
        "Position", "Ref",
    ),
    *(_zero(axis) for axis in "xyz"),
    Command(
        "A", "A", "zero('')", "Zero all", "Let the work zero of all axes be here.", "Position",
    ),
    Command(
        "o", "o", "open", "Open program …", "Choose a program file; it is read and checked.",
        "Program", "Open",
    ),
    Command(
        "s", "s", "start", "Start program", "Run the program from its first line.",
        "Program", "Start",
    ),
    Command(
        "v", "v", "picture", "Next picture",
        "Data with commands, data with large positions, path with position.", "Display", "View",
    ),
    Command("t", "t", "theme", "Dark or light", "Change between dark and light.", "Display"),
    Command(
        "e", "e", "switch_test", "Switch test …",
        "Press each end switch by hand and see it arrive.", "Machine",
    ),
    Command(
        "i", "i", "ignore", "Ignore switches",
        "Let contacts stop the motors, or not: only for trying things out.", "Machine",
    ),
    Command(
        "l", "l", "log", "Log on or off",
        "Write what happens to the log file, or stop writing.", "Machine",
    ),
    Command("question_mark,f1", "?", "help", "Help", "This page; also F1.", "Machine", "Help"),
)  # fmt: skip

#: The widths have a line of their own, the path is in another picture.
UNLISTED: Final = (
    Command(
        "comma,less_than_sign", ",", "override(-10)", "Slower feed",
        "Feed override 10 % lower, down to 10 %; acts at once. Rapids keep their speed.", "Program",
    ),
    Command(
        "full_stop,greater_than_sign", ".", "override(10)", "Faster feed",
        "Feed override 10 % higher, up to 200 %; acts on what is not in the queue yet.", "Program",
    ),
    Command(
        "equals_sign", "=", "override(0)", "Feed as programmed", "Feed override 100 %.", "Program",
    ),
    Command(
        "w,plus", "w", "width(1)", "Wider step",
        "The next larger step width, after the largest the smallest; also +.", "Jog",
    ),
    Command(
        "W,minus", "W", "width(-1)", "Narrower step",
        "The next smaller step width; also -.", "Jog",
    ),
    *(_set_width(number, width) for number, width in enumerate(WIDTHS, start=1)),
    Command("ctrl+up", "^↑", "scroll_path(-1)", "Path up", "Scroll the program up.", "Program"),
    Command(
        "ctrl+down", "^↓", "scroll_path(1)", "Path down", "Scroll the program down.", "Program",
    ),
    Command(
        "ctrl+q", "^q", "quit", "Quit at once", "Brake, motors off, leave.", "Machine",
        priority=True,
    ),
)  # fmt: skip

COMMANDS: Final = LISTED + UNLISTED
GROUPS: Final = ("Stop", "Jog", "Position", "Program", "Display", "Machine")

STOP_KEYS: Final = frozenset(
    key
    for command in COMMANDS
    if command.action == "stop_machine"
    for key in command.keys.split(",")
)
