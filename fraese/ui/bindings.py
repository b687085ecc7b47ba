"""Rows of the key table become Textual's bindings."""

from collections.abc import Iterable

from textual.binding import Binding
from textual.dom import DOMNode

from fraese.ui.keyrows import Row


def bind(node: DOMNode, rows: Iterable[Row]) -> None:
    """Let these keys do something on an app or a screen; what they did there before is forgotten.

    Textual has a public place only for bindings that are known with the class; which keys there
    are here depends on the machine's axes.
    """
    for row in rows:
        for key in row.each:
            node._bindings.key_to_bindings[key] = [
                Binding(
                    key,
                    row.action,
                    row.footer or row.title,
                    show=bool(row.footer),
                    key_display=row.shown,
                    priority=row.priority,
                )
            ]
