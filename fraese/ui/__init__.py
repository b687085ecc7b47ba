"""The Textual app. Sees the controller and its frozen facts, nothing lower."""

import os

# How long a lone Escape waits to see whether it begins a longer sequence, ms. It stops the
# machine, so it waits less than Textual's 100; a sequence torn apart on the way would stop too.
# Textual looks whether the time is over ten times a second only: 100 ms in all, not 200.
os.environ.setdefault("ESCDELAY", "20")

from fraese.ui.app import FraeseApp

__all__ = ["FraeseApp"]
