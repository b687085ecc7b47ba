"""A port that leads nowhere: for measuring what the steps cost without it."""

from typing import Final

#: All inputs at rest: bits 3 to 7 read 1.
_INPUTS_AT_REST: Final = 0xF8


class NullPort:
    """Takes every write; its inputs are at rest."""

    def write_data(self, value: int) -> None:
        """Nowhere."""

    def write_control(self, value: int) -> None:
        """Nowhere."""

    def read_status(self) -> int:
        """At rest."""
        return _INPUTS_AT_REST

    def close(self) -> None:
        """Nothing to give back."""
