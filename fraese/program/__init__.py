"""A file that is run: read, looked through, turned into blocks, begun at a line."""

from fraese.program.byhand import ByHand
from fraese.program.program import Program, open_program
from fraese.program.resumption import Resumption

__all__ = ["ByHand", "Program", "Resumption", "open_program"]
