"""ppdev and /dev/port under the preloaded fake port: bytes, order, contacts, refusals."""

import errno
import json
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from fraese.errors import PortError
from fraese.motor.seams import CONTROL, DATA, STATUS
from tests.rigs.lpt.fakeport import AT_REST, CONTACT, FakePort, after_claim, missing, writes
from tests.rigs.lpt.play import WIRINGS, simulated_writes
from tests.rigs.lpt.remote import RemotePort
from tests.rigs.lpt.steps import MOTORS_OFF, check_contact

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

KINDS = ("ppdev", "devport")

Opened = Callable[..., AbstractContextManager[RemotePort]]


@pytest.fixture
def fake(tmp_path: Path) -> FakePort:
    return FakePort(tmp_path)


@pytest.fixture
def opened(fake: FakePort) -> Opened:
    @contextmanager
    def open_port(kind: str, *arguments: object) -> Iterator[RemotePort]:
        port = RemotePort(fake, kind, *arguments)
        try:
            yield port
        finally:
            port.quit()

    return open_port


def played(fake: FakePort, *arguments: str) -> dict[str, Any]:
    said = json.loads(fake.python("tests.rigs.lpt.play", *arguments))
    assert isinstance(said, dict)
    return said


# --- what goes over the wire ---------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("wiring", WIRINGS)
def test_a_job_writes_the_same_bytes_as_on_the_simulated_mill(
    fake: FakePort, wiring: str, kind: str
) -> None:
    said = played(fake, wiring, kind, "everything")
    assert said == {"ended": "target", "position_steps": [117, 105, 62]}
    written = writes(after_claim(fake.events()))
    expected = simulated_writes(wiring, "everything")
    assert len(expected) > 400
    assert written == expected


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("wiring", ["smc", "x4step"])
def test_a_contact_stops_within_the_tick_in_hand(fake: FakePort, wiring: str, kind: str) -> None:
    player = fake.start("tests.rigs.lpt.play", wiring, kind, "straight")
    fake.wait_for(lambda: fake.count() > 3000)
    fake.press()
    printed, _ = player.communicate(timeout=60)
    said = json.loads(printed)
    assert said["ended"] == "switch"
    events = fake.events()
    contact = next(
        i for i, e in enumerate(events) if (e.what, e.register, e.value) == ("R", STATUS, CONTACT)
    )
    check_contact(
        wiring, writes(events[:contact]), writes(events[contact:]), said["position_steps"]
    )


@pytest.mark.parametrize("kind", KINDS)
def test_motors_are_off_before_the_port_is_given_back(fake: FakePort, kind: str) -> None:
    played(fake, "smc", kind, "everything")
    events = fake.events()
    whats = "".join(event.what for event in events)
    assert whats.startswith({"ppdev": "OEWWCW", "devport": "ORRRW"}[kind])
    assert whats.endswith({"ppdev": "WLX", "devport": "WX"}[kind])
    last = [e.value for e in events if (e.what, e.register) == ("W", DATA)][-3:]
    assert tuple(last) == MOTORS_OFF
    # The last strobe has latched the last byte, and rests.
    assert [e.value & 1 for e in events if (e.what, e.register) == ("W", CONTROL)][-2:] == [1, 0]
    assert "?" not in whats


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=lambda n: n.name)
def test_a_signal_in_the_middle_leaves_the_motors_off(
    fake: FakePort, kind: str, number: signal.Signals
) -> None:
    player = fake.start("tests.rigs.lpt.play", "smc", kind, "endless")
    fake.wait_for(lambda: fake.count() > 300)
    player.send_signal(number)
    printed, _ = player.communicate(timeout=20)
    assert json.loads(printed)["ended"] == "stop"
    last = [e.value for e in fake.events() if (e.what, e.register) == ("W", DATA)][-3:]
    assert tuple(last) == MOTORS_OFF


@pytest.mark.parametrize("kind", KINDS)
def test_a_port_that_goes_away_is_said_and_given_back(fake: FakePort, kind: str) -> None:
    player = fake.start("tests.rigs.lpt.play", "smc", kind, "endless")
    fake.wait_for(lambda: fake.count() > 300)
    fake.refuse("access", errno.EIO)
    printed, _ = player.communicate(timeout=20)
    assert "does not answer any more: Input/output error" in json.loads(printed)["error"]
    assert fake.events()[-1].what == "X"


# --- control register ----------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("others", [0x00, 0x10, 0x20, 0x30], ids=hex)
def test_interrupt_and_direction_bits_stay_as_they_were(
    fake: FakePort, opened: Opened, kind: str, others: int
) -> None:
    if kind == "ppdev":
        others = 0x10  # There the kernel writes the register, and keeps its own bit.
    fake.control = others | 0x0C
    with opened(kind) as port:
        seen = fake.count()
        for value in range(16):
            port.write_control(value)
    written = [e.value for e in fake.events(seen) if e.what == "W"]
    assert written == [others | value for value in range(16)]


