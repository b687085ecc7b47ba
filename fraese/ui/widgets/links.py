"""Commands that can be clicked."""

from textual.content import Content
from textual.message import Message
from textual.widgets import Static


class Link(Static):
    """Key and title; a click does what the key does: it tells the screen.

    Args:
        action: of the screen.
        key: shown in front.
        title: shown behind.
        id: of the widget.
    """

    class Clicked(Message):
        """This command is wanted."""

        def __init__(self, action: str) -> None:
            super().__init__()
            self.action = action

    def __init__(
        self,
        action: str,
        key: str,
        title: str,
        *,
        id: str | None = None,  # noqa: A002
    ) -> None:
        super().__init__(id=id, classes="link")
        self._key = key
        self._title = title
        self._action = action

    def render(self) -> Content:
        """The key stands out, unless the whole link does."""
        key = "bold" if self.has_class("-chosen") else "bold $accent"
        return Content.assemble((self._key, key), " ", self._title)

    def show_title(self, title: str) -> None:
        """This stands behind the key from now on."""
        if title != self._title:
            self._title = title
            self.refresh(layout=True)

    def on_click(self) -> None:
        """Tell the screen."""
        self.post_message(self.Clicked(self._action))
