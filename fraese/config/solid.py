"""Things on the table of the simulated mill that a tool can touch.

plate, work     x_mm, y_mm, top_mm      solid from the top down
edge finder     the sides of such a block
tool setter     a small block of known height
hole            hole = true: cut out of all others, down to its top_mm
"""

from typing import Annotated, Final

from pydantic import Field, model_validator

from fraese.config.section import Section
from fraese.phrases import phrase

_FURTHEST_MM: Final = 100_000
_Place = Annotated[float, Field(ge=-_FURTHEST_MM, le=_FURTHEST_MM)]


class SimulatedSolid(Section):
    """A block on the table, in machine coordinates; where the tool touches it the probe closes."""

    x_mm: tuple[_Place, _Place] = Field((50, 80), description="From where to where along X, mm.")
    y_mm: tuple[_Place, _Place] = Field((40, 60), description="From where to where along Y, mm.")
    top_mm: _Place = Field(-20, description="Height of its top, mm; it is solid below.")
    corners_mm: tuple[_Place, _Place, _Place, _Place] = Field(
        (0, 0, 0, 0),
        description=(
            "How much higher its top is at its corners, mm: low X low Y, high X low Y, low X high"
            " Y, high X high Y; between them it is warped evenly."
        ),
    )
    hole: bool = Field(
        False, description="Whether this is cut out of the others, as far down as its top."
    )

    @model_validator(mode="after")
    def _low_to_high(self) -> "SimulatedSolid":
        for key in ("x_mm", "y_mm"):
            low, high = getattr(self, key)
            if low >= high:
                raise ValueError(
                    phrase(
                        "{key} goes from low to high, not {low} to {high}",
                        key=key,
                        low=f"{low:g}",
                        high=f"{high:g}",
                    )
                )
        return self
