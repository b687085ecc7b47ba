"""The keys of the machine: in every view, and in Move."""

from typing import Final

from fraese.ui.keyrows.program import RAPIDS, RUNNING
from fraese.ui.keyrows.row import Area, Row

HOLDING: Final = (
    Row(
        Area.VIEWS, "space", "Space", "hold", "Hold, go on",
        "Brake with ramp and wait; once more: go on where it stands.", "Stop", "Hold",
    ),
    Row(
        Area.VIEWS, "enter", "Enter", "acknowledge", "Acknowledge",
        "Take note of an error; before that nothing moves.", "Stop",
    ),
)  # fmt: skip
QUIT: Final = Row(
    Area.VIEWS, "q", "q", "leave", "Quit",
    "Leave, motors off. While the machine runs, stop it first.", "Machine", "Quit",
)  # fmt: skip
GOING: Final = (
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
REST: Final = (
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
        "This page.", "Machine", "Help",
    ),
)  # fmt: skip
OVERRIDES: Final = (
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
        "The next larger step width, after the largest the smallest.", "Jog",
    ),
    Row(
        Area.MACHINE, "W,minus", "W", "width(-1)", "Narrower step",
        "The next smaller step width.", "Jog",
    ),
)  # fmt: skip
AFTERWARDS: Final = (
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
        Area.RUNNING, "u", "u", "resume", "Resume program …",
        "Go on with the program that was cut short by a stop, an alarm or a crash, or some moves"
        " earlier; what it will do is shown first.", "Program",
    ),
    Row(
        Area.RUNNING, "H", "H", "height_map", "Height map …",
        "Choose the height map to which the program that is open is bent, or none; probe one with"
        " the last of the probing cycles.", "Program",
    ),
    Row(
        Area.VIEWS, "O", "O", "take_over", "Take over",
        "Take the machine from another program that is connected as a sender, with ramp, or give it"
        " back.", "Stop",
    ),
    Row(
        Area.MACHINE, "k", "k", "after_crash", "After a crash …",
        "What is known of the position; take it as it was left, or reference again.", "Position",
    ),
)  # fmt: skip
SCROLLING: Final = (
    Row(
        Area.MACHINE, "ctrl+up", "^↑", "scroll_path(-1)", "Path up",
        "Scroll the program up.", "Program",
    ),
    Row(
        Area.MACHINE, "ctrl+down", "^↓", "scroll_path(1)", "Path down",
        "Scroll the program down.", "Program",
    ),
)  # fmt: skip
