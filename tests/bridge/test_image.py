"""What the linked image must be, whatever was compiled or came from a library."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

import pytest

from rigs.avr.build import DATA_SPACE
from tests.bridge.device import image, reason_to_skip

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

INTERRUPT: Final = {"uno": "__vector_11", "mega": "__vector_17"}
BOARDS: Final = tuple(INTERRUPT)
#: What the larger boot loader of an Uno or Nano leaves of 32 KB.
FLASH_BYTES: Final = 30 * 1024
#: The boot loader's word in r2, read before anything else runs.
ALLOWED: Final = {("look_at_reset", "mov")}


class Line(NamedTuple):
    """An instruction of a disassembly."""

    address: int
    symbol: str
    mnemonic: str
    operands: str


def lines(listing: str) -> Iterator[Line]:
    """The instructions that `avr-objdump -d` lists."""
    symbol = ""
    for text in listing.splitlines():
        if title := re.match(r"[0-9a-f]+ <(.*)>:", text):
            symbol = title[1]
        elif found := re.match(r" *([0-9a-f]+):\t[0-9a-f ]+\t(\w+)\t?([^;]*)", text):
            yield Line(int(found[1], 16), symbol, found[2], found[3].strip())


def touches_reserved(line: Line) -> bool:
    """It names one of r2 to r15, as a register or by its address."""
    if re.search(r"\br([2-9]|1[0-5])\b", line.operands):
        return True
    if line.mnemonic not in ("lds", "sts"):
        return False
    address = re.search(r"0x[0-9A-Fa-f]+", line.operands)
    return address is not None and 2 <= int(address[0], 16) <= 15


def output(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def symbols(elf: Path, kind: str) -> dict[str, range]:
    """Addresses in flash of all functions (FUNC) or tables (OBJECT) that have a size."""
    found: dict[str, range] = {}
    for row in output("avr-readelf", "-sW", str(elf)).splitlines():
        match row.split():
            case [_, address, size, type_, _, _, _, name] if type_ == kind:
                begin = int(address, 16)
                if begin < DATA_SPACE:
                    found[name] = range(begin, begin + int(size, 0))
    return found


def instructions(elf: Path) -> list[Line]:
    """All of an image: what stands in its flash and is no table."""
    tables = symbols(elf, "OBJECT").values()
    listing = lines(output("avr-objdump", "-d", str(elf)))
    return [line for line in listing if not any(line.address in table for table in tables)]


@pytest.mark.parametrize("board", BOARDS)
def test_registers_of_the_interrupt_are_left_alone(board: str) -> None:
    """r2 to r15 keep what was interrupted: nobody else names them, C or library."""
    elf = image(board_name=board)
    own = symbols(elf, "FUNC")[INTERRUPT[board]]
    listing = instructions(elf)
    assert len(listing) > 5_000
    strangers = [
        line
        for line in listing
        if touches_reserved(line)
        and line.address not in own
        and (line.symbol, line.mnemonic) not in ALLOWED
    ]
    assert not strangers


@pytest.mark.parametrize("board", BOARDS)
def test_the_interrupt_writes_them_once(board: str) -> None:
    """Saved at its entry, read where it ends."""
    elf = image(board_name=board)
    own = symbols(elf, "FUNC")[INTERRUPT[board]]
    touching = [
        line for line in instructions(elf) if line.address in own and touches_reserved(line)
    ]
    saved = {f"r{n}" for n in range(2, 16, 2)}
    assert {line.mnemonic for line in touching} == {"movw"}
    written = [line.operands.split(", ")[0] for line in touching]
    assert sorted(name for name in written if name in saved) == sorted(saved)
    assert len(touching) == 2 * len(saved)


@pytest.mark.parametrize(
    ("text", "touches"),
    [
        ("     10e:\t1c 01       \tmovw\tr2, r24", True),
        ("     10e:\tff 90       \tpop\tr15", True),
        ("     10e:\t8f 2d       \tmov\tr24, r15", True),
        ("     10e:\t80 93 05 00 \tsts\t0x0005, r24\t; 0x800005", True),
        ("     10e:\t80 93 05 01 \tsts\t0x0105, r24\t; 0x800105 <tracks+0x5>", False),
        ("     10e:\t12 e0       \tldi\tr17, 0x02\t; 2", False),
        ("     10e:\t01 9f       \tmul\tr16, r17", False),
        ("     10e:\t08 95       \tret", False),
    ],
)
def test_touching_is_seen(text: str, touches: bool) -> None:
    assert [touches_reserved(line) for line in lines(text)] == [touches]


def test_it_fits_beside_the_larger_boot_loader() -> None:
    text, data = output("avr-size", str(image())).splitlines()[1].split()[:2]
    assert int(text) + int(data) <= FLASH_BYTES
