"""What a row of the key table is, and in which areas there are rows."""

import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

from fraese.ui.keyrows.naming import shown


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
    JOG_RATE = "jog rate"
    TYPED = "type a line"
    SET = "set the position"
    OFFSETS = "work offsets"
    TOOLS = "tools"
    PROBE = "probe"
    REFERENCE = "reference"
    OPEN = "open a program"
    MAP = "height map"
    RESUME = "go on with a program"
    CRASH = "after a crash"
    ASK = "the job asks"
    CONFIRM = "confirm"
    SWITCHES = "switch test"
    FORM = "a question"
    CONSENT = "write the configuration"
    SETTINGS = "Settings"
    SETTING = "a key of the configuration"
    HELD_KEY = "measure a held key"
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
        given_name: what the configuration calls it, where that is not made of its title.
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
    given_name: str = ""

    @property
    def name(self) -> str:
        """What the configuration calls it: its title, behind the view where only that has it."""
        if self.given_name:
            return self.given_name
        words = self.title.replace("+", " plus").replace("−", " minus").lower()
        where = f"{self.area.value} " if self.area in _OWN_VIEWS else ""
        return "_".join(re.findall("[a-z0-9]+", where.lower() + words))

    @property
    def each(self) -> tuple[str, ...]:
        """Its keys, one by one."""
        return tuple(filter(None, self.keys.split(",")))

    @property
    def said(self) -> str:
        """The key as a sentence names it: "Esc", "o", "Ctrl+Q"."""
        return f"Ctrl+{self.shown[1:].upper()}" if self.shown.startswith("^") else self.shown

    @property
    def all_shown(self) -> str:
        """All its keys for people: "F1 ?"."""
        others = (shown(key) for key in self.each)
        return " ".join(dict.fromkeys([self.shown, *others]))


_OWN_VIEWS: Final = (Area.PROGRAM, Area.CALIBRATE, Area.BENCH, Area.LOG, Area.SETTINGS)
