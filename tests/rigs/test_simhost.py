"""The simulated ATmega328P behind a serial port, as a client of that port sees it."""

import termios
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import serial

from rigs.avr.board import CONTROL, DATA, resets
from rigs.avr.build import RigError, firmware, missing
from rigs.avr.host import SimHost
from tests.rigs.bench import FIRMWARES

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

BAUD = 250_000
PATIENCE_S = 10.0
Start = Callable[..., SimHost]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts a host with the echo firmware; all of them end with the test."""
    running: list[SimHost] = []

    def started(*options: str) -> SimHost:
        host = SimHost(firmware(FIRMWARES / "echo.c"), tmp_path, options)
        running.append(host)
        return host

    yield started
    for host in running:
        host.stop()


def opened(host: SimHost, baud: int = BAUD) -> serial.Serial:
    """A client, whose opening has reset the AVR."""
    client = serial.Serial(host.port, baud, timeout=PATIENCE_S)
    until(lambda: host.has_client)
    return client


def until(done: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < deadline_s, "nothing happened"
        time.sleep(0.002)


def after(host: SimHost, cycles: int) -> None:
    """Lets simulated time go on."""
    end_cycle = host.cycle + cycles
    until(lambda: host.cycle > end_cycle)


def test_bytes_go_there_and_back(start: Start) -> None:
    with opened(start()) as client:
        client.write(bytes(range(200)))
        assert client.read(200) == bytes(range(200))


def test_opening_the_port_resets_the_avr(start: Start) -> None:
    host = start()
    with opened(host):
        pass
    until(lambda: not host.has_client)
    with opened(host):
        pass
    host.stop()
    assert [cause for _, cause in resets(host.events())] == [0x01, 0x02, 0x02]


def test_opening_the_port_resets_nothing_where_dtr_is_cut(start: Start) -> None:
    host = start("--keep-running")
    with opened(host):
        pass
    host.stop()
    assert [cause for _, cause in resets(host.events())] == [0x01]


def test_opening_the_port_resets_nothing_where_the_last_client_did_not_hang_up(
    start: Start,
) -> None:
    host = start()
    with opened(host) as client:
        settings = termios.tcgetattr(client.fileno())
        settings[2] &= ~termios.HUPCL
        termios.tcsetattr(client.fileno(), termios.TCSANOW, settings)
    until(lambda: not host.has_client)
    with opened(host):
        pass
    host.stop()
    assert [cause for _, cause in resets(host.events())] == [0x01, 0x02]


def test_a_boot_loader_swallows_what_comes_too_early(start: Start) -> None:
    with opened(start("--boot-ms", "300")) as client:
        client.write(b"early")
        client.timeout = 0.05
        answers: list[int] = []
        while not answers:
            client.write(b"?")
            answers += client.read(1)
        assert bytes(answers) == b"?"


def test_at_the_wrong_baud_rate_nothing_is_understood(start: Start) -> None:
    host = start()
    with opened(host, 115_200) as client:
        client.write(b"hello hello")
        client.timeout = 0.2
        assert b"hello" not in client.read(64)
    assert "framing errors 0" not in host.stop()


def test_an_unplugged_client_notices_and_the_avr_runs_on(start: Start) -> None:
    host = start()
    with opened(host) as client:
        client.write(b"x")
        assert client.read(1) == b"x"
        host.unplug()
        with pytest.raises((serial.SerialException, OSError)):
            client.read(1)
    after(host, 100_000)
    host.plug_in()
    with opened(host) as client:
        client.write(b"y")
        assert client.read(1) == b"y"


def test_the_plug_is_pulled_at_the_given_time(start: Start) -> None:
    host = start("--unplug-after", "0.05")
    until(lambda: not Path(host.port).is_symlink())
    assert host.cycle >= 0.05 * 16e6 - 1_600


def stands_still(host: SimHost) -> int:
    """Wait until time does not pass any more; the cycle."""
    readings = [-1]
    while len(set(readings[-20:])) > 1 or len(readings) < 20:
        readings.append(host.cycle)
        time.sleep(0.002)
    return readings[-1]


def test_time_stands_still_while_held(start: Start) -> None:
    host = start("--speed", "0")
    until(lambda: host.cycle > 0)
    host.hold(True)
    stood = stands_still(host)
    assert stood > 0
    host.hold(False)
    until(lambda: host.cycle > stood)


def test_time_waits_where_it_is_told_to(start: Start) -> None:
    host = start("--speed", "0")
    host.wait_at(host.cycle + 16_000)
    stood = stands_still(host)
    host.wait_at(stood + 16_000)
    until(lambda: host.cycle >= stood + 16_000)
    assert stands_still(host) < stood + 20_000
    host.wait_at(0)
    until(lambda: host.cycle > stood + 100_000)


def test_as_fast_as_it_goes_or_as_real_time(start: Start) -> None:
    began_s = time.monotonic()
    host = start("--seconds", "0.5")
    until(lambda: not Path(host.port).is_symlink())
    assert time.monotonic() - began_s >= 0.5


def test_status_lines_are_seen_by_the_firmware(start: Start) -> None:
    host = start()
    with opened(host) as client:
        answers = []
        for register in (0x00, 0xF8, 0x80):
            host.set_status(register)
            after(host, 5_000)
            client.write(b"\xff")
            answers.append(client.read(1)[0])
    # Pin 11 (C0) is inverted, the others are not.
    assert answers == [0b00001, 0b11110, 0b00000]


def test_what_the_plug_was_told_can_be_followed(start: Start) -> None:
    host = start()
    told: list[tuple[int, int]] = []

    def strobes() -> int:
        told.extend((int(a["register"]), int(a["value"])) for a in host.accesses())
        return told.count((CONTROL, 0x0B))

    with opened(host) as client:
        client.write(bytes([0x49, 0xC3, 0x01]))
        client.read(3)
        until(lambda: strobes() >= 3)
    latched = [told[i - 1] for i, access in enumerate(told) if access == (CONTROL, 0x0B)]
    assert latched[-3:] == [(DATA, 0x49), (DATA, 0xC3), (DATA, 0x01)]


def test_in_lock_step_simulated_time_waits_for_the_host(start: Start) -> None:
    host = start("--speed", "0", "--stall-ms", "2000")
    with opened(host) as client:
        for _ in range(20):
            client.write(b"a")
            assert client.read(1) == b"a"
        client.write(b"a")
        client.read(1)
        answered_cycle = host.cycle
        time.sleep(0.05)
        # One slice at most; running free it would be far more than 50 ms.
        assert host.cycle - answered_cycle < 0.01 * 16e6


def test_a_wrong_option_is_named(tmp_path: Path) -> None:
    with pytest.raises(RigError, match="unknown option --nonsense"):
        SimHost(firmware(FIRMWARES / "echo.c"), tmp_path, ("--nonsense",))


def test_it_ends_cleanly_and_takes_its_link_along(start: Start) -> None:
    host = start()
    with opened(host) as client:
        client.write(b"abc")
        assert client.read(3) == b"abc"
    report = host.stop()
    assert "received 3, sent 3, overruns 0" in report
    assert not Path(host.port).exists()
    assert host.stop() == report


def test_a_marked_byte_is_told_when_it_comes_and_again_when_asked(start: Start) -> None:
    host = start("--mark", str(ord("!")))
    with opened(host) as client:
        client.write(b"abc")
        assert client.read(3) == b"abc"
        assert host.mark is None
        cycles: list[int] = []
        for _ in range(2):
            host.await_mark()
            since_s = time.monotonic()
            client.write(b"a!b")
            assert client.read(3) == b"a!b"
            assert host.mark is not None
            cycle, at_s = host.mark
            assert since_s < at_s < time.monotonic()
            cycles.append(cycle)
        assert cycles[0] < cycles[1] <= host.cycle
