"""One key of the configuration: what it means, its value typed and checked meanwhile."""

from collections.abc import Callable
from typing import Any

from textual import on
from textual.app import ComposeResult
from textual.widgets import Button, Input

from fraese.errors import FraeseError
from fraese.phrases import shown, spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.settings import Setting
from fraese.ui.widgets.fact import Flowing

_LONGEST = 400


def bounds_words(setting: Setting) -> str:
    """What it may be, what it is by default, and from when on it counts."""
    words = [
        shown(setting.bounds),
        spoken("one of {choices}", choices=", ".join(setting.choices)) if setting.choices else "",
        spoken("by default {default}", default=setting.default or spoken("nothing")),
        spoken("counts at once") if setting.at_once else spoken("counts from the next start"),
    ]
    text = "; ".join(filter(None, words)) + "."
    return text[0].upper() + text[1:]


class SettingDialog(Dialog[Any]):
    """The result is what was written, or None.

    Args:
        keys: the table.
        setting: the key.
        path: of the file.
        check: raises if a value would not do.
        write: writes it; what it raises is said, and the dialog stays.
    """

    AREA = Area.SETTING
    YES = spoken("Write")

    def __init__(
        self,
        keys: KeyTable,
        setting: Setting,
        path: str,
        check: Callable[[str], object],
        write: Callable[[str], object],
    ) -> None:
        super().__init__(keys)
        self.HEADING = setting.key
        self._setting = setting
        self._path = path
        self._check = check
        self._write = write

    def inner(self) -> ComposeResult:
        """What it means, and what it is."""
        setting = self._setting
        yield Flowing(
            f"{shown(setting.sentence)} {bounds_words(setting)}".strip(), classes="question"
        )
        value = setting.value
        # A text is typed without its quotes, unless there are others in it.
        if setting.is_text and value[:1] == '"' and "\\" not in value and '"' not in value[1:-1]:
            value = value[1:-1]
        yield Input(value, id="value", max_length=_LONGEST)
        yield Flowing(spoken("in {path}; comments stay", path=self._path), classes="question more")

    def on_mount(self) -> None:
        """Type at once."""
        self.query_one("#value", Input).focus()

    def hints(self) -> str:
        """Without other choices, where there are none."""
        rows = [row for row in self.keys.of(self.AREA) if row.hint]
        if self._setting.choices:
            return self.keys.hint(self.AREA)
        return "   ".join(
            f"{row.shown}: {row.hint}" for row in rows if not row.action.startswith("choice")
        )

    @property
    def typed(self) -> str:
        """What stands there."""
        return self.query_one("#value", Input).value

    @on(Input.Changed, "#value")
    def _changed(self) -> None:
        self._fits()

    def _fits(self) -> bool:
        try:
            self._check(self.typed)
        except FraeseError as error:
            self.complain(str(error))
            return False
        self.complain("")
        return True

    def action_choice(self, by: int) -> None:
        """The next of those that there are."""
        choices = list(self._setting.choices)
        if choices:
            typed = self.typed.strip().strip("\"'")
            at = choices.index(typed) + by if typed in choices else 0
            line = self.query_one("#value", Input)
            line.value = choices[at % len(choices)]
            line.cursor_position = len(line.value)

    def action_accept(self) -> None:
        """Write it, or say why not."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        if not self._fits():
            return
        try:
            written = self._write(self.typed)
        except FraeseError as error:
            self.complain(str(error))
        else:
            self.dismiss(written)
