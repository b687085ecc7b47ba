"""A file that is run: read, looked through, turned into blocks, begun at a line."""

from fraese.program.program import Program, open_program
from fraese.program.resumption import Resumption

__all__ = ["Program", "Resumption", "open_program"]
