"""The configuration file as the app shows and changes it: its keys, the app's keys, the machine."""

from pathlib import Path

from fraese.cli.appkeys import table_of
from fraese.config import Config
from fraese.config.edit import as_toml
from fraese.config.settings import Setting, SettingsFile
from fraese.control.adopting import adopt, is_at_once
from fraese.control.controller import Controller


class AppSettings(SettingsFile):
    """The file, and what the app and the machine say to it.

    Args:
        named: by the user; None: the one that is found.
        controller: of the machine.
    """

    def __init__(self, named: Path | None, controller: Controller) -> None:
        super().__init__(
            named,
            is_at_once=is_at_once,
            also=lambda config: table_of(controller, config, named),
            more=self._keys,
        )
        self._controller = controller
        self._named = named

    def _keys(self, config: Config) -> tuple[Setting, ...]:
        """A setting for every action whose key may be changed."""
        usual = table_of(self._controller, Config(), self._named).changeable
        rows = table_of(self._controller, config, self._named).changeable
        # Macros have their keys in tables of their own.
        now = [row for row in rows if not row.action.startswith("macro(")]
        return tuple(
            Setting(
                f"keys.{row.name}",
                row.help,
                value=as_toml(row.each),
                default=as_toml(before.each),
                given=row.name in config.keys,
            )
            for row, before in zip(now, usual, strict=True)
        )

    def adopt(self, controller: Controller, written: Config) -> None:
        """Let what counts at once be in force; in the machine's thread.

        Raises:
            StateError: if it cannot be now.
        """
        adopt(controller, written)
