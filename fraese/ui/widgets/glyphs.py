"""Letters and digits made of dots, for what is read from across the workshop.

A dot is one column wide and half a row high; or two columns wide and one row high.

    THIN    6 dots high, a stroke is one dot: letters and digits
    BOLD    5 dots high, upright strokes are two dots: digits and the letters of axes
    TALL    8 dots high, likewise
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

_HALVES: Final = {"  ": " ", "# ": "▀", " #": "▄", "##": "█"}


@dataclass(frozen=True, slots=True, eq=False)
class Font:
    """Glyphs of one height.

    Attributes:
        dots: how many high they are.
        glyphs: rows of "#" and " ", by character.
    """

    dots: int
    glyphs: dict[str, tuple[str, ...]]

    def rows(self, *, double: bool) -> int:
        """Rows of the screen that it takes."""
        return self.dots if double else self.dots // 2

    @lru_cache(maxsize=256)  # noqa: B019 (the fonts live as long as the program)
    def lines(self, text: str, *, double: bool = False) -> tuple[str, ...]:
        """A text, a blank column between its glyphs; what has none is drawn as a blank."""
        glyphs = [self.glyphs.get(char, self.glyphs[" "]) for char in text]
        rows = [" ".join(glyph[row] for glyph in glyphs) for row in range(self.dots)]
        if double:
            return tuple("".join("██" if dot == "#" else "  " for dot in row) for row in rows)
        return tuple(
            "".join(_HALVES[a + b] for a, b in zip(rows[at], rows[at + 1], strict=True))
            for at in range(0, self.dots, 2)
        )


def _drawn(names: str, *rows: str) -> dict[str, tuple[str, ...]]:
    """Glyphs that stand side by side in rows of dots, a blank between them."""
    split = [row.split() for row in rows]
    return {
        name: tuple(row[at].replace(".", " ") for row in split) for at, name in enumerate(names)
    }


THIN: Final = Font(
    6,
    {
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
            "0123456789-.",
            ".##. .#.. .##. .##. ..#. #### .##. #### .##. .##. .... .",
            "#..# ##.. #..# #..# .##. #... #... ...# #..# #..# .... .",
            "#..# .#.. ...# ..#. #.#. ###. ###. ..#. .##. #..# ###. .",
            "#..# .#.. ..#. ...# #### ...# #..# ..#. #..# .### .... .",
            "#..# .#.. .#.. #..# ..#. #..# #..# .#.. #..# ...# .... .",
            ".##. ###. #### .##. ..#. .##. .##. .#.. .##. .##. .... #",
        ),
        " ": ("    ",) * 6,
    },
)
#: The lowest row is blank: numbers that stand one below the other do not touch.
BOLD: Final = Font(
    6,
    {
        **_drawn(
            "0123456789-.",
            ".###. ..##. ####. ####. ##.## ##### .###. ##### .###. .###. ..... ..",
            "##.## .###. ...## ...## ##.## ##... ##... ...## ##.## ##.## ..... ..",
            "##.## ..##. .###. .###. ##### ####. ####. ..##. .###. .#### ##### ..",
            "##.## ..##. ##... ...## ...## ...## ##.## .##.. ##.## ...## ..... ..",
            ".###. .#### ##### ####. ...## ####. .###. .##.. .###. .###. ..... ##",
            "..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..",
        ),
        **_drawn(
            "XYZABCUVW",
            "##.## ##.## ##### .###. ####. .#### ##.## ##.## ##.##",
            ".###. .###. ..##. ##.## ##.## ##... ##.## ##.## #.#.#",
            "..#.. ..#.. .##.. ##### ####. ##... ##.## ##.## #.#.#",
            ".###. ..#.. ##... ##.## ##.## ##... ##.## .###. #####",
            "##.## ..#.. ##### ##.## ####. .#### .###. ..#.. .#.#.",
            "..... ..... ..... ..... ..... ..... ..... ..... .....",
        ),
        " ": ("     ",) * 6,
    },
)
TALL: Final = Font(
    8,
    {
        **_drawn(
            "0123456789-.",
            ".###. ..##. .###. .###. ...## ##### .###. ##### .###. .###. ..... ..",
            "##.## .###. ##.## ##.## ..### ##... ##.## ...## ##.## ##.## ..... ..",
            "##.## ####. ...## ...## .#### ##... ##... ...## ##.## ##.## ..... ..",
            "##.## ..##. ...## ..##. ##.## ####. ####. ..##. .###. ##.## ##### ..",
            "##.## ..##. ..##. ..##. ##.## ...## ##.## ..##. ##.## .#### ##### ..",
            "##.## ..##. .##.. ...## ##### ...## ##.## .##.. ##.## ...## ..... ..",
            "##.## ..##. ##... ##.## ...## ##.## ##.## .##.. ##.## ##.## ..... ##",
            ".###. ##### ##### .###. ...## .###. .###. .##.. .###. .###. ..... ##",
        ),
        **_drawn(
            "XYZABCUVW",
            "##.## ##.## ##### .###. ####. .###. ##.## ##.## ##.##",
            "##.## ##.## ...## ##.## ##.## ##.## ##.## ##.## ##.##",
            ".###. ##.## ...## ##.## ##.## ##... ##.## ##.## ##.##",
            "..#.. .###. ..##. ##.## ####. ##... ##.## ##.## ##.##",
            "..#.. ..#.. .##.. ##### ##.## ##... ##.## ##.## #.#.#",
            ".###. ..#.. ##... ##.## ##.## ##... ##.## .###. #.#.#",
            "##.## ..#.. ##... ##.## ##.## ##.## ##.## .###. #####",
            "##.## ..#.. ##### ##.## ####. .###. .###. ..#.. .#.#.",
        ),
        " ": ("     ",) * 8,
    },
)
