"""The Port seam: one suite, every peer.

A rig is a port and somebody at the machine, who can press the end switch.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest

from fraese.motor.clock import VirtualClock
from fraese.motor.electronics import SmcElectronics, StepDirElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.phases import LEVEL_MAPS
from fraese.motor.ports.null import NullPort
from fraese.motor.ports.recorder import Access, Recorder
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import CONTROL, DATA, STATUS, End, Port
from tests.rigs.lpt.fakeport import FakePort, missing
from tests.rigs.lpt.remote import RemotePort

INPUT_BITS = 0xF8
SWITCH = 0x80


@dataclass
class Rig:
    port: Port
    press: Callable[[], None] | None = None
    let_go: Callable[[], None] | None = None


def simulated(kind: str) -> tuple[SimulatedMill, VirtualClock]:
    clock = VirtualClock()
    mill = Mill([Slide(1000)] * 3)
    if kind == "smc":
        return SimulatedMill(mill, SmcElectronics(mill, clock, LEVEL_MAPS["field"]), clock), clock
    return SimulatedMill(mill, StepDirElectronics(mill, clock), clock), clock


@contextmanager
def on_mill(kind: str, recorded: bool, folder: Path) -> Iterator[Rig]:
    mill, clock = simulated(kind)
    end = End(0, 1)
    port = Recorder(mill, clock) if recorded else mill
    yield Rig(port, lambda: mill.press(end), lambda: mill.let_go(end))


@contextmanager
def on_fake_port(kind: str, folder: Path) -> Iterator[Rig]:
    if missing():
        pytest.skip(missing())
    fake = FakePort(folder)
    port = RemotePort(fake, kind)
    yield Rig(port, fake.press, fake.let_go)
    port.quit()


@contextmanager
def on_nothing(folder: Path) -> Iterator[Rig]:
    yield Rig(NullPort())


PEERS: dict[str, Callable[[Path], AbstractContextManager[Rig]]] = {
    "smc mill": partial(on_mill, "smc", False),
    "stepdir mill": partial(on_mill, "stepdir", False),
    "recorded smc mill": partial(on_mill, "smc", True),
    "recorded stepdir mill": partial(on_mill, "stepdir", True),
    "ppdev": partial(on_fake_port, "ppdev"),
    "devport": partial(on_fake_port, "devport"),
    "null": on_nothing,
}


@pytest.fixture(params=PEERS)
def peer(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    with PEERS[request.param](tmp_path) as rig:
        yield rig


class TestPortContract:
    def test_takes_every_byte(self, peer: Rig) -> None:
        for value in range(256):
            peer.port.write_data(value)

    def test_takes_all_four_control_bits(self, peer: Rig) -> None:
        for value in range(16):
            peer.port.write_control(value)

    def test_status_is_a_byte_and_stays_while_nothing_happens(self, peer: Rig) -> None:
        status = peer.port.read_status()
        assert 0 <= status <= 0xFF
        assert {peer.port.read_status() & INPUT_BITS for _ in range(9)} == {status & INPUT_BITS}

    def test_writing_does_not_change_the_inputs(self, peer: Rig) -> None:
        before = peer.port.read_status() & INPUT_BITS
        peer.port.write_data(0xFF)
        peer.port.write_control(0x0F)
        assert peer.port.read_status() & INPUT_BITS == before

    def test_a_switch_is_seen_and_seen_to_open(self, peer: Rig) -> None:
        if peer.press is None or peer.let_go is None:
            pytest.skip("nobody is at this port")
        before = peer.port.read_status() & SWITCH
        peer.press()
        assert peer.port.read_status() & SWITCH != before
        peer.let_go()
        assert peer.port.read_status() & SWITCH == before

    def test_can_be_given_back_twice(self, peer: Rig) -> None:
        peer.port.close()
        peer.port.close()


def test_a_recorder_writes_everything_down_in_order() -> None:
    mill, clock = simulated("smc")
    recorder = Recorder(mill, clock)
    recorder.write_data(0x49)
    clock.wait_until(7)
    recorder.write_control(1)
    status = recorder.read_status()
    assert recorder.accesses == [
        Access(0, DATA, 0x49),
        Access(7, CONTROL, 1),
        Access(7, STATUS, status),
    ]
    assert recorder.writes() == [(DATA, 0x49), (CONTROL, 1)]
