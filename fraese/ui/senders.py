"""What the app expects of who lets other programs in; handed in by the composition root."""

from typing import Protocol


class Senders(Protocol):
    """Other programs that drive the machine while the app is there."""

    def start(self) -> None:
        """Let them in."""

    def close(self) -> None:
        """Show out who is there; what moves for him brakes. Safe to call twice."""

    def look(self) -> None:
        """See to what he wants; at standstill, in the machine's thread."""

    def between(self) -> None:
        """The same between two rounds of a job."""

    def take(self, *, out: bool) -> None:
        """Take over, or give the machine back; from any thread."""
