"""Moves in millimetres to blocks in steps: path here, time law there."""
