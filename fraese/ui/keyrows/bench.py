"""The keys of the view Bench."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row


def _row(key: str, shown: str, action: str, title: str, what: str, footer: str = "") -> Row:
    return Row(Area.BENCH, key, shown, action, title, what, "Bench", footer=footer)


BENCH: Final = (
    _row("up", "↑", "motor(-1)", "Motor before", "The motor before is worked on."),
    _row("down", "↓", "motor(1)", "Next motor", "The next motor is worked on.", "Motor"),
    _row("left", "←", "turn(-1)", "A step back", "One step of the motor back.", "Back"),
    _row("right", "→", "turn(1)", "A step ahead", "One step of the motor ahead.", "Ahead"),
    _row("pagedown", "PgDn", "turns(-1)", "A turn back",
         "One electrical turn back, in slow motion."),
    _row("pageup", "PgUp", "turns(1)", "A turn ahead",
         "One electrical turn ahead, in slow motion."),
    _row("s", "s", "rate(-1)", "Slower", "Slow motion at a lower rate."),
    _row("f", "f", "rate(1)", "Faster", "Slow motion at a higher rate."),
    _row("p", "p", "table", "Next phase table",
         "Drive the motors by the next phase table of the same length (simulated mill)."),
    _row("x", "x", "press", "Press a switch",
         "Press the lower end switch of this motor's axis, or let it go (simulated mill)."),
    _row("b", "b", "block", "Block the axis",
         "Hold the carriage of this motor's axis, or let it go (simulated mill)."),
)  # fmt: skip
