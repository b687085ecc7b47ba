"""The keys that lead from view to view."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row


def _view(number: int, name: str, title: str, short: str, what: str) -> Row:
    return Row(
        Area.VIEWS, f"f{number}", f"F{number}", f"app.show_view('{name}')", title,
        f"The view {title}: {what}.", "Views", footer=short,
        given_name=f"view_{name}",
    )  # fmt: skip


#: By the name of the view. A row here is a view's place among the keys; whether there is such a
#: view, the table of views says.
VIEW_ROWS: Final = {
    "move": _view(2, "move", "Move", "Move", "position, jogs, zero, references"),
    "program": _view(3, "program", "Program", "Prog", "the program, its path and its progress"),
    "calibrate": _view(4, "calibrate", "Calibrate", "Calib", "switches, travel, steps, backlash"),
    "bench": _view(5, "bench", "Bench", "Bench", "lines, coils and rotors at work"),
    "log": _view(6, "log", "Log", "Log", "what has happened, and when"),
    "settings": _view(7, "settings", "Settings", "Set", "what the configuration says"),
}
AROUND: Final = (
    Row(
        Area.VIEWS, "tab", "Tab", "app.next_view(1)", "Next view",
        "The next view, after the last the first.", "Views",
    ),
    Row(
        Area.VIEWS, "shift+tab", "Shift+Tab", "app.next_view(-1)", "View before",
        "The view before.", "Views",
    ),
)  # fmt: skip
LOG: Final = (
    Row(
        Area.LOG, "f", "f", "filter_log", "Filter", "All events, alarms and warnings, or alarms.",
        "Log", "Filter",
    ),
    Row(
        Area.LOG, "c", "c", "copy_log", "Copy", "Give what is shown to the terminal's clipboard.",
        "Log", "Copy",
    ),
    Row(
        Area.LOG, "up", "↑", "scroll_log(-1)", "Up a line", "Scroll the log up.", "Log",
    ),
    Row(
        Area.LOG, "down", "↓", "scroll_log(1)", "Down a line", "Scroll the log down.", "Log",
    ),
    Row(
        Area.LOG, "pageup", "PgUp", "scroll_log(-10)", "Up", "Scroll the log up by ten.", "Log",
    ),
    Row(
        Area.LOG, "pagedown", "PgDn", "scroll_log(10)", "Down", "Scroll the log down by ten.",
        "Log",
    ),
)  # fmt: skip
