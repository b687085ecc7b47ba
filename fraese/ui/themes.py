"""The looks: dark, light, and one for a sunny workshop or weak eyes."""

from typing import Final

from textual.theme import Theme

DARK: Final = Theme(
    name="fraese-dark",
    primary="#7fb4ca",
    secondary="#8a9ba8",
    accent="#e0b060",
    foreground="#d8dee4",
    background="#12161a",
    surface="#191f25",
    panel="#222a32",
    success="#8fbf7f",
    warning="#e0b060",
    error="#e8756a",
    dark=True,
)
LIGHT: Final = Theme(
    name="fraese-light",
    primary="#1f6480",
    secondary="#5b6770",
    accent="#8a5a00",
    foreground="#20262b",
    background="#f7f6f2",
    surface="#eeece6",
    panel="#e2dfd7",
    success="#2c6e36",
    warning="#8a5a00",
    error="#b3261e",
    dark=False,
)
CONTRAST: Final = Theme(
    name="fraese-contrast",
    primary="#5fd7ff",
    secondary="#ffffff",
    accent="#ffff00",
    foreground="#ffffff",
    background="#000000",
    surface="#000000",
    panel="#1c1c1c",
    success="#00ff5f",
    warning="#ffd700",
    error="#ff5f5f",
    dark=True,
)
#: In the order in which they follow each other.
THEMES: Final = (DARK, LIGHT, CONTRAST)


def after(name: str) -> str:
    """The name of the look that follows."""
    names = [theme.name for theme in THEMES]
    return names[(names.index(name) + 1) % len(names)] if name in names else names[0]
