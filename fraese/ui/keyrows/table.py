"""All rows for one machine."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby
from types import MappingProxyType
from typing import Final

from fraese.phrases import shown, spoken
from fraese.ui.keyrows import byhand, frame
from fraese.ui.keyrows.axes import choose, jog_rows, set_width, zero_rows
from fraese.ui.keyrows.bench import BENCH
from fraese.ui.keyrows.calibrate import CALIBRATE, CALIBRATE_DIALOGS
from fraese.ui.keyrows.changes import Changes, changing, check_each_means_one_thing
from fraese.ui.keyrows.dialogs import AFTER_AXES, BEFORE_AXES
from fraese.ui.keyrows.everywhere import PALETTE, QUIT_AT_ONCE, STOP
from fraese.ui.keyrows.machine import (
    AFTERWARDS,
    GOING,
    HOLDING,
    OVERRIDES,
    QUIT,
    REST,
    SCROLLING,
)
from fraese.ui.keyrows.macros import macro_rows
from fraese.ui.keyrows.program import PROGRAM
from fraese.ui.keyrows.row import Area, Row
from fraese.ui.keyrows.settings import SETTINGS, SETTINGS_DIALOGS
from fraese.ui.macros import Macro
from fraese.ui.shape import Shape
from fraese.ui.widths import REPEAT_FROM, widths

GROUPS: Final = (
    "Stop",
    "Views",
    "Jog",
    "Position",
    "Macros",
    "Program",
    "Calibrate",
    "Bench",
    "Settings",
    "Display",
    "Log",
    "Machine",
)
#: What has the same keys on every machine.
_FIXED: Final = (
    STOP, *HOLDING, QUIT, *GOING, *REST, *AFTERWARDS, *OVERRIDES, *SCROLLING, *PROGRAM,
    QUIT_AT_ONCE,
)  # fmt: skip
_TAKEN: Final = frozenset(key for row in _FIXED for key in row.each)


class KeyTable:
    """All rows for one machine.

    Args:
        shape: its axes and steps.
        views: names of those that there are.
        changes: keys that somebody has changed, by the names of their actions.
        macros: which have a row each.

    Raises:
        ConfigError: if they cannot be changed so.

    Attributes:
        views: the rows of the views, by name.
        listed: commands in the order in which the list of commands shows them, column by column.
        commands: these and those that are only in the help and the palette.
        rows: these and the keys of dialogs and pages.
    """

    def __init__(
        self,
        shape: Shape,
        views: Iterable[str] = tuple(frame.VIEW_ROWS),
        changes: Changes = MappingProxyType({}),
        macros: Sequence[Macro] = (),
    ) -> None:
        self.views = {name: frame.VIEW_ROWS[name] for name in views if name in frame.VIEW_ROWS}
        self.listed: tuple[Row, ...] = (
            STOP,
            *HOLDING,
            *jog_rows(shape.axes, upright=True),
            QUIT,
            *jog_rows(shape.axes, upright=False),
            *GOING,
            *zero_rows(shape.axes, _TAKEN),
            *REST,
        )
        # The widths have a line of their own, the path is in another picture.
        steps = (set_width(number, width) for number, width in enumerate(widths(shape), start=1))
        self.commands: tuple[Row, ...] = (
            *self.listed,
            *self.views.values(),
            *frame.AROUND,
            *byhand.BY_HAND,
            *macro_rows(macros),
            *AFTERWARDS,
            *OVERRIDES,
            *steps,
            *SCROLLING,
            *PROGRAM,
            QUIT_AT_ONCE,
            *(CALIBRATE if "calibrate" in self.views else ()),
            *(BENCH if "bench" in self.views else ()),
            *frame.LOG,
            *(SETTINGS if "settings" in self.views else ()),
        )
        change = changing(self.commands, changes)
        self.views = {name: change(row) for name, row in self.views.items()}
        self.listed = tuple(map(change, self.listed))
        self.commands = tuple(map(change, self.commands))
        check_each_means_one_thing(self.commands, changes)
        boxes = (choose(axis) for axis in shape.axes)
        self.rows = (
            *self.commands, *byhand.DIALOGS, *BEFORE_AXES, *boxes, *AFTER_AXES, *CALIBRATE_DIALOGS,
            *SETTINGS_DIALOGS,
        )  # fmt: skip
        self.rows = tuple(map(_in_words, self.rows))
        self.commands = tuple(map(_in_words, self.commands))
        self.listed = tuple(map(_in_words, self.listed))
        self.views = {name: _in_words(row) for name, row in self.views.items()}
        self._step_word = shape.step_word

    @property
    def palette(self) -> str:
        """The key of the palette."""
        return PALETTE.said

    @property
    def changeable(self) -> tuple[Row, ...]:
        """Commands whose keys may be changed."""
        return tuple(row for row in self.commands if row.area is not Area.EVERYWHERE)

    def of(self, *areas: Area) -> Iterable[Row]:
        """The rows of these areas, in the order of the table."""
        return (row for row in self.rows if row.area in areas)

    def said(self, action: str) -> str:
        """The key of a command, as a sentence names it: "Esc", "o", "Ctrl+Q"."""
        return next(row.said for row in self.rows if row.action == action)

    def hint(self, area: Area, *, but: str | None = None) -> str:
        """A dialog's line of keys.

        Args:
            area: of the dialog.
            but: an action that is not there just now.
        """
        rows = [row for row in self.of(area) if row.hint and row.action != but]
        return "   ".join(
            f"{' '.join(row.shown for row in together)}: {words}"
            for words, together in groupby(rows, lambda row: row.hint)
        )

    def notes(self) -> tuple[str, ...]:
        """What the help screen says below the keys."""
        return (
            spoken(
                "At {step_word} width the original's repeat rule holds: presses 1 to"
                " {repeat_from} of the same key count single, from the {repeat_from_2}st on"
                " ten-fold; another key or a pause of a second resets it.",
                step_word=self._step_word,
                repeat_from=REPEAT_FROM - 1,
                repeat_from_2=REPEAT_FROM,
            ),
            spoken(
                "Presses add up while the machine moves. The opposite key brakes and then"
                " goes the other way; another axis waits its turn."
            ),
            spoken(
                "A jog key that is held runs until it is let go, at widths above one {step_word}."
                " Another key, another window and silence of the terminal end it as well.",
                step_word=self._step_word,
            ),
            spoken("Nothing here is an emergency stop: that is a switch which cuts the power."),
            spoken(
                "Escape takes 20 ms, since longer keys begin like it, and none in terminals with"
                " the keyboard protocol of kitty; inside tmux or screen more (tmux: set"
                " escape-time 0). Ctrl+C takes none."
            ),
        )


def _in_words(row: Row) -> Row:
    """A row as its reader wants it; the configuration calls it as ever."""
    return replace(
        row,
        given_name=row.name,
        title=shown(row.title),
        help=shown(row.help),
        group=shown(row.group),
        footer=shown(row.footer),
        hint=shown(row.hint),
    )
