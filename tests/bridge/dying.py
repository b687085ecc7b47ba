"""A host that is killed: from some cycle on it does nothing more; a write may end in the middle."""

import random
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.ledger import Book, FileLedger, book_in
from tests.bridge.firmwaremill import CYCLES_PER_S, ChipLine, FirmwareBench
from tests.motor.workbench import line

TOKEN = b"the host's token"
BOOT = bytes(range(16))


class Killed(BaseException):
    """No handler of the program sees this."""


class DyingLine(ChipLine):
    """A line of a program that is killed while it reads or writes.

    Args:
        bench: the chip at its other end.
        at_cycle: when.
        last_bytes: so many of the write that comes then still go.
    """

    def __init__(self, bench: FirmwareBench, at_cycle: int, last_bytes: int) -> None:
        super().__init__(bench.chip)
        self._avr, self._at_cycle, self._last_bytes = bench.chip.avr, at_cycle, last_bytes

    def read(self, timeout_s: float) -> bytes:
        data = super().read(timeout_s)
        if self._avr.cycle >= self._at_cycle and not self._last_bytes:
            raise Killed
        return data

    def write(self, data: bytes) -> None:
        if self._avr.cycle < self._at_cycle:
            super().write(data)
            return
        super().write(data[: self._last_bytes])
        raise Killed


def until_killed(
    bench: FirmwareBench,
    ledger: Path,
    live: Callable[[BridgeDriver], None],
    at_cycle: int,
    last_bytes: int = 0,
) -> None:
    """A host that writes a ledger, and what it does till its end.

    Args:
        bench: what it drives.
        ledger: where it writes.
        live: does it, for ever.
        at_cycle, last_bytes: see ``DyingLine``.
    """
    with ledger.open("wb", buffering=0) as file, suppress(Killed):
        written = FileLedger(file, TOKEN, BOOT)
        live(bench.another_driver(lambda: DyingLine(bench, at_cycle, last_bytes), written))
        raise AssertionError("it outlived its end")


def left(ledger: Path) -> Book:
    """What a killed host wrote down."""
    book = book_in(ledger.read_bytes())
    assert book is not None
    return book


def errands(chance: random.Random, driver: BridgeDriver) -> None:
    """Lines here and there, for ever; now and then braked, stopped, or at rest."""
    while True:
        for _ in range(chance.randint(1, 30)):
            driver.push(line(*(chance.randint(-60, 60) for _ in range(3))))
        driver.poll(chance.uniform(0, 0.15))
        if chance.randrange(4):
            continue
        act = chance.choice((driver.brake, driver.stop, lambda: None))
        act()
        while driver.poll(0.01).running:
            pass
        driver.flush()


def killed_on_errands(bench: FirmwareBench, ledger: Path, chance: random.Random) -> None:
    at_cycle = bench.chip.avr.cycle + round(chance.uniform(0.05, 0.8) * CYCLES_PER_S)
    last_bytes = chance.choice((0, 0, 1, 7, 30))
    until_killed(bench, ledger, lambda driver: errands(chance, driver), at_cycle, last_bytes)
