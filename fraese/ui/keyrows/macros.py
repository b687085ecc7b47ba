"""A row for each macro; its key comes from the configuration."""

from collections.abc import Sequence

from fraese.phrases import phrase
from fraese.ui.keyrows.row import Area, Row
from fraese.ui.macros import Macro


def macro_rows(macros: Sequence[Macro]) -> list[Row]:
    """In the order of the configuration; without a key until it is given one."""
    return [
        Row(
            Area.MACHINE, "", "", f"macro({at})", macro.name,
            phrase("Run {what}.", what=macro.file or " ".join(macro.lines)[:60]), "Macros",
            given_name=macro_key(at),
        )
        for at, macro in enumerate(macros)
    ]  # fmt: skip


def macro_key(at: int) -> str:
    """The place in the configuration that says its key."""
    return f"macros.{at}.key"
