"""How a key is called: by Textual, in the configuration, and for people."""

from typing import Final

from textual.keys import Keys, _character_to_key, key_to_character

#: A terminal sends the same for both, and the app hears the second.
_SAME: Final = {
    "ctrl+i": "tab",
    "ctrl+m": "enter",
    "ctrl+j": "enter",
    "ctrl+h": "backspace",
    "return": "enter",
}
_NAMED: Final = frozenset(each.value for each in Keys if each.value.strip("<>") == each.value)
_SHOWN: Final = {
    "left": "←", "right": "→", "up": "↑", "down": "↓", "pageup": "PgUp", "pagedown": "PgDn",
    "question_mark": "?", "slash": "/", "comma": ",", "full_stop": ".", "plus": "+", "minus": "-",
    "colon": ":", "equals_sign": "=", "less_than_sign": "<", "greater_than_sign": ">",
    "insert": "Ins", "delete": "Del", "escape": "Esc",
}  # fmt: skip


def key_named(text: str) -> str | None:
    """A key as Textual names it; None: there is no such key."""
    if len(text) == 1 and text.isprintable():
        return _character_to_key(text)
    key = text.lower()
    return _SAME.get(key, key) if key in _NAMED else None


def shown(key: str) -> str:
    """A key for people: ←, ^x, F5, g."""
    if key in _SHOWN:
        return _SHOWN[key]
    if key.startswith("ctrl+"):
        return f"^{shown(key.removeprefix('ctrl+'))}"
    character = "" if key in _NAMED else key_to_character(key)
    return character or "+".join(part.capitalize() for part in key.split("+"))
