"""The app's keys as a machine's configuration has them: checked, and listed."""

from pathlib import Path
from typing import TYPE_CHECKING

from fraese.assembly import assemble
from fraese.cli import language
from fraese.cli.leaving import leave
from fraese.cli.options import ConfigOption
from fraese.cli.output import write
from fraese.config import Config
from fraese.config import file as configuration
from fraese.control.controller import Controller
from fraese.errors import ConfigError
from fraese.phrases import joined

if TYPE_CHECKING:
    from fraese.ui.keyrows import KeyTable
    from fraese.ui.macros import Macro


def table_of(controller: Controller, config: Config, named: Path | None) -> "KeyTable":
    """All keys, with what is changed in them.

    Args:
        controller: of the machine; the keys depend on its axes.
        config: what was read,
        named: and the file that was named; None: the one that is found.

    Raises:
        ConfigError: if the keys cannot be changed so.
    """
    # Textual takes a quarter of a second to import.
    from fraese.ui.keyrows import KeyTable
    from fraese.ui.keyrows.macros import macro_key
    from fraese.ui.shape import shape_of
    from fraese.ui.views import VIEWS

    try:
        mine = macros_of(config)
        given = {macro_key(at): each.key for at, each in enumerate(config.macros) if each.key}
        return KeyTable(shape_of(controller), VIEWS, {**config.keys, **given}, mine)
    except ConfigError as error:
        place = str(named or configuration.find_file() or configuration.FILE_NAME)
        raise ConfigError(joined(": ", (place, str(error)))) from error


def macros_of(config: Config) -> "tuple[Macro, ...]":
    """The macros of a configuration, for the app."""
    from fraese.ui.macros import Macro

    return tuple(Macro(each.name, each.lines, each.file, each.confirm) for each in config.macros)


def keys(config: ConfigOption = None) -> None:
    """List the app's actions by the names that [keys] knows, with their keys."""

    def go() -> int:
        settings = language.load(config)
        plant = assemble(settings, at_desk=True)
        plant.controller.close()
        rows = table_of(plant.controller, settings, config).commands
        for row in rows:
            write(f"{row.name:<30} {row.all_shown:<12} {row.help}\n")
        return 0

    leave(go)
