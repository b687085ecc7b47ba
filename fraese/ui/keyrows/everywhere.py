"""The keys that work everywhere: stop, quit, palette. Nobody takes them away."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row

STOP: Final = Row(
    Area.EVERYWHERE, "escape,ctrl+c", "Esc", "app.stop_machine", "Stop",
    "Brake with ramp and drop the rest of the job; pressed again while it still moves: stop"
    " without ramp. Works everywhere, also while typing; at standstill it closes dialogs."
    " Ctrl+C does the same.",
    "Stop", "Stop", priority=True,
)  # fmt: skip
QUIT_AT_ONCE: Final = Row(
    Area.EVERYWHERE, "ctrl+q", "^q", "app.quit", "Quit at once",
    "Brake, motors off, leave.", "Machine", priority=True,
)  # fmt: skip
#: Textual binds this one itself.
PALETTE: Final = Row(Area.EVERYWHERE, "ctrl+p", "^p", "app.command_palette")
STOP_KEYS: Final = frozenset(STOP.each)
#: They quit wherever they are pressed.
QUIT_KEYS: Final = frozenset(QUIT_AT_ONCE.each)
#: The stop key that is a single byte, and known also where it stands in the middle of something.
STOP_BYTE: Final = "\x03"
STOP_BYTE_KEY: Final = "ctrl+c"
#: The other one: a byte that longer keys begin with.
ESCAPE: Final = "\x1b"
ESCAPE_KEY: Final = "escape"
