"""An Arduino's boot loader behind a serial port: enough of STK500v1 for avrdude (Atmel AVR061)."""

import os
import threading
import tty
from pathlib import Path
from typing import Final

_SYNC_END, _OK, _IN_SYNC = 0x20, b"\x10", b"\x14"
SIGNATURE: Final = bytes((0x1E, 0x95, 0x0F))
#: Bytes behind a command's own, before the end mark.
_FIXED: Final = {0x30: 0, 0x31: 0, 0x41: 1, 0x42: 20, 0x45: 5, 0x50: 0, 0x51: 0, 0x55: 2, 0x56: 4,
                 0x74: 3, 0x75: 0}  # fmt: skip
_PROGRAM: Final = 0x64
#: What STK500v2 says to its first word; the checksum is not looked at.
_SIGNED_ON: Final = b"\x1b\x01\x00\x0b\x0e\x01\x00\x08AVRISP_2\x00"


class BootLoader:
    """Answers on a pseudo-terminal.

    Args:
        signature: of its chip.
        speaks_v2: it answers to STK500v2's first word, and to nothing else.

    Attributes:
        port: its name.
        flash: what was written, by address.
        left: it was told to start what was written.
    """

    def __init__(self, signature: bytes = SIGNATURE, *, speaks_v2: bool = False) -> None:
        self._signature = signature
        self._speaks_v2 = speaks_v2
        self._ours, theirs = os.openpty()
        tty.setraw(theirs)
        self.port = os.ttyname(theirs)
        self._theirs = theirs
        self.flash: dict[int, int] = {}
        self.left = False
        self._address = 0
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self) -> "BootLoader":
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._theirs)
        os.close(self._ours)

    def _read(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            data += os.read(self._ours, count - len(data))
        return data

    def _serve(self) -> None:
        try:
            while True:
                command = self._read(1)[0]
                if self._speaks_v2:
                    if command == 0x1B and self._read(6)[4] == 1:
                        os.write(self._ours, _SIGNED_ON)
                elif command == _PROGRAM:
                    self._program()
                elif command in _FIXED:
                    words = self._read(_FIXED[command] + 1)
                    if words[-1] == _SYNC_END:
                        os.write(self._ours, _IN_SYNC + self._answer(command, words) + _OK)
        except OSError:
            return  # the port is gone

    def _program(self) -> None:
        high, low, _ = self._read(3)
        for offset, byte in enumerate(self._read(high << 8 | low)):
            self.flash[self._address + offset] = byte
        self._read(1)
        os.write(self._ours, _IN_SYNC + _OK)

    def _answer(self, command: int, words: bytes) -> bytes:
        if command == 0x55:
            self._address = 2 * (words[0] | words[1] << 8)
        elif command == 0x74:
            count = words[0] << 8 | words[1]
            return bytes(self.flash.get(self._address + n, 0xFF) for n in range(count))
        elif command == 0x75:
            return self._signature
        elif command == 0x51:
            self.left = True
        return {0x41: b"\x03", 0x56: b"\x00", 0x31: b"AVR ISP"}.get(command, b"")


def image_bytes(path: Path) -> dict[int, int]:
    """What an image in Intel HEX holds, by address."""
    held: dict[int, int] = {}
    for line in path.read_text("ascii").split():
        record = bytes.fromhex(line[1:])
        count, address, kind = record[0], record[1] << 8 | record[2], record[3]
        assert sum(record) & 0xFF == 0
        if kind == 0:
            held |= {address + n: byte for n, byte in enumerate(record[4 : 4 + count])}
    return held
