"""The configuration: every key with its value and its sentence; one is changed at a time."""

from collections.abc import Sequence
from typing import Any

from textual.app import ComposeResult

from fraese.control.controller import Controller
from fraese.control.state import MachineState, Status
from fraese.errors import FraeseError
from fraese.phrases import shown, spoken
from fraese.ui.dialogs.confirm import ConfirmDialog
from fraese.ui.dialogs.form import Field, FormDialog, Words
from fraese.ui.dialogs.setting import SettingDialog, bounds_words
from fraese.ui.keyrows import Area
from fraese.ui.settings import Setting, SettingsDesk
from fraese.ui.views.view import BUSY, Desk, View
from fraese.ui.widgets.fact import Fact, Flowing
from fraese.ui.widgets.settinglist import SettingList


class SettingsView(View):
    """Looks at the file whenever it is seen, and changes one key of it."""

    AREA = Area.SETTINGS
    NAME = "settings"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._all: Sequence[Setting] = ()
        self._word = ""
        self._heading = Fact("", id="settings-heading")
        self._list = SettingList()
        self._detail = Flowing("", id="settings-detail")

    def inner(self) -> ComposeResult:
        """Which file, its keys, and what there is to be known of one."""
        yield self._heading
        yield self._list
        yield self._detail
        rows = [row for row in self.desk.keys.of(self.AREA) if row.footer]
        yield Fact("   ".join(f"{row.shown}: {row.footer}" for row in rows), id="settings-keys")

    def on_mount(self) -> None:
        """It is seen for the first time."""
        self.read()

    def take_over(self, before: View) -> None:
        """Somebody may have changed the file meanwhile."""
        super().take_over(before)
        if self.is_mounted:
            self.read()

    def show_inner(self, state: MachineState) -> None:
        """How the machine stands is above."""

    # --- what is shown ---------------------------------------------------------------------------

    def read(self) -> None:
        """Show what the file says now."""
        settings = self.desk.settings
        if settings is None:
            self._heading.show(spoken("There is no configuration file here."))
            return
        try:
            self._all = tuple(settings.read())
        except FraeseError as error:
            self._all = ()
            self.refuse(str(error))
        self._show_list(settings)

    def _show_list(self, settings: SettingsDesk) -> None:
        found = [
            each
            for each in self._all
            if self._word in f"{each.key} {each.sentence} {shown(each.sentence)}".lower()
        ]
        self._list.load(found)
        own = sum(each.value != each.default for each in self._all)
        words = (
            [settings.path]
            if settings.is_there
            else [spoken("{path} (made when needed)", path=settings.path)]
        )
        words.append(spoken("{count} keys, {own} not as by default", count=len(self._all), own=own))
        if self._word:
            words.append(spoken("{count} with “{word}”", count=len(found), word=self._word))
        self._heading.show(" · ".join(words))
        self.on_setting_list_looked()

    def on_setting_list_looked(self) -> None:
        """What is known of the key."""
        setting = self._list.here
        if setting is None:
            self._detail.show("")
            return
        value = setting.value or spoken("nothing")
        self._detail.show(
            f"{setting.key} = {value}. {shown(setting.sentence)} {bounds_words(setting)}".replace(
                "  ", " "
            )
        )

    # --- commands --------------------------------------------------------------------------------

    def action_setting(self, by: int) -> None:
        """Another key."""
        self._list.go(by)

    def action_table(self, by: int) -> None:
        """Another table."""
        self._list.go_to_table(by)

    def action_acknowledge(self) -> None:
        """Where there is nothing to acknowledge: edit."""
        if self.state.status is Status.ERROR or self.state.question:
            super().action_acknowledge()
        else:
            self.action_edit()

    def action_edit(self) -> None:
        """Type another value."""
        setting = self._list.here
        if setting is not None and self._may_change(setting):
            self._edit(setting)

    def _may_change(self, setting: Setting) -> bool:
        """What counts at once is not changed under a job."""
        if setting.at_once and self.desk.link.moving:
            self.refuse(BUSY)
            return False
        return self.desk.settings is not None

    def _edit(self, setting: Setting) -> None:
        settings = self.desk.settings
        assert settings is not None
        dialog = SettingDialog(
            self.desk.keys,
            setting,
            settings.path,
            lambda typed: settings.check(setting, typed),
            lambda typed: settings.write(setting, typed),
        )
        self.app.push_screen(dialog, lambda written: self._written(setting, written))

    def _written(self, setting: Setting, written: Any) -> None:
        self.read()
        settings = self.desk.settings
        if written is None or settings is None:
            return
        now = next((each for each in self._all if each.key == setting.key), None)
        is_now = spoken(
            "{key} is {value}",
            key=setting.key,
            value=now.value if now and now.value else spoken("by default"),
        )
        if not setting.at_once:
            self.note(
                spoken(
                    "{is_now}, from the next start on; written to {path}.",
                    is_now=is_now,
                    path=settings.path,
                )
            )
            return

        def adopt(controller: Controller) -> None:
            try:
                settings.adopt(controller, written)
            except FraeseError as error:
                self.call_later(self.seen.note, f"{is_now}. {shown(str(error))}", True)
            else:
                self.call_later(
                    self.seen.note,
                    spoken("{is_now} now; written to {path}.", is_now=is_now, path=settings.path),
                )

        if not self.desk.link.order_of(adopt):
            self.note(
                spoken("{is_now}, from the next start on: the machine runs.", is_now=is_now),
                warning=True,
            )

    def action_default(self) -> None:
        """Ask, and take it out of the file."""
        setting, settings = self._list.here, self.desk.settings
        if setting is None or settings is None or not self._may_change(setting):
            return
        if not setting.given:
            self.refuse(
                spoken("{key} is by default already: the file does not say it.", key=setting.key)
            )
            return
        dialog = ConfirmDialog(
            self.desk.keys,
            spoken("{key} by default", key=setting.key),
            spoken(
                "It is taken out of {path}; by default it is {default}.",
                path=settings.path,
                default=setting.default or spoken("nothing"),
            ),
            spoken("Take it out"),
        )
        self.app.push_screen(dialog, lambda meant: self._take_out(setting) if meant else None)

    def _take_out(self, setting: Setting) -> None:
        settings = self.desk.settings
        assert settings is not None
        try:
            written = settings.write(setting, None)
        except FraeseError as error:
            self.read()
            self.refuse(str(error))
        else:
            self._written(setting, written)

    def action_add(self) -> None:
        """A key that the list does not have."""
        settings = self.desk.settings
        if settings is None:
            return
        dialog = FormDialog(
            self.desk.keys,
            spoken("Add a key"),
            spoken("Its whole name, such as tools.3.length_mm; its value comes next."),
            [Field("key", spoken("key"))],
            yes=spoken("Next"),
        )
        self.app.push_screen(dialog, self._add)

    def _add(self, words: Words | None) -> None:
        settings = self.desk.settings
        if not words or not words["key"] or settings is None:
            return
        known = {each.key: each for each in self._all}
        setting = known.get(words["key"]) or settings.other(words["key"])
        if self._may_change(setting):
            self._edit(setting)

    def action_find(self) -> None:
        """Ask for a word."""
        dialog = FormDialog(
            self.desk.keys,
            spoken("Find keys"),
            spoken("Only keys with this word in their name or sentence are shown; empty: all."),
            [Field("word", spoken("word"), self._word)],
            yes=spoken("Find"),
        )
        self.app.push_screen(dialog, self._find)

    def _find(self, words: Words | None) -> None:
        if words is not None and self.desk.settings is not None:
            self._word = words["word"].lower()
            self._show_list(self.desk.settings)
