"""The keys of programs: what starts and alters them, and how the view Program is looked at."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row

#: In every view that runs programs.
RUNNING: Final = (
    Row(
        Area.RUNNING, "o", "o", "open", "Open program …",
        "Choose a program file, by its path, from those opened last or from the folders; it is read"
        " and checked.", "Program", "Open",
    ),
    Row(
        Area.RUNNING, "s", "s", "start", "Start program …",
        "Look at everything that is known of the program, then run it: from its first line, from"
        " another one, or drive round its frame first.", "Program", "Start",
    ),
)  # fmt: skip
RAPIDS: Final = (
    Row(
        Area.VIEWS, "less_than_sign", "<", "rapids(-10)", "Slower rapids",
        "Override of rapids 10 % lower, down to 10 %; acts at once.", "Program",
    ),
    Row(
        Area.VIEWS, "greater_than_sign", ">", "rapids(10)", "Faster rapids",
        "Override of rapids 10 % higher, up to 100 %.", "Program",
    ),
)  # fmt: skip
PROGRAM: Final = (
    Row(
        Area.PROGRAM, "b", "b", "switch('single_block')", "Single block",
        "Wait after every line that moves, or not; acts on lines that are not planned yet.",
        "Program", "Single",
    ),
    Row(
        Area.PROGRAM, "m", "m", "switch('optional_stop')", "Optional stop",
        "M1 stops, or is passed.", "Program", "M1",
    ),
    Row(
        Area.PROGRAM, "slash", "/", "switch('block_delete')", "Block delete",
        "Lines that begin with a slash are left out, or not; acts on the next start.",
        "Program", "Slash",
    ),
    Row(
        Area.PROGRAM, "v", "v", "next_side", "Other side",
        "Look at the path from above, from a corner, from the front, from the side.",
        "Display", "Side",
    ),
    Row(
        Area.PROGRAM, "f", "f", "fit", "All of it",
        "See the whole path.", "Display", "All",
    ),
    Row(
        Area.PROGRAM, "plus", "+", "zoom(1)", "Nearer",
        "Look at the path from nearer; also with the mouse's wheel.", "Display",
    ),
    Row(
        Area.PROGRAM, "minus", "-", "zoom(-1)", "Further away",
        "Look at the path from further away; likewise.", "Display",
    ),
    Row(
        Area.PROGRAM, "left", "←", "pan(-1, 0)", "Look left",
        "See more of what lies to the left; the mouse drags.", "Display",
    ),
    Row(
        Area.PROGRAM, "right", "→", "pan(1, 0)", "Look right",
        "See more of what lies to the right.", "Display",
    ),
    Row(
        Area.PROGRAM, "up", "↑", "pan(0, -1)", "Look up",
        "See more of what lies above.", "Display",
    ),
    Row(
        Area.PROGRAM, "down", "↓", "pan(0, 1)", "Look down",
        "See more of what lies below.", "Display",
    ),
    Row(
        Area.PROGRAM, "pageup,ctrl+up", "PgUp", "scroll_path(-1)", "Lines up",
        "Scroll the program up.", "Program",
    ),
    Row(
        Area.PROGRAM, "pagedown,ctrl+down", "PgDn", "scroll_path(1)", "Lines down",
        "Scroll the program down.", "Program",
    ),
)  # fmt: skip
