"""Write to a port as fast as it goes: ``python -m tests.rigs.lpt.hammer PORT COUNT``."""

import sys

from tests.rigs.lpt.play import PORTS


def main(kind: str, count: int) -> None:
    """Count up on the data lines; print how many bytes were written."""
    port = PORTS[kind]()
    for number in range(count):
        port.write_data(number & 0xFF)
    port.close()
    print(count)  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
