"""The keys of the view Calibrate, and of the dialogs that it opens."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row


def _row(key: str, shown: str, action: str, title: str, what: str, footer: str = "") -> Row:
    return Row(Area.CALIBRATE, key, shown, action, title, what, "Calibrate", footer=footer)


ROUTINE_ROWS: Final = (
    _row("r", "r", "routine('reference')", "Reference run …",
         "Run to the end switches, and say what is being done."),
    _row("m", "m", "routine('travel')", "Measure travel …",
         "From one end switch to the other: how long the axis is."),
    _row("p", "p", "routine('steps')", "Steps per mm …",
         "Make a way, ask how far it really went, work out the pitch."),
    _row("b", "b", "routine('backlash')", "Backlash, by switch …",
         "Creep into the end switch and out again: how far the motor turns in vain."),
    _row("d", "d", "routine('gauge')", "Backlash, by gauge …",
         "Forward and back again before a dial gauge."),
    _row("n", "n", "routine('repeat')", "Repeat a switch …",
         "Approach an end switch again and again: how well it repeats."),
    _row("f", "f", "routine('frequency')", "Frequency test …",
         "Drive a motor at one rate after the other: where it resonates and stalls."),
    _row("e", "e", "routine('switches')", "Switch test …",
         "Press each end switch by hand and see it arrive."),
)  # fmt: skip
#: What else there is.
CALIBRATE: Final = (
    *ROUTINE_ROWS,
    _row("left", "←", "axis(-1)", "Axis before", "The axis before is calibrated."),
    _row("right", "→", "axis(1)", "Next axis", "The next axis is calibrated.", "Axis"),
    _row("h", "h", "mark", "It resonates",
         "Mark the value that is tried now: the motor hums or shakes."),
    _row("s", "s", "mark_stall", "It stalls",
         "Mark the value that is tried now, and end this stage: the motor stands."),
    _row("u", "u", "unmark", "Take back a mark", "The highest mark of this stage was a mistake."),
    _row("v", "v", "proposal(1)", "Other proposal", "Where there are several, the next one."),
    _row("pageup", "PgUp", "scroll_found(-1)", "Up", "Scroll what was found up."),
    _row("pagedown", "PgDn", "scroll_found(1)", "Down", "Scroll what was found down."),
    _row("w", "w", "write", "Write …",
         "Write what is proposed into the configuration file, after a question.", "Write"),
)  # fmt: skip
CALIBRATE_DIALOGS: Final = (
    Row(Area.FORM, "", "Enter", "accept", hint="go"),
    Row(Area.FORM, "", "Tab", "", hint="next field"),
    Row(Area.FORM, "escape", "Esc", "back", hint="back"),
    Row(Area.CONSENT, "enter", "Enter", "accept", hint="write", priority=True),
    Row(Area.CONSENT, "escape", "Esc", "back", hint="back"),
)
