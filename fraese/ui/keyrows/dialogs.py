"""The keys of dialogs and pages."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row


def _back(area: Area, hint: str = "back") -> Row:
    return Row(area, "escape", "Esc", "back", hint=hint)


#: In the order of their hints; the boxes of the axes come in between.
BEFORE_AXES: Final = (
    Row(Area.GO_TO, "", "Enter", "accept", hint="go"),
    Row(Area.GO_TO, "up", "↑", "counted_from(-1)", hint="counted from"),
    Row(Area.GO_TO, "down", "↓", "counted_from(1)", hint="counted from"),
    _back(Area.GO_TO),
    Row(Area.OPEN, "", "Enter", "accept", hint="open"),
    Row(Area.OPEN, "", "Tab", "", hint="to the files"),
    _back(Area.OPEN),
    Row(Area.MAP, "", "Enter", "accept", hint="take it; without a name: none"),
    Row(Area.MAP, "", "Tab", "", hint="to the files"),
    _back(Area.MAP),
    Row(Area.START, "", "Enter", "accept", hint="what has the focus; on a line: go there"),
    Row(Area.START, "", "Tab", "", hint="next"),
    _back(Area.START),
    Row(Area.START_THERE, "", "Enter", "accept", hint="go"),
    _back(Area.START_THERE),
    Row(Area.RESUME, "enter", "Enter", "accept", hint="go on", priority=True),
    Row(Area.RESUME, "up", "↑", "earlier(1)", hint="a move earlier, later"),
    Row(Area.RESUME, "down", "↓", "earlier(-1)", hint="a move earlier, later"),
    Row(Area.RESUME, "left", "←", "earlier(10)", hint="ten"),
    Row(Area.RESUME, "right", "→", "earlier(-10)", hint="ten"),
    Row(Area.RESUME, "pageup", "PgUp", "scroll(-1)", hint="scroll"),
    Row(Area.RESUME, "pagedown", "PgDn", "scroll(1)", hint="scroll"),
    _back(Area.RESUME),
    Row(Area.CRASH, "enter", "Enter", "accept", hint="reference again", priority=True),
    Row(Area.CRASH, "l", "l", "as_left", hint="as it was left"),
    _back(Area.CRASH, "decide later"),
    Row(Area.ASK, "enter,space", "Enter", "accept", hint="go on", priority=True),
    Row(Area.ASK, "m", "m", "by_hand", hint="move by hand"),
    Row(Area.ASK, "l", "l", "lift", hint="lift the tool"),
    _back(Area.ASK, "stop the job"),
    Row(Area.CONFIRM, "enter", "Enter", "accept", hint="do it", priority=True),
    _back(Area.CONFIRM),
    Row(Area.SWITCHES, "p", "p", "press", hint="press, let go (simulated)"),
    Row(Area.SWITCHES, "up", "↑", "step(-1)", hint="ask for another one"),
    Row(Area.SWITCHES, "down", "↓", "step(1)", hint="ask for another one"),
    _back(Area.SWITCHES),
    Row(Area.HELD_KEY, "right", "→", "measure_stroke", hint="hold it"),
    _back(Area.HELD_KEY, "close"),
    _back(Area.HELP),
    Row(Area.HELP, "question_mark,f1,q", "?", "back"),
    Row(Area.REFERENCE, "enter", "Enter", "accept", hint="go", priority=True),
)
AFTER_AXES: Final = (
    Row(Area.REFERENCE, "m", "m", "tick('measure')", hint="choose"),
    _back(Area.REFERENCE),
)
