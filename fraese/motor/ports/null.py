"""A port with nothing on it: for measuring what a driver costs by itself."""

from typing import Final

#: All inputs at rest, bits 3 to 7.
_AT_REST: Final = 0xF8


class NullPort:
    """Takes every write; no input ever changes."""

    def write_data(self, value: int) -> None:
        """Goes nowhere."""

    def write_control(self, value: int) -> None:
        """Goes nowhere."""

    def read_status(self) -> int:
        """All inputs at rest."""
        return _AT_REST

    def close(self) -> None:
        """Nothing to give back."""
