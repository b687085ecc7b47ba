"""The help page, made from the key table."""

from typing import Final

from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Static

from fraese.phrases import shown, spoken
from fraese.plaintext import plain
from fraese.ui.dialogs.page import Page
from fraese.ui.keyrows import GROUPS, Area
from fraese.ui.keyrows.everywhere import PALETTE
from fraese.ui.widgets.fact import Fact

#: What each is about, in the order in which one meets them.
_DIALOGS: Final = (
    (spoken("Go to"), Area.GO_TO),
    (spoken("Type a line"), Area.TYPED),
    (spoken("Jog rate"), Area.JOG_RATE),
    (spoken("Set position"), Area.SET),
    (spoken("Work offsets"), Area.OFFSETS),
    (spoken("Tools"), Area.TOOLS),
    (spoken("Probe"), Area.PROBE),
    (spoken("Reference"), Area.REFERENCE),
    (spoken("Open a program"), Area.OPEN),
    (spoken("Before a start"), Area.START),
    (spoken("The job asks"), Area.ASK),
    (spoken("Go on with a program"), Area.RESUME),
    (spoken("After a crash"), Area.CRASH),
    (spoken("Switch test"), Area.SWITCHES),
    (spoken("Held key"), Area.HELD_KEY),
    (spoken("Questions"), Area.FORM),
    (spoken("Settings"), Area.SETTING),
)


class HelpPage(Page[None]):
    """Keys by group."""

    AREA = Area.HELP
    COVERS = True

    def compose(self) -> ComposeResult:
        """Heading, groups, notes."""
        with Vertical(classes="dialog wide"):
            yield Fact(spoken("Keys"), classes="dialog-title")
            with VerticalScroll():
                there = {command.group for command in self.keys.commands}
                for group in (group for group in GROUPS if shown(group) in there):
                    yield Fact(group, classes="help-heading")
                    yield Static(self._group(group), classes="help-group")
                yield Fact(spoken("In dialogs"), classes="help-heading")
                yield Static(self._dialogs(), classes="help-group")
                yield Static("\n\n".join(self.keys.notes()), classes="help-notes", markup=False)
            palette = spoken("Every command is also in the palette: {said}.", said=PALETTE.said)
            yield Fact(f"{palette}   {self.keys.hint(self.AREA)}", classes="hint")

    def _group(self, group: str) -> Table:
        table = Table.grid(padding=(0, 2))
        table.add_column(justify="right", min_width=5, no_wrap=True)
        table.add_column()
        for command in self.keys.commands:
            if command.group == shown(group):
                words = plain(f"{command.title}: {command.help}")
                table.add_row(Text(command.all_shown, "bold"), Text(words))
        return table

    def _dialogs(self) -> Table:
        table = Table.grid(padding=(0, 2))
        table.add_column(max_width=24)
        table.add_column()
        for name, area in _DIALOGS:
            table.add_row(Text(name, "bold"), Text(self.keys.hint(area)))
        return table
