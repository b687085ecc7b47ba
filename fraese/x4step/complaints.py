"""What a person is told whose program has only a number."""

import sys

from fraese.log import write
from fraese.phrases import shown


def complain(sentence: str) -> None:
    """Tell a person, who has only a number in their program."""
    write("x4step", "port", "error", sentence)
    sys.stderr.write(f"x4step: {shown(sentence)}\n")