@pytest.mark.parametrize("kind", KINDS)
def test_all_inputs_are_read_as_they_are(fake: FakePort, opened: Opened, kind: str) -> None:
    with opened(kind) as port:
        for bit in (0x08, 0x10, 0x20, 0x40, 0x80):
            fake.status = AT_REST ^ bit
            assert port.read_status() == AT_REST ^ bit


@pytest.mark.parametrize("kind", KINDS)
def test_giving_back_changes_no_pin(fake: FakePort, opened: Opened, kind: str) -> None:
    with opened(kind) as port:
        port.write_data(0x49)
        port.write_control(0x05)
        seen = fake.count()
        port.close()
        with pytest.raises(PortError, match="is used after it was given back"):
            port.write_data(0)
        with pytest.raises(PortError, match="is used after it was given back"):
            port.read_status()
    assert fake.writes(seen) == []
    assert (fake.data, fake.control & 0x0F) == (0x49, 0x05)


# --- somebody else -------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_a_second_program_is_refused_and_the_first_goes_on(
    fake: FakePort, opened: Opened, kind: str
) -> None:
    with opened(kind) as first:
        started_s = time.monotonic()
        with pytest.raises(PortError, match=r"is held by another program.*: close that one"):
            RemotePort(fake, kind)
        assert time.monotonic() - started_s < 5
        first.write_data(0x12)
        assert fake.data == 0x12
        first.close()
        with opened(kind) as second:
            second.write_data(0x34)
    assert fake.data == 0x34


@pytest.mark.parametrize("kind", KINDS)
def test_the_port_of_a_killed_program_is_free(fake: FakePort, opened: Opened, kind: str) -> None:
    with opened(kind) as killed:
        killed.write_data(0x12)
    assert fake.data == 0x12, "nobody has switched anything off"
    with opened(kind) as port:
        port.write_data(0x1B)
    assert fake.data == 0x1B


# --- refusals ------------------------------------------------------------------------------------

REFUSALS = [
    ("ppdev", "open parport", errno.ENOENT, "does not exist.*modprobe -a parport_pc ppdev"),
    ("ppdev", "open parport", errno.ENXIO, "does not exist.*modprobe -a parport_pc ppdev"),
    ("ppdev", "open parport", errno.EACCES, "may not be used by this user: .*group"),
    ("ppdev", "open parport", errno.EPERM, "may not be used by this user: .*group"),
    ("ppdev", "open parport", errno.EBUSY, "is in use by another program"),
    ("ppdev", "open parport", errno.EMFILE, "cannot be opened: Too many open files"),
    ("ppdev", "exclusive", errno.ENXIO, "is held by another program.*rmmod lp"),
    ("ppdev", "claim", errno.ENXIO, "is held by another program.*rmmod lp"),
    ("ppdev", "claim", errno.EBUSY, "is held by another program.*rmmod lp"),
    ("ppdev", "claim", errno.EIO, "cannot be claimed: Input/output error"),
    ("devport", "open port", errno.ENOENT, "is missing in this kernel.*ppdev"),
    ("devport", "open port", errno.EACCES, "is for root.*ppdev|CAP_SYS_RAWIO.*ppdev"),
    ("devport", "open port", errno.EPERM, "CAP_SYS_RAWIO.*ppdev|lockdown.*ppdev"),
    ("devport", "open port", errno.EMFILE, "cannot be opened: Too many open files"),
    ("devport", "access", errno.EIO, "at 0x378 cannot be read: Input/output error"),
]


@pytest.mark.parametrize(("kind", "call", "number", "said"), REFUSALS)
def test_a_refusal_is_one_sentence(
    fake: FakePort, kind: str, call: str, number: int, said: str
) -> None:
    fake.refuse(call, number)
    with pytest.raises(PortError, match=said) as caught:
        RemotePort(fake, kind)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert sentence.endswith(".")
    # Whatever was opened has been closed again, and no register was written.
    whats = [event.what for event in fake.events()]
    assert whats.count("O") == whats.count("X")
    assert "W" not in whats


def test_what_is_no_ppdev_device_is_said(fake: FakePort, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for device in (tmp_path / "file", "/dev/null"):
        with pytest.raises(PortError, match="is not a ppdev device; the first port is /dev/parp"):
            RemotePort(fake, "ppdev", str(device))
    with pytest.raises(PortError, match="cannot be opened: Is a directory"):
        RemotePort(fake, "ppdev", str(tmp_path))


def test_an_address_with_nothing_behind_it_is_said(fake: FakePort) -> None:
    with pytest.raises(PortError, match="no parallel port at 0x278: all three registers read 0xff"):
        RemotePort(fake, "devport", 0x278)
    assert fake.writes() == []


# --- what it costs -------------------------------------------------------------------------------


def test_the_log_copes_with_half_a_million_accesses(fake: FakePort) -> None:
    play = partial(fake.python, "tests.rigs.lpt.hammer", timeout_s=60)
    assert json.loads(play("ppdev", "450000")) == 450_000
    events = fake.events()
    values = [e.value for e in events if (e.what, e.register) == ("W", DATA)]
    assert values == [n & 0xFF for n in range(450_000)]
    assert all(a.at_ns <= b.at_ns for a, b in pairwise(events))
