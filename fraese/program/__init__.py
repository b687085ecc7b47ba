"""A file that is run: read, looked through, turned into blocks, begun at a line."""

from fraese.program.program import Program, gone_on_with, open_program

__all__ = ["Program", "gone_on_with", "open_program"]
