"""Lists to choose from, and the palette: whatever is done to them before they are laid out.

Textual's fail where a page is asked for and there is no line, in a low window or too soon, and
where a line is clicked that has just gone. An app that fails ends.
"""

from contextlib import suppress
from typing import Literal

from textual import events, work
from textual.app import ComposeResult
from textual.await_complete import AwaitComplete
from textual.command import CommandList, CommandPalette
from textual.css.query import NoMatches
from textual.widgets import Input, OptionList


class Options(OptionList):
    """A list that pages where there are pages, and takes clicks on what is there."""

    def _move_page(self, direction: Literal[-1, 1]) -> None:
        if self._lines:
            super()._move_page(direction)

    async def _on_click(self, event: events.Click) -> None:
        option = event.style.meta.get("option")
        if option is not None and option >= self.option_count:
            event.prevent_default()


class Commands(CommandList, Options):
    """The commands of the palette."""


class Palette(CommandPalette):
    """The command palette, with such a list."""

    def compose(self) -> ComposeResult:
        """As Textual's."""
        for widget in super().compose():
            yield Commands() if isinstance(widget, CommandList) else widget

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Its keys move in a list that is made a moment after it, and goes a moment before."""
        if not self._has_list and action in ("cursor_down", "command_list"):
            return False
        return super().check_action(action, parameters)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Likewise Enter, which Textual's palette hears by itself."""
        if not self._has_list:
            event.stop()
            event.prevent_default()

    @property
    def _has_list(self) -> bool:
        return bool(self.query(CommandList))

    @work(exclusive=True, group=CommandPalette._GATHER_COMMANDS_GROUP)
    async def _gather_commands(self, search_value: str) -> None:
        """As Textual's, also where the palette has gone before its search begins."""
        with suppress(NoMatches):
            await CommandPalette._gather_commands.__wrapped__(self, search_value)  # type: ignore[attr-defined]

    def dismiss(self, result: None = None) -> AwaitComplete:
        """Close it, once: two keys that come at once may both want to."""
        return super().dismiss(result) if self.is_current else AwaitComplete()
