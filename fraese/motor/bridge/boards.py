"""Boards that the bridge's firmware is built for, and how it is put on them.

    board   chip         boot loader speaks       image
    uno     ATmega328P   STK500v1, 115200 baud    images/uno.hex
    nano    likewise     likewise; an old one at 57600
    mega    ATmega2560   STK500v2, 115200 baud    images/mega.hex

Numbers of USB devices and of boot loaders are those of Arduino's ``boards.txt``. Boards with a
converter (FTDI, CH340) do not say what they are: their boot loaders are greeted in turn. Nothing
goes wrong by that: one of another chip does not answer, and avrdude reads the chip's signature
before it writes.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, NamedTuple

#: Images for this rate of the line, which is the configuration's default, too.
IMAGE_BAUD: Final = 250_000

_IMAGES: Final = Path(__file__).parent / "images"


class Board(NamedTuple):
    """One kind of board.

    Attributes:
        title: for people.
        image: name of its image, and of the board in ``firmware/Makefile``.
        part: the chip, as avrdude calls it.
        programmer: what its boot loader speaks, likewise.
        bauds: rates of its boot loaders, the usual one first.
    """

    title: str
    image: str
    part: str
    programmer: str
    bauds: tuple[int, ...]

    @property
    def path(self) -> Path:
        """Its image, Intel HEX."""
        return _IMAGES / f"{self.image}.hex"


BOARDS: Final[Mapping[str, Board]] = {
    "uno": Board("Arduino Uno", "uno", "atmega328p", "arduino", (115_200,)),
    "nano": Board("Arduino Nano", "uno", "atmega328p", "arduino", (115_200, 57_600)),
    "mega": Board("Arduino Mega 2560", "mega", "atmega2560", "wiring", (115_200,)),
}

#: What is tried where nothing says which board it is: of the Uno a Nano is no other, but slower.
UNKNOWN: Final = ("nano", "mega")

#: Vendor and product of boards that say what they are.
_BY_USB: Final[Mapping[tuple[int, int], str]] = {
    (vendor, product): board
    for board, ids in {
        "uno": {0x2341: (0x0001, 0x0043, 0x0243), 0x2A03: (0x0043,)},
        "mega": {0x2341: (0x0010, 0x0042, 0x0210, 0x0242), 0x2A03: (0x0010, 0x0042)},
    }.items()
    for vendor, products in ids.items()
    for product in products
}


class Try(NamedTuple):
    """One attempt to write a board.

    Attributes:
        board: which it is taken for.
        baud: of its boot loader.
    """

    board: Board
    baud: int

    def command(self, device: str, avrdude: str = "avrdude") -> list[str]:
        """The command line that writes it, without erasing the chip, which boot loaders do not do.

        Args:
            device: its serial port.
            avrdude: the program.
        """
        board = self.board
        what = f"flash:w:{board.path}:i"
        named = ["-p", board.part, "-c", board.programmer, "-P", device, "-b", str(self.baud)]
        return [avrdude, *named, "-D", "-U", what]


def boards_of(vid: int | None, pid: int | None) -> tuple[str, ...]:
    """Names of the boards that a USB device may be."""
    known = None if vid is None or pid is None else _BY_USB.get((vid, pid))
    return UNKNOWN if known is None else (known,)


def tries_of(names: Sequence[str]) -> tuple[Try, ...]:
    """Attempts for these boards, in turn."""
    return tuple(Try(BOARDS[name], baud) for name in names for baud in BOARDS[name].bauds)
