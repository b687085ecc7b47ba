"""The keys: one table that feeds bindings, footer, help, command list, palette and every hint.

Rule 1: a key is one row, with the area in which it works. Nothing else in the UI names a key; a
        sentence that wants to name one asks ``KeyTable.said``.
Rule 2: the keys that work everywhere have priority: also while an input has the focus and while a
        dialog is open. Escape is the one to remember. Ctrl+C does the same and is a single byte,
        so that no terminal has to wait to see whether more follows.
Rule 3: keys that a plain terminal over SSH does not transmit are not used.

``table.py`` puts together what the other files have: ``everywhere.py`` and ``machine.py`` what is
always there, ``axes.py`` what depends on the machine's axes, the others a view or a dialog each.
"""

from fraese.ui.keyrows.row import Area, Row
from fraese.ui.keyrows.table import GROUPS, KeyTable

__all__ = ["GROUPS", "Area", "KeyTable", "Row"]
