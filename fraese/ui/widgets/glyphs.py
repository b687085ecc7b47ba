"""Capital letters and digits of 6 dots' height, for words that are read from across the workshop.

A dot is one column wide and half a row high; or two columns wide and one row high.
"""

from typing import Final

ROWS: Final = 6
_HALVES: Final = {"  ": " ", "# ": "▀", " #": "▄", "##": "█"}


def _drawn(names: str, *rows: str) -> dict[str, tuple[str, ...]]:
    """Glyphs that stand side by side in rows of dots, a blank between them."""
    split = [row.split() for row in rows]
    return {
        name: tuple(row[at].replace(".", " ") for row in split) for at, name in enumerate(names)
    }


_GLYPHS: Final[dict[str, tuple[str, ...]]] = {
    **_drawn(
        "ABCDEFGHIJKLM",
        ".##. ###. .### ###. #### #### .### #..# ### ..## #..# #... #...#",
        "#..# #..# #... #..# #... #... #... #..# .#. ...# #.#. #... ##.##",
        "#..# ###. #... #..# ###. ###. #... #### .#. ...# ##.. #... #.#.#",
        "#### #..# #... #..# #... #... #.## #..# .#. ...# ##.. #... #.#.#",
        "#..# #..# #... #..# #... #... #..# #..# .#. #..# #.#. #... #...#",
        "#..# ###. .### ###. #### #... .### #..# ### .##. #..# #### #...#",
    ),
    **_drawn(
        "NOPQRSTUVWXYZ",
        "#..# .##. ###. .##. ###. .### ##### #..# #...# #...# #...# #...# #####",
        "##.# #..# #..# #..# #..# #... ..#.. #..# #...# #...# .#.#. #...# ...#.",
        "##.# #..# #..# #..# #..# .##. ..#.. #..# #...# #.#.# ..#.. .#.#. ..#..",
        "#.## #..# ###. #..# ###. ...# ..#.. #..# .#.#. #.#.# ..#.. ..#.. .#...",
        "#.## #..# #... #.#. #.#. ...# ..#.. #..# .#.#. ##.## .#.#. ..#.. #....",
        "#..# .##. #... .#.# #..# ###. ..#.. .##. ..#.. #...# #...# ..#.. #####",
    ),
    **_drawn(
        "0123456789-.:?+%",
        ".##. .#. .##. .##. ..#. #### .##. #### .##. .##. ... . . .##. ... #..#",
        "#..# ##. #..# #..# .##. #... #... ...# #..# #..# ... . # #..# .#. ...#",
        "#..# .#. ...# ..#. #.#. ###. ###. ..#. .##. #..# ### . . ..#. ### ..#.",
        "#..# .#. ..#. ...# #### ...# #..# ..#. #..# .### ... . . .#.. .#. .#..",
        "#..# .#. .#.. #..# ..#. #..# #..# .#.. #..# ...# ... . # .... ... #...",
        ".##. ### #### .##. ..#. .##. .##. .#.. .##. .##. ... # . .#.. ... #..#",
    ),
    " ": ("  ",) * ROWS,
}


def word_lines(text: str, *, double: bool = False) -> list[str]:
    """A text in large letters: 3 lines, or 6 lines of double width; what has no glyph is "?"."""
    glyphs = [_GLYPHS.get(char, _GLYPHS["?"]) for char in text.upper()]
    rows = [" ".join(glyph[row] for glyph in glyphs) for row in range(ROWS)]
    if double:
        return ["".join("██" if dot == "#" else "  " for dot in row) for row in rows]
    return [
        "".join(_HALVES[upper + lower] for upper, lower in zip(rows[at], rows[at + 1], strict=True))
        for at in range(0, ROWS, 2)
    ]
