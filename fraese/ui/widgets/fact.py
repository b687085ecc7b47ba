"""A text that is drawn when it changes, and only then. Foreign text is made plain."""

from textual.widgets import Static

from fraese.phrases import shown
from fraese.plaintext import plain, plain_lines


class Fact(Static):
    """A few words; ``show`` costs a comparison while they stay the same.

    Attributes:
        flows: its height follows the text; else a new text needs no new layout.
    """

    flows = False

    def __init__(
        self,
        text: str = "",
        *,
        id: str | None = None,  # noqa: A002
        classes: str | None = None,
    ) -> None:
        text = shown(text)
        super().__init__(plain(text), id=id, classes=classes, markup=False)
        self._text = text
        self._tone = ""

    def show(self, text: str, tone: str = "") -> None:
        """These words, in this tone: a CSS class such as "-alarm", or none."""
        text = shown(text)
        if text != self._text:
            self._text = text
            self.update(self._plain(text), layout=self.flows)
        if tone != self._tone:
            before, self._tone = self._tone, tone
            self.set_classes((self.classes - {before}) | ({tone} if tone else set()))

    def _plain(self, text: str) -> str:
        return plain(text)

    @property
    def text(self) -> str:
        """What it shows."""
        return self._text


class Lines(Fact):
    """Several lines."""

    def _plain(self, text: str) -> str:
        return "\n".join(plain(line) for line in text.split("\n"))


class Flowing(Fact):
    """A text whose room follows it."""

    flows = True


class Paragraph(Static):
    """Lines, as many as there are; drawn when they change."""

    def __init__(self, *, id: str) -> None:  # noqa: A002
        super().__init__("", id=id, markup=False)
        self.text = ""
        self.display = False

    def show(self, text: str) -> None:
        """These; none take no room."""
        text = shown(text)
        if text != self.text:
            self.text = text
            self.display = bool(text)
            self.update(plain_lines(text))
