"""The views, in the order in which they follow each other; the first is there at the start."""

from typing import Final

from fraese.ui.views.bench import BenchView
from fraese.ui.views.calibrate import CalibrateView
from fraese.ui.views.log import LogView
from fraese.ui.views.machine import MachineView
from fraese.ui.views.program import ProgramView
from fraese.ui.views.settings import SettingsView
from fraese.ui.views.view import View

VIEWS: Final[dict[str, type[View]]] = {
    view.NAME: view
    for view in (MachineView, ProgramView, CalibrateView, BenchView, LogView, SettingsView)
}
