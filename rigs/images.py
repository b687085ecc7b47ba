"""``python -m rigs.images``: the firmware's images that are installed with the program, built anew.

They lie in the tree, so that whoever installs it needs no compiler; a test compares them with a
fresh build, where the compiler is the one that made them.
"""

import shutil
import subprocess
from pathlib import Path
from typing import Final

from fraese.motor.bridge.boards import BOARDS, IMAGE_BAUD

ROOT: Final = Path(__file__).parents[1]
FIRMWARE: Final = ROOT / "firmware"
#: Beside the images: what made them.
MADE_WITH: Final = next(iter(BOARDS.values())).path.with_name("made-with.txt")


def images() -> dict[str, Path]:
    """Where each image lies, by the name of its board in the firmware's Makefile."""
    return {board.image: board.path for board in BOARDS.values()}


def compiler() -> str:
    """Which one is installed, in a line; empty: none."""
    if shutil.which("avr-gcc") is None:
        return ""
    said = subprocess.run(["avr-gcc", "--version"], capture_output=True, text=True, check=True)
    return said.stdout.splitlines()[0]


def built(board: str, folder: Path) -> str:
    """A fresh image, Intel HEX.

    Args:
        board: as in the firmware's Makefile.
        folder: in which it is built.
    """
    target = folder / board
    command = ["make", "-s", "-C", str(FIRMWARE), f"BOARD={board}", f"BAUD={IMAGE_BAUD}"]
    subprocess.run([*command, f"BUILD={target}"], check=True, capture_output=True)
    return (target / "fraese.hex").read_text("ascii").replace("\r\n", "\n")


def main() -> None:
    """Write them."""
    for board, path in images().items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(built(board, ROOT / ".rig-cache" / "images"), "ascii")
        print(path.relative_to(ROOT))
    MADE_WITH.write_text(compiler() + "\n", "utf-8")


if __name__ == "__main__":
    main()
