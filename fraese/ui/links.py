"""Commands that can be clicked."""

from typing import TYPE_CHECKING, cast

from textual.content import Content
from textual.widgets import Static

if TYPE_CHECKING:
    from fraese.ui.app import FraeseApp


class Link(Static):
    """Key and title; a click does what the key does.

    Args:
        action: of the app.
        key: shown in front.
        title: shown behind.
    """

    def __init__(self, action: str, key: str, title: str) -> None:
        super().__init__(classes="link")
        self._key = key
        self._title = title
        self._action = action

    def render(self) -> Content:
        """The key stands out, unless the whole link does."""
        key = "bold" if self.has_class("-chosen") else "bold $accent"
        return Content.assemble((self._key, key), " ", self._title)

    async def on_click(self) -> None:
        """Do it; a click is no press of a key, so the repeat rule starts anew."""
        app = cast("FraeseApp", self.app)
        app.forget_repeats()
        await app.run_action(self._action)
