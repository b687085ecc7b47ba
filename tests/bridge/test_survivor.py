"""A host that is killed, and what its device still knows: claim against the carriages."""

import random
import struct
from pathlib import Path

import pytest

from fraese.errors import PortError
from fraese.motor.bridge.codec import Status, hello
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.ledger import SIZE, FileLedger, book_in
from fraese.motor.bridge.survivor import ask, words_of
from fraese.motor.realtime.lastwords import LastWords
from fraese.motor.seams import Ended
from tests.bridge.device import reason_to_skip
from tests.bridge.dying import BOOT, TOKEN, killed_on_errands, left, until_killed
from tests.bridge.firmwaremill import CYCLES_PER_S, FirmwareBench
from tests.motor.workbench import line

needs_firmware = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())


def killed_in_a_line(bench: FirmwareBench, ledger: Path) -> None:
    def live(driver: BridgeDriver) -> None:
        driver.push(line(3000, -300))
        while True:
            driver.poll(0.1)

    until_killed(bench, ledger, live, bench.chip.avr.cycle + CYCLES_PER_S // 5)


def asked(bench: FirmwareBench, ledger: Path) -> LastWords | None:
    return ask(bench.open_line, bench.clock, left(ledger))


@needs_firmware
@pytest.mark.parametrize("wiring", ["smc", "x4step"])
def test_killed_at_any_moment_it_is_known_to_the_step(wiring: str, tmp_path: Path) -> None:
    chance = random.Random(wiring)
    bench = FirmwareBench(wiring, silence_s=0.5)
    for number in range(4):
        ledger, before = tmp_path / str(number), bench.carriages()
        killed_on_errands(bench, ledger, chance)
        bench.wait(chance.choice((0, 0.1, 1.0)))
        words = asked(bench, ledger)
        made = tuple(b - a for a, b in zip(before, bench.carriages(), strict=True))
        assert words is not None
        assert words.position_steps == made
        bench.twin.card.set_phases(words.phases)
    # Programs went on from there, without a jump of a rotor.
    assert bench.lost() == (0, 0, 0)


@needs_firmware
def test_a_device_that_fell_silent_says_why_and_one_in_motion_is_braked(tmp_path: Path) -> None:
    bench, ledger = FirmwareBench("smc", silence_s=0.5), tmp_path / "ledger"
    killed_in_a_line(bench, ledger)
    since_ns = bench.clock.now_ns()
    words = asked(bench, ledger)
    assert words is not None
    assert (words.token, words.ended, words.torn) == (TOKEN, Ended.NOT, frozenset())
    assert words.position_steps == tuple(map(round, bench.carriages()))
    assert bench.clock.now_ns() - since_ns < 500_000_000
    bench.wait(1.0)
    later = asked(bench, ledger)
    assert later is not None
    assert (later.position_steps, later.ended) == (words.position_steps, Ended.SILENCE)
    assert {line.closed for line in bench.lines[1:]} == {True}


@needs_firmware
@pytest.mark.parametrize("fault", ["reset", "greeted", "driven", "mute", "gone"])
def test_another_session_is_never_believed(fault: str, tmp_path: Path) -> None:
    bench, ledger = FirmwareBench("smc", silence_s=0.5), tmp_path / "ledger"
    killed_in_a_line(bench, ledger)
    bench.wait(1.0)
    if fault == "reset":
        bench.chip.avr.reset()
        bench.wait(0.05)
    elif fault == "greeted":
        bench.open_line().write(hello(left(ledger).session ^ 1))
        bench.wait(0.05)
    elif fault == "driven":
        other = bench.another_driver()
        other.push(line(50))
        while other.poll(0.1).running:
            pass
    elif fault == "mute":
        bench.chip.avr.set_host_baud(9600)
    else:
        bench.unplug()
    assert asked(bench, ledger) is None


@needs_firmware
def test_a_driver_that_finds_nobody_leaves_an_older_ledger_alone(tmp_path: Path) -> None:
    bench, path = FirmwareBench("smc"), tmp_path / "ledger"
    before = written(tmp_path)
    bench.chip.avr.set_host_baud(9600)
    file = path.open("r+b", buffering=0)
    with pytest.raises(PortError):
        bench.another_driver(ledger=FileLedger(file, TOKEN, BOOT))
    assert file.closed
    assert path.read_bytes() == before


def written(tmp_path: Path) -> bytes:
    """A ledger in which blocks have the numbers 1 to 600."""
    path = tmp_path / "ledger"
    with path.open("wb", buffering=0) as file:
        ledger = FileLedger(file, TOKEN, BOOT)
        ledger.begin(77, 8, (5, -5, 0), (1, 2, 3))
        for serial in range(1, 601):
            ledger.note(serial, (serial, 0, -1), serial, (0, serial, 0))
    return path.read_bytes()


def test_the_last_blocks_are_found_by_their_numbers(tmp_path: Path) -> None:
    book = book_in(written(tmp_path))
    assert book is not None
    assert (book.token, book.boot, book.session, book.table) == (TOKEN, BOOT, 77, 8)
    assert (book.counts, book.phases) == ((5, -5, 0), (1, 2, 3))
    entry = book.entry(600)
    assert entry is not None
    assert (entry.ticks, entry.steps, entry.start) == (600, (600, 0, -1), (0, 600, 0))
    assert book.entry(89) is not None
    assert (book.entry(88), book.entry(601), book.entry(0)) == (None, None, None)


def test_a_changed_byte_is_no_block_and_no_ledger(tmp_path: Path) -> None:
    sound = written(tmp_path)
    whole = book_in(sound)
    assert whole is not None
    entries = [whole.entry(serial) for serial in range(89, 601)]
    chance = random.Random(1)
    for at in (*range(128), *(chance.randrange(SIZE) for _ in range(60))):
        data = bytearray(sound)
        data[at] ^= 1 << chance.randrange(8)
        book = book_in(bytes(data))
        if book is None:
            continue
        assert (book.token, book.boot) == (TOKEN, BOOT)
        assert {book.entry(serial) for serial in range(89, 601)} <= {None, *entries}
    assert book_in(sound[:-1]) is None


def test_an_answer_that_cannot_be_is_none(tmp_path: Path) -> None:
    """More ticks than the block had, or phases that are not those of the count."""
    book = book_in(written(tmp_path))
    assert book is not None

    def words(done: int, phases: bytes, session: int = 77) -> LastWords | None:
        ack = struct.pack("<BHBBHBB", 1, session, 0, 0, 300, 0, 0)
        fields = [ack, 0, 0, 1, 600, done, 0, 600, 0, 0xF8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 256]
        return words_of(Status.parse(Status._FORMAT.pack(*fields, phases, 0)), book)

    # Counts (600, 600, -1) where (5, -5, 0) had the phases (1, 2, 3) of 8.
    right = bytes(((1 + 595) % 8, (2 + 605) % 8, (3 - 1) % 8, 0))
    known = words(600, right)
    assert known is not None
    assert known.position_steps == (600, 600, -1)
    assert words(600, bytes((right[0] ^ 1, *right[1:]))) is None
    assert words(600, right, session=78) is None
    # As many ticks too many as make no other phase.
    assert words(600 + 8 * 600, right) is None


def test_blocks_of_an_earlier_session_are_none(tmp_path: Path) -> None:
    path = tmp_path / "ledger"
    with path.open("wb", buffering=0) as file:
        ledger = FileLedger(file, TOKEN, BOOT)
        ledger.begin(77, 0, (0,), (0,))
        ledger.note(1, (9,), 9, (0,))
        ledger.begin(78, 0, (9,), (9,))
    book = book_in(path.read_bytes())
    assert book is not None
    assert book.entry(1) is None
    assert book.entry(0) == (0, 0, (0,), (9,))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no such device")
def test_a_full_disk_is_nobodys_fault() -> None:
    with open("/dev/full", "wb", buffering=0) as file:
        ledger = FileLedger(file, TOKEN, BOOT)
        ledger.begin(77, 0, (0,), (0,))
        ledger.note(1, (9,), 9, (0,))
        ledger.close()
