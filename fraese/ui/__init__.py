"""The Textual app. Sees the controller and its frozen facts, nothing lower."""

from fraese.ui.app import FraeseApp

__all__ = ["FraeseApp"]
