"""The views of the app: one at a time, and how the palette finds the one that a command is of."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from textual import events
from textual.app import App, SystemCommand
from textual.screen import Screen

from fraese.phrases import spoken
from fraese.plaintext import plain
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.views.view import Desk, View
from fraese.ui.widgets.options import Palette


class ViewedApp(App[None]):
    """An app whose modes are views."""

    #: The terminal selects text, with Shift and the mouse. Textual fails over what has just gone.
    ALLOW_SELECT = False
    _keys: KeyTable

    async def on_event(self, event: events.Event) -> None:
        """As Textual's; what is typed on the way out goes nowhere."""
        if self.screen_stack or not isinstance(event, events.InputEvent):
            await super().on_event(event)

    def make_views(self, views: Mapping[str, type[View]], desk: Desk) -> None:
        """All there are; none is drawn before it is seen."""
        self._views = {name: view(desk) for name, view in views.items()}
        for name in views:
            self.add_mode(name, partial(self._views.__getitem__, name))

    @property
    def view(self) -> View:
        """The one that is seen, or that lies below the dialog."""
        return self._views[self.current_mode]

    async def action_show_view(self, name: str) -> None:
        """Change to this one; what was said last is said there."""
        if name == self.current_mode or name not in self._views:
            return
        before = self.view
        await self.switch_mode(name)
        self.view.take_over(before)

    async def action_next_view(self, by: int) -> None:
        """The next one, or the one before."""
        names = list(self._views)
        at = names.index(self.current_mode)
        await self.action_show_view(names[(at + by) % len(names)])

    def action_command_palette(self) -> None:
        """Every command, by its name; one that lies below a dialog is open already."""
        if not any(isinstance(each, Palette) for each in self.screen_stack):
            # Without a name: one of another view may be there, or one that is on its way out.
            self.push_screen(Palette())

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """The palette: every command of the table."""
        for command in self._keys.commands:
            said = spoken("Key {all_shown}. {help}", all_shown=command.all_shown, help=command.help)
            yield SystemCommand(
                _literally(command.title),
                _literally(said if command.all_shown else command.help),
                self._from_palette(command.action, command.area),
            )

    def _from_palette(self, action: str, area: Area) -> Callable[[], object]:
        owners = [name for name, view in self._views.items() if area in (view.AREA, *view.ALSO)]

        async def run() -> None:
            if owners and self.current_mode not in owners:
                await self.action_show_view(owners[0])
            await self.run_action(action, self.view)

        return run


def _literally(text: str) -> str:
    """A text for what reads markup: the name of a macro, or its lines, may look like some."""
    return plain(text).replace("[", "\\[")
