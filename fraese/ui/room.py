"""How much room there is, as classes of screens: what the style sheets ask."""

from typing import Final

WIDTHS: Final = [(0, "-narrow"), (140, "-wide")]
HEIGHTS: Final = [(0, "-flat"), (22, "-low"), (28, "-high"), (36, "-higher"), (45, "-tall")]
