"""What a row of the key table is, and in which areas there are rows."""

from dataclasses import dataclass
from enum import Enum


class Area(Enum):
    """Where a key works: a column of the table."""

    EVERYWHERE = "everywhere"
    VIEWS = "every view"
    MACHINE = "Move"
    CALIBRATE = "Calibrate"
    BENCH = "Bench"
    RUNNING = "Move and Program"
    PROGRAM = "Program"
    START = "start a program"
    START_THERE = "start in the middle"
    LOG = "Log"
    GO_TO = "go to"
    TYPED = "type a line"
    SET = "set the position"
    OFFSETS = "work offsets"
    PROBE = "probe"
    REFERENCE = "reference"
    OPEN = "open a program"
    RESUME = "go on with a program"
    CRASH = "after a crash"
    ASK = "the job asks"
    CONFIRM = "confirm"
    SWITCHES = "switch test"
    FORM = "a question"
    CONSENT = "write the configuration"
    HELP = "help"


@dataclass(frozen=True, slots=True)
class Row:
    """One row of the table.

    Attributes:
        area: where it works.
        keys: as Textual names them, comma-separated; empty: what has the focus deals with it.
        shown: the key for people.
        action: of the screen, or with ``app.`` of the app.
        title: in the palette and in the list of commands.
        help: a sentence for the help screen.
        group: heading in the help screen; empty: it is no command.
        footer: word for the footer; empty: not there.
        hint: words in a dialog's line of keys; empty: not there.
        priority: comes before whatever has the focus.
    """

    area: Area
    keys: str
    shown: str
    action: str
    title: str = ""
    help: str = ""
    group: str = ""
    footer: str = ""
    hint: str = ""
    priority: bool = False

    @property
    def each(self) -> tuple[str, ...]:
        """Its keys, one by one."""
        return tuple(filter(None, self.keys.split(",")))

    @property
    def said(self) -> str:
        """The key as a sentence names it: "Esc", "o", "Ctrl+Q"."""
        return f"Ctrl+{self.shown[1:].upper()}" if self.shown.startswith("^") else self.shown
