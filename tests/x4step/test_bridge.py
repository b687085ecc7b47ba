"""X4Step with its steps timed by the firmware, in a simulated microcontroller."""

from itertools import pairwise
from pathlib import Path

import pytest

from fraese.assembly.drivers import planned_driver
from fraese.config.x4step import LptConfig
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.meaning import Meaning
from fraese.motor.seams import StepDriver
from fraese.motor.switches import NO_SWITCH
from fraese.motor.waveform import Waveform
from fraese.x4step import X4Step
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.lpt import LINE_NAMES, Opened, x4step_card
from fraese.x4step.surroundings import Surroundings
from fraese.x4step.testing import Lines, clock_pin
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import Chip, ChipLine
from tests.cli.test_trace_option import Wave

if reason_to_skip():
    pytest.skip(reason_to_skip(), allow_module_level=True)

#: What a microcontroller may be late where one block follows another, ns.
SEAM_NS = 75_000


class ChipLab:
    """A chip with X4Step's card.

    Attributes:
        trace: a waveform file that is wanted; None: none is.
    """

    def __init__(self, trace: Path | None = None) -> None:
        self.trace = trace
        self.chip = Chip("x4step")
        self.keys = HandKeys()
        self.around = Surroundings(self._open, Keyboard(self.keys), is_lockstep=True)

    def _open(self, lpt: int) -> Opened:
        driver: StepDriver = BridgeDriver(
            lambda: ChipLine(self.chip), x4step_card(LptConfig()), self.chip, NO_SWITCH, settle_s=0
        )
        self.chip.begin()
        trace = None
        if self.trace is not None:
            waveform = Waveform(self.trace, "lpt1", Meaning(LINE_NAMES))
            driver, trace = planned_driver(driver, waveform, x4step_card(LptConfig()), self.chip)
        return Opened(driver, self.chip, 0.015, 0.015, self.chip.twin.simulated, trace=trace)

    def lines(self) -> Lines:
        return Lines(self.chip.twin.port.accesses)


@pytest.fixture
def lab() -> ChipLab:
    return ChipLab()


def test_a_path_and_the_next_one(lab: ChipLab) -> None:
    with X4Step(1, lab.around) as motors:
        for sign in (1, -1):
            motors.load((sign * 200, -sign * 99, 0, sign * 3), 2000, 50)
            motors.start()
            assert motors.moving
            motors.wait()
            assert motors.facts.steps == (sign * 200, -sign * 99, 0, sign * 3)
    lines = lab.lines()
    assert [len(lines.rises(clock_pin(axis))) for axis in (1, 2, 3, 4)] == [400, 198, 0, 6]
    assert [lines.steps(axis) for axis in (1, 2, 3, 4)] == [0, 0, 0, 0]


def test_the_longest_ramp_is_more_than_the_ring_holds(lab: ChipLab) -> None:
    with X4Step(1, lab.around) as motors:
        motors.load((21_000, 0, 0, 0), 20_000, 1000)
        motors.start()
        motors.wait()
        assert motors.facts.steps == (21_000, 0, 0, 0)
    rises = lab.lines().rises(clock_pin(1))
    gaps = [b - a for a, b in pairwise(rises)]
    assert len(rises) == 21_000
    # What the firmware takes up at a seam it makes up for in the next interval.
    assert min(gaps) >= 50_000 - SEAM_NS
    assert gaps.count(50_000) > 900
    assert (rises[-1] - rises[0]) / 1e9 == pytest.approx(2.05, rel=0.03)


def test_seams_between_blocks_are_not_seen(lab: ChipLab, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fraese.x4step.paths.MOST_TICKS", 100)
    with X4Step(1, lab.around) as motors:
        motors.load((3000, 1234, 0, 0), 10_000, 0)
        motors.start()
        motors.wait()
        assert motors.facts.steps == (3000, 1234, 0, 0)
    lines = lab.lines()
    gaps = [b - a for a, b in pairwise(lines.rises(clock_pin(1)))]
    assert max(gaps) < 100_000 + SEAM_NS
    assert len([gap for gap in gaps if gap > 101_000]) < 30
    assert len(lines.rises(clock_pin(2))) == 1234


@pytest.mark.parametrize("end", ["brake", "stop", "key"])
def test_endless_until_it_is_ended(lab: ChipLab, end: str) -> None:
    with X4Step(1, lab.around) as motors:
        for _ in range(3):
            motors.move_negative(2, 2000, 50)
            motors.pass_time(0.1)
            lab.keys.press(1) if end == "key" else getattr(motors, end)()
            motors.wait()
            made = motors.steps(2)
            assert made < -100
            assert motors.last_brake_code == (end == "key")
            motors.load((0, 5, 0, 0), 1000, 0)
            motors.start()
            motors.wait()
            assert motors.steps(2) == 5
    assert len(lab.lines().rises(clock_pin(2))) > 300


def test_signals_and_inputs(lab: ChipLab) -> None:
    with X4Step(1, lab.around) as motors:
        for moving in (False, True):
            if moving:
                motors.move_positive(1, 200, 0)
            motors.set_output(1)
            motors.pass_time(0.03)
            assert lab.lines().level(1)
            motors.set_output(2)
            motors.pass_time(0.03)
            assert not lab.lines().level(1)
            assert motors.inputs & 0b01111 == 0b01111


def test_a_waveform_from_the_blocks_has_the_edges_of_the_firmware(tmp_path: Path) -> None:
    lab = ChipLab(tmp_path / "lines.vcd")
    with X4Step(1, lab.around) as motors:
        motors.load((200, -99, 0, 3), 2000, 50)
        motors.start()
        motors.wait()
        motors.move_negative(1, 1000, 100)
        while abs(motors.facts.steps[0]) < 150:
            assert motors.moving
        motors.stop()
        motors.wait()
    lines, wave = lab.lines(), Wave(tmp_path / "lines.vcd")
    for axis in (1, 2, 3, 4):
        rises = wave.edges(f"pin{2 * axis + 1:02d}_clock{axis}", "1")
        assert len(rises) == len(lines.rises(clock_pin(axis)))
    assert len(wave.edges("pin03_clock1", "1")) >= 350
    assert len(wave.edges("pin17_active", "1")) == 2
    assert wave.changes["pin17_active"][-1].value == "0"
