"""The views: one row each. The first is there at the start."""

from typing import Final

from fraese.ui.views.machine import MachineView
from fraese.ui.views.view import View

VIEWS: Final[dict[str, type[View]]] = {
    "machine": MachineView,
}
