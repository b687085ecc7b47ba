"""The keys of the view Settings, and of its dialog."""

from typing import Final

from fraese.ui.keyrows.row import Area, Row


def _row(key: str, shown: str, action: str, title: str, what: str, footer: str = "") -> Row:
    return Row(Area.SETTINGS, key, shown, action, title, what, "Settings", footer=footer)


SETTINGS: Final = (
    _row("up", "↑", "setting(-1)", "Key before", "Look at the key before."),
    _row("down", "↓", "setting(1)", "Next key", "Look at the next key."),
    _row("pageup", "PgUp", "setting(-10)", "Up", "Ten keys up."),
    _row("pagedown", "PgDn", "setting(10)", "Down", "Ten keys down."),
    _row("left", "←", "table(-1)", "Table before", "The table before."),
    _row("right", "→", "table(1)", "Next table", "The next table.", "Table"),
    _row("e", "e", "edit", "Edit …",
         "Type another value; it is checked while it is typed. The key that acknowledges does it,"
         " too, where there is nothing to acknowledge.", "Edit"),
    _row("d", "d", "default", "Default …",
         "Take the key out of the file, after a question: its default holds.", "Default"),
    _row("a", "a", "add", "Add …", "A key that is not in the list, such as tools.3.length_mm.",
         "Add"),
    _row("f", "f", "find", "Find …", "See only keys with a word in them; without one, all.",
         "Find"),
)  # fmt: skip
SETTINGS_DIALOGS: Final = (
    Row(Area.SETTING, "", "Enter", "accept", hint="write"),
    Row(Area.SETTING, "up", "↑", "choice(-1)", hint="other choice"),
    Row(Area.SETTING, "down", "↓", "choice(1)", hint="other choice"),
    Row(Area.SETTING, "escape", "Esc", "back", hint="back"),
)
