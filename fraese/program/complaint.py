"""What is wrong with a program, and where."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Complaint:
    """Something wrong, and the line; 0 where no line applies."""

    line: int
    message: str
