"""The keys: one table that feeds bindings, footer, help, command list, palette and every hint.

Rule 1: a key is one row, with the area in which it works. Nothing else in the UI names a key; a
        sentence that wants to name one asks ``said``.
Rule 2: the keys that work everywhere have priority: also while an input has the focus and while a
        dialog is open. Escape is the one to remember. Ctrl+C does the same and is a single byte,
        so that no terminal has to wait to see whether more follows.
Rule 3: keys that a plain terminal over SSH does not transmit are not used.
Rule 4: axes are jogged by place. X, Y and Z have their own; any other axis takes the fourth place,
        and then those that X, Y and Z leave free.
Rule 5: an axis is zeroed by its capital letter. Where that is another command's (A, W), by ``0``,
        and a second such axis by ``9``.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

from fraese.ui.keyrows import byhand, frame
from fraese.ui.keyrows.bench import BENCH
from fraese.ui.keyrows.calibrate import CALIBRATE, CALIBRATE_DIALOGS
from fraese.ui.keyrows.dialogs import AFTER_AXES, BEFORE_AXES
from fraese.ui.keyrows.program import PROGRAM, RAPIDS, RUNNING
from fraese.ui.keyrows.row import Area as Area
from fraese.ui.keyrows.row import Row as Row
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widths import REPEAT_FACTOR, REPEAT_FROM, Width, widths


@dataclass(frozen=True, slots=True)
class _Place:
    """Two keys that lie opposite each other: (as Textual names it, for people).

    Attributes:
        minus: in negative direction,
        plus: in positive direction.
        upright: one key above the other, apart from the arrows.
    """

    minus: tuple[str, str]
    plus: tuple[str, str]
    upright: bool = False


_FOURTH: Final = ""
_PLACES: Final = {
    "x": _Place(("left", "←"), ("right", "→")),
    "y": _Place(("down", "↓"), ("up", "↑")),
    "z": _Place(("pagedown", "PgDn"), ("pageup", "PgUp"), upright=True),
    _FOURTH: _Place(("end", "End"), ("home", "Home"), upright=True),
}
#: In this order they are given to axes of other names.
_FREE_PLACES: Final = (_FOURTH, "z", "y", "x")
_OTHER_ZERO_KEYS: Final = ("0", "9")

_STOP: Final = (
    Row(
        Area.EVERYWHERE, "escape,ctrl+c", "Esc", "app.stop_machine", "Stop",
        "Brake with ramp and drop the rest of the job; pressed again while it still moves: stop"
        " without ramp. Works everywhere, also while typing; at standstill it closes dialogs."
        " Ctrl+C does the same.",
        "Stop", "Stop", priority=True,
    ),
    Row(
        Area.VIEWS, "space", "Space", "hold", "Hold, go on",
        "Brake with ramp and wait; once more: go on where it stands.", "Stop", "Hold",
    ),
    Row(
        Area.VIEWS, "enter", "Enter", "acknowledge", "Acknowledge",
        "Take note of an error; before that nothing moves.", "Stop",
    ),
)  # fmt: skip
_QUIT: Final = Row(
    Area.VIEWS, "q", "q", "leave", "Quit",
    "Leave, motors off. While the machine runs, stop it first.", "Machine", "Quit",
)  # fmt: skip
_GOING: Final = (
    Row(
        Area.MACHINE, "g", "g", "go_to", "Go to …",
        "Go straight to a position, in work or machine coordinates, or by a distance.",
        "Position", "Go",
    ),
    Row(
        Area.MACHINE, "r", "r", "reference", "Reference …",
        "Run to the end switches: all axes or chosen ones; measure the travel if wanted.",
        "Position", "Ref",
    ),
)  # fmt: skip
_REST: Final = (
    Row(
        Area.MACHINE, "A", "A", "zero('')", "Zero all",
        "Let the work zero of all axes be here.", "Position",
    ),
    *RUNNING,
    Row(
        Area.MACHINE, "v", "v", "picture", "Next picture",
        "Position with commands, or with the program; where there is room, both are there.",
        "Display", "View",
    ),
    Row(
        Area.VIEWS, "t", "t", "theme", "Next theme",
        "Dark, light, high contrast.", "Display",
    ),
    Row(
        Area.MACHINE, "e", "e", "switch_test", "Switch test …",
        "Press each end switch by hand and see it arrive.", "Machine",
    ),
    Row(
        Area.MACHINE, "i", "i", "ignore", "Ignore switches",
        "Let contacts stop the motors, or not: only for trying things out.", "Machine",
    ),
    Row(
        Area.VIEWS, "l", "l", "log", "Log on or off",
        "Write what happens to the log file, or stop writing.", "Machine",
    ),
    Row(
        Area.VIEWS, "question_mark,f1", "F1", "help", "Help",
        "This page; also ?.", "Machine", "Help",
    ),
)  # fmt: skip

_OVERRIDES: Final = (
    Row(
        Area.VIEWS, "comma", ",", "override(-10)", "Slower feed",
        "Feed override 10 % lower, down to 10 %; acts at once. Rapids have one of their own.",
        "Program",
    ),
    Row(
        Area.VIEWS, "full_stop", ".", "override(10)", "Faster feed",
        "Feed override 10 % higher, up to 200 %; acts within 0.3 s.", "Program",
    ),
    Row(
        Area.VIEWS, "equals_sign", "=", "override(0)", "As programmed",
        "Both overrides 100 %.", "Program",
    ),
    *RAPIDS,
    Row(
        Area.MACHINE, "w,plus", "w", "width(1)", "Wider step",
        "The next larger step width, after the largest the smallest; also +.", "Jog",
    ),
    Row(
        Area.MACHINE, "W,minus", "W", "width(-1)", "Narrower step",
        "The next smaller step width; also -.", "Jog",
    ),
)  # fmt: skip
_AFTERWARDS: Final = (
    Row(
        Area.MACHINE, "L", "L", "lift", "Lift the tool",
        "Raise the tool to its safe height; where nobody knows that, by 10 mm.", "Position",
    ),
    Row(
        Area.MACHINE, "ctrl+z", "^z", "undo_zero", "Undo zero",
        "Let the work zero be where it was before it was set last; the one before with the next"
        " press.", "Position",
    ),
    Row(
        Area.MACHINE, "u", "u", "resume", "Resume program …",
        "Go on with the program that was cut short by a stop, an alarm or a crash, or some moves"
        " earlier; what it will do is shown first.", "Program",
    ),
    Row(
        Area.MACHINE, "k", "k", "after_crash", "After a crash …",
        "What is known of the position; take it as it was left, or reference again.", "Position",
    ),
)  # fmt: skip
_SCROLLING: Final = (
    Row(
        Area.MACHINE, "ctrl+up", "^↑", "scroll_path(-1)", "Path up",
        "Scroll the program up.", "Program",
    ),
    Row(
        Area.MACHINE, "ctrl+down", "^↓", "scroll_path(1)", "Path down",
        "Scroll the program down.", "Program",
    ),
    *PROGRAM,
    Row(
        Area.EVERYWHERE, "ctrl+q", "^q", "app.quit", "Quit at once",
        "Brake, motors off, leave.", "Machine", priority=True,
    ),
)  # fmt: skip
#: Textual binds this one itself.
PALETTE: Final = Row(Area.EVERYWHERE, "ctrl+p", "^p", "app.command_palette")


_FIXED: Final = (*_STOP, _QUIT, *_GOING, *_REST, *_AFTERWARDS, *_OVERRIDES, *_SCROLLING)
GROUPS: Final = (
    "Stop",
    "Views",
    "Jog",
    "Position",
    "Program",
    "Calibrate",
    "Bench",
    "Display",
    "Log",
    "Machine",
)
STOP_KEYS: Final = frozenset(
    key for row in _FIXED if row.action == "app.stop_machine" for key in row.keys.split(",")
)
#: They quit wherever they are pressed.
QUIT_KEYS: Final = frozenset(
    key for row in _FIXED if row.action == "app.quit" for key in row.keys.split(",")
)
#: The stop key that is a single byte, and known also where it stands in the middle of something.
STOP_BYTE: Final = "\x03"
STOP_BYTE_KEY: Final = "ctrl+c"


def said(action: str) -> str:
    """The key of a command, as a sentence names it: "Esc", "o", "Ctrl+Q"."""
    shown = next(row.shown for row in (*_FIXED, PALETTE) if row.action == action)
    return f"Ctrl+{shown[1:].upper()}" if shown.startswith("^") else shown


# --- rows that depend on the machine -------------------------------------------------------------


def _jog_rows(axes: Sequence[AxisShape], *, upright: bool) -> list[Row]:
    """Two for each axis: by the place of its name, or a free one."""
    names = [axis.name for axis in axes]
    free = (place for place in _FREE_PLACES if place not in names)
    places = [_PLACES[name if name in _PLACES else next(free)] for name in names]
    return [
        _jog(place, axis, sign)
        for axis, place in zip(axes, places, strict=True)
        if place.upright is upright
        for sign in ((1, -1) if upright else (-1, 1))
    ]


def _jog(place: _Place, axis: AxisShape, sign: int) -> Row:
    key, shown = place.plus if sign > 0 else place.minus
    direction = "positive" if sign > 0 else "negative"
    verb = "Turn" if axis.turns else "Move"
    return Row(
        Area.MACHINE,
        key,
        shown,
        f"jog('{axis.name}', {sign})",
        f"Jog {axis.letter}{'+' if sign > 0 else '−'}",
        f"{verb} {axis.letter} by one step width in {direction} direction.",
        "Jog",
    )


def is_jog(row: Row) -> bool:
    """It jogs an axis."""
    return row.action.startswith("jog(")


def _zero_rows(axes: Sequence[AxisShape]) -> list[Row]:
    """One for each axis: its capital letter, where that is free."""
    taken = {key for row in _FIXED for key in row.keys.split(",")}
    others = iter(_OTHER_ZERO_KEYS)
    return [_zero(axis, axis.letter if axis.letter not in taken else next(others)) for axis in axes]


def _zero(axis: AxisShape, key: str) -> Row:
    name = axis.letter
    return Row(
        Area.MACHINE, key, key, f"zero('{axis.name}')", f"Zero {name}",
        f"Let the work zero of {name} be here.", "Position",
    )  # fmt: skip


def _set_width(number: int, width: Width) -> Row:
    rule = "" if width.mm else f"; from press {REPEAT_FROM} of the same key on {REPEAT_FACTOR}"
    return Row(
        Area.MACHINE,
        str(number),
        str(number),
        f"set_width({number - 1})",
        f"Step {width.label}",
        f"Step width {width.label}{rule}.",
        "Jog",
    )


def _choose(axis: AxisShape) -> Row:
    return Row(Area.REFERENCE, axis.name, axis.name, f"tick('axis-{axis.name}')", hint="choose")


class KeyTable:
    """All rows for one machine.

    Args:
        shape: its axes and steps.
        views: names of those that there are.

    Attributes:
        views: the rows of the views, by name.
        listed: commands in the order in which the list of commands shows them, column by column.
        commands: these and those that are only in the help and the palette.
        rows: these and the keys of dialogs and pages.
    """

    def __init__(self, shape: Shape, views: Iterable[str] = tuple(frame.VIEW_ROWS)) -> None:
        self.views = {name: frame.VIEW_ROWS[name] for name in views if name in frame.VIEW_ROWS}
        self.listed = (
            *_STOP,
            *_jog_rows(shape.axes, upright=True),
            _QUIT,
            *_jog_rows(shape.axes, upright=False),
            *_GOING,
            *_zero_rows(shape.axes),
            *_REST,
        )
        # The widths have a line of their own, the path is in another picture.
        steps = (_set_width(number, width) for number, width in enumerate(widths(shape), start=1))
        self.commands: tuple[Row, ...] = (
            *self.listed,
            *self.views.values(),
            *frame.AROUND,
            *byhand.BY_HAND,
            *_AFTERWARDS,
            *_OVERRIDES,
            *steps,
            *_SCROLLING,
            *(CALIBRATE if "calibrate" in self.views else ()),
            *(BENCH if "bench" in self.views else ()),
            *frame.LOG,
        )
        boxes = (_choose(axis) for axis in shape.axes)
        self.rows = (
            *self.commands, *byhand.DIALOGS, *BEFORE_AXES, *boxes, *AFTER_AXES, *CALIBRATE_DIALOGS,
        )  # fmt: skip
        self._step_word = shape.step_word

    def of(self, *areas: Area) -> Iterable[Row]:
        """The rows of these areas, in the order of the table."""
        return (row for row in self.rows if row.area in areas)

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
            f"At {self._step_word} width the original's repeat rule holds: presses 1 to"
            f" {REPEAT_FROM - 1} of the same key count single, from the {REPEAT_FROM}st on"
            " ten-fold; another key or a pause of a second resets it.",
            "Presses add up while the machine moves. The opposite key brakes and then goes the"
            " other way; another axis waits its turn.",
            "Nothing here is an emergency stop: that is a switch which cuts the power.",
            "Escape takes a tenth of a second, since longer keys begin like it; inside tmux or"
            " screen more (tmux: set escape-time 0). Ctrl+C takes none.",
        )
