"""The keys of what is done by hand in Move, and of its dialogs."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row

BY_HAND: Final = (
    Row(
        Area.MACHINE, "m,colon", "m", "type_line", "Type a line …",
        "G-code or a place such as X10 Y5, with what was typed before.",
        "Position", "Type",
    ),
    Row(
        Area.MACHINE, "n", "n", "set_position", "Set position …",
        "Say what the present position is to be: X0 Y0, Z12.5 on a plate, X/2 halves it.",
        "Position",
    ),
    Row(
        Area.MACHINE, "b", "b", "zero_two", "Zero X and Y",
        "Let the work zero of X and Y be here.", "Position",
    ),
    Row(
        Area.MACHINE, "G", "G", "go_to_zero", "Go to work zero",
        "Lift, over, down: to the safe height first, then above the zero, then down to it.",
        "Position",
    ),
    Row(
        Area.MACHINE, "f", "f", "offsets", "Work offsets …",
        "Choose, change and clear G54 to G59.3.", "Position",
    ),
    Row(
        Area.MACHINE, "T", "T", "tools", "Tools …",
        "Change the tool table: length, diameter, remark; it counts from the next program on.",
        "Position",
    ),
    Row(
        Area.MACHINE, "p", "p", "probe", "Probe …",
        "Feel for work, edge, corner, hole or boss, and set the work zero there.", "Position",
    ),
    Row(
        Area.MACHINE, "j", "j", "jog_rate", "Jog rate …",
        "How fast jogs go from the next one on; it is remembered.", "Jog",
    ),
    Row(
        Area.MACHINE, "h", "h", "measure_held_key", "Measure a held key …",
        "How this terminal repeats a key that is held, so that a jog begins and ends sooner;"
        " nothing moves meanwhile.", "Jog",
    ),
)  # fmt: skip
DIALOGS: Final = (
    Row(Area.JOG_RATE, "", "Enter", "accept", hint="set"),
    Row(Area.JOG_RATE, "escape", "Esc", "back", hint="back"),
    Row(Area.TYPED, "", "Enter", "accept", hint="do it"),
    Row(Area.TYPED, "up", "↑", "history(1)", hint="typed before"),
    Row(Area.TYPED, "down", "↓", "history(-1)", hint="typed before"),
    Row(Area.TYPED, "escape", "Esc", "back", hint="stop; at standstill close"),
    Row(Area.SET, "", "Enter", "accept", hint="set"),
    Row(Area.SET, "escape", "Esc", "back", hint="back"),
    Row(Area.OFFSETS, "", "Enter", "accept", hint="do it"),
    Row(Area.OFFSETS, "pageup", "PgUp", "scroll(-1)", hint="scroll"),
    Row(Area.OFFSETS, "pagedown", "PgDn", "scroll(1)", hint="scroll"),
    Row(Area.OFFSETS, "escape", "Esc", "back", hint="close"),
    Row(Area.TOOLS, "", "Enter", "accept", hint="do it"),
    Row(Area.TOOLS, "pageup", "PgUp", "scroll(-1)", hint="scroll"),
    Row(Area.TOOLS, "pagedown", "PgDn", "scroll(1)", hint="scroll"),
    Row(Area.TOOLS, "escape", "Esc", "back", hint="close"),
    Row(Area.PROBE, "", "Enter", "accept", hint="probe"),
    Row(Area.PROBE, "up", "↑", "cycle(-1)", hint="another cycle"),
    Row(Area.PROBE, "down", "↓", "cycle(1)", hint="another cycle"),
    Row(Area.PROBE, "escape", "Esc", "back", hint="back"),
)
