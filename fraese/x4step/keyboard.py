"""Keys and their make codes: places on the keyboard of a PC (set 1), as the manual prints them.

The grey keys of an MF2 keyboard have the codes of the
keypad, whose prefix is dropped; so have Enter, Ctrl, Alt and / twice.
"""

from collections.abc import Mapping
from typing import Final

#: A break code is the make code and this.
BREAK: Final = 128

_ROWS: Final = (
    (2, "1 2 3 4 5 6 7 8 9 0 - = BACKSPACE"),
    (15, "TAB Q W E R T Y U I O P [ ] ENTER"),
    (29, "CTRL A S D F G H J K L ; ' ` SHIFT"),
    (43, "\\ Z X C V B N M , . / RIGHTSHIFT KP*"),
    (56, "ALT SPACE CAPSLOCK F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 NUMLOCK SCROLLLOCK"),
    (71, "HOME UP PAGEUP KP- LEFT KP5 RIGHT KP+ END DOWN PAGEDOWN INSERT DELETE SYSREQ"),
    (86, "102ND F11 F12"),
)

#: Make code of every key, by its name on a keyboard of the United States.
MAKE_CODES: Final[Mapping[str, int]] = {
    "ESC": 1,
    **{name: first + place for first, names in _ROWS for place, name in enumerate(names.split())},
}

#: The 84 keys of an AT keyboard, row by row.
AT_KEYBOARD: Final = (
    (59, 60, 41, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 43, 14, 1, 69, 70, 84),
    (61, 62, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 71, 72, 73, 55),
    (63, 64, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 28, 75, 76, 77, 74),
    (65, 66, 42, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 79, 80, 81),
    (67, 68, 56, 57, 58, 82, 83, 78),
)

#: The 102 keys of an MF2 keyboard. The manual has 29 (Ctrl) where Caps Lock is, 58.
MF2_KEYBOARD: Final = (
    (1, 59, 60, 61, 62, 63, 64, 65, 66, 67, 68, 87, 88, 70),
    (41, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 82, 71, 73, 69, 53, 55, 74),
    (15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 83, 79, 81, 71, 72, 73, 78),
    (58, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 43, 75, 76, 77),
    (42, 86, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 72, 79, 80, 81, 28),
    (29, 56, 57, 56, 29, 75, 80, 77, 82, 83),
)

#: Characters of each layout, without and with Shift, from the place of a make code on.
_LAYOUTS: Final[Mapping[str, tuple[tuple[int, str], ...]]] = {
    "us": (
        (2, "1234567890-="), (2, "!@#$%^&*()_+"),
        (16, "qwertyuiop[]"), (16, "QWERTYUIOP{}"),
        (30, "asdfghjkl;'`"), (30, 'ASDFGHJKL:"~'),
        (43, "\\zxcvbnm,./"), (43, "|ZXCVBNM<>?"),
    ),
    "de": (
        (2, "1234567890ß´"), (2, '!"§$%&/()=?`'),
        (16, "qwertzuiopü+"), (16, "QWERTZUIOPÜ*"),
        (30, "asdfghjklöä^"), (30, "ASDFGHJKLÖÄ°"),
        (43, "#yxcvbnm,.-"), (43, "'YXCVBNM;:_"),
        (86, "<"), (86, ">"),
    ),
}  # fmt: skip

#: What a keyboard of evdev calls by another number (linux/input-event-codes.h); the others are the
#: same. Grey keys as everywhere; Print is the * of the keypad with a prefix.
_EVDEV_NAMES: Final = (
    (96, "ENTER CTRL / KP* ALT"),
    (102, "HOME UP PAGEUP LEFT RIGHT END DOWN PAGEDOWN INSERT DELETE"),
)
#: Make codes of the key codes of evdev.
EVDEV_CODES: Final[Mapping[int, int]] = {
    **{code: code for name, code in MAKE_CODES.items() if name != "SYSREQ"},
    **{
        first + place: MAKE_CODES[name]
        for first, names in _EVDEV_NAMES
        for place, name in enumerate(names.split())
    },
}

#: Numbers of keys that are no characters in the kitty keyboard protocol, from the first of each
#: row on; "-": X4Step knows no such key.
_KITTY_NAMES: Final = (
    (57358, "CAPSLOCK SCROLLLOCK NUMLOCK KP*"),
    (57399, "INSERT END DOWN PAGEDOWN LEFT KP5 RIGHT HOME UP PAGEUP DELETE / KP* KP- KP+ ENTER"),
    (57417, "LEFT RIGHT UP DOWN PAGEUP PAGEDOWN HOME END INSERT DELETE KP5"),
    (57441, "SHIFT CTRL ALT - - - RIGHTSHIFT CTRL ALT - - - ALT"),
)
#: Make codes of those keys.
KITTY_CODES: Final[Mapping[int, int]] = {
    first + place: MAKE_CODES[name]
    for first, names in _KITTY_NAMES
    for place, name in enumerate(names.split())
    if name != "-"
}
#: Keys that are no answer to ``getch``: they only change what others mean.
SILENT_CODES: Final = frozenset(
    MAKE_CODES[name]
    for name in ("CAPSLOCK", "SCROLLLOCK", "NUMLOCK", "SHIFT", "CTRL", "ALT", "RIGHTSHIFT")
)

_EVERYWHERE: Final = {"\r": 28, "\n": 28, "\t": 15, "\x7f": 14, "\b": 14, " ": 57, "\x1b": 1}
_CONTROL_A: Final = 1


def char_codes(layout: str) -> dict[str, int]:
    """Make codes of the characters that a terminal sends.

    Args:
        layout: "us" or "de".
    """
    codes = {
        char: first + place for first, chars in _LAYOUTS[layout] for place, char in enumerate(chars)
    }
    letters = {chr(_CONTROL_A + n): codes[chr(ord("a") + n)] for n in range(26)}
    return {**letters, **codes, **_EVERYWHERE}


#: Keys that a terminal sends as a sequence, by what follows ESC.
SEQUENCES: Final[Mapping[str, int]] = {
    **{
        lead + last: MAKE_CODES[name]
        for lead in ("[", "O")
        for last, name in zip(
            "ABCDHF", ("UP", "DOWN", "RIGHT", "LEFT", "HOME", "END"), strict=True
        )
    },
    **{
        lead + last: MAKE_CODES[f"F{n}"]
        for lead in ("[", "O")
        for n, last in enumerate("PQRS", 1)
    },
    "[E": MAKE_CODES["KP5"],
    "[57427~": MAKE_CODES["KP5"],
    **{f"[[{last}": MAKE_CODES[f"F{n}"] for n, last in enumerate("ABCDE", 1)},
    **{
        f"[{number}~": MAKE_CODES[name]
        for number, name in {
            1: "HOME", 2: "INSERT", 3: "DELETE", 4: "END", 5: "PAGEUP", 6: "PAGEDOWN",
            7: "HOME", 8: "END", 11: "F1", 12: "F2", 13: "F3", 14: "F4", 15: "F5", 17: "F6",
            18: "F7", 19: "F8", 20: "F9", 21: "F10", 23: "F11", 24: "F12",
        }.items()
    },
}  # fmt: skip
