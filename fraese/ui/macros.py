"""Buttons of one's own: lines of G-code, or a file of them."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Macro:
    """One of them.

    Attributes:
        name: on the button.
        lines: of G-code.
        file: instead of them; empty: there is none.
        confirm: its lines are shown first.
    """

    name: str
    lines: tuple[str, ...] = ()
    file: str = ""
    confirm: bool = True

    @property
    def text(self) -> str:
        """Its lines."""
        return "\n".join(self.lines)
