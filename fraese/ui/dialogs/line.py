"""Dialogs of one line that is tried: what is refused is said in the dialog, and it stays."""

from collections.abc import Callable
from typing import Final

from textual.app import ComposeResult
from textual.widgets import Button, Input

from fraese.control.controller import Controller
from fraese.errors import FraeseError
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import KeyTable
from fraese.ui.machinelink import MachineLink

#: Nobody types more; a paste is cut.
_LONGEST: Final = 500
_BUSY: Final = spoken(
    "The machine runs: wait for the end of the job, or stop it; nothing was done."
)

Command = Callable[[Controller], object]


class LineDialog(Dialog[str]):
    """A line, and what becomes of it; the result is the line that was taken.

    Args:
        keys: the table.
        link: to the machine.
        text: what stands in the line at first.
        example: what may be typed.
    """

    def __init__(
        self, keys: KeyTable, link: MachineLink, text: str = "", example: str = ""
    ) -> None:
        super().__init__(keys)
        self.link = link
        self._text = text
        self._example = example

    def inner(self) -> ComposeResult:
        """The line."""
        yield Input(self._text, placeholder=self._example, id="line", max_length=_LONGEST)

    def on_mount(self) -> None:
        """Type at once."""
        self.query_one("#line", Input).focus()

    @property
    def line(self) -> str:
        """What is typed."""
        return self.query_one("#line", Input).value.strip()

    def put(self, text: str) -> None:
        """Let this be what is typed."""
        line = self.query_one("#line", Input)
        line.value = text
        line.cursor_position = len(text)

    def command(self, line: str) -> Command:
        """What is to be done about it, in the machine's thread.

        Raises:
            FraeseError: if it says nothing that can be done.
        """
        raise NotImplementedError

    def taken(self, line: str) -> None:
        """It was begun."""
        self.dismiss(line)

    def action_accept(self) -> None:
        """Try it."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        try:
            self.accept(self.line)
        except FraeseError as error:
            self.complain(str(error))

    def accept(self, line: str) -> None:
        """Begin what it says.

        Raises:
            FraeseError: if it says nothing that can be done.
        """
        self.attempt(self.command(line), line)

    def attempt(self, command: Command, line: str) -> None:
        """Do it in the machine's thread; what is refused there is said here."""

        def go(controller: Controller) -> None:
            try:
                command(controller)
            except FraeseError as error:
                self.call_later(self.complain, str(error))
            else:
                self.call_later(self.taken, line)

        self.complain("" if self.link.order_of(go) else _BUSY)
