"""The Textual app. Sees the controller and its frozen facts, nothing lower."""
