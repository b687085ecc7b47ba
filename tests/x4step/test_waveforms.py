"""The lines of X4Step's ports: what its manual promises, over random moves, brakes and stops.

Rule 1: steps that are told of are rising edges, whoever makes them.
"""

import json
import random
from bisect import bisect_right
from pathlib import Path

import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st

from fraese.motor.ports.null import NullPort
from fraese.motor.ports.recorder import Access
from fraese.x4step import X4Step
from fraese.x4step.testing import simulation
from tests.bridge.device import reason_to_skip
from tests.motor.waves import CYCLE_NS, Waves
from tests.rigs.lpt.fakeport import FakePort, after_claim, missing, writes
from tests.x4step.motions import Motion, Steps, drive, motions, simulated_writes

SHORTEST_NS = 25_000
LEAD_NS = 100_000
ENDS = ("", "brake", "stop")
#: Above some 2000 steps/s a microcontroller works out the ticks of a brake in their pauses, and
#: above 7000 the first of a block.
WORKED_OUT_NS = 500_000
#: So long after the fall between two rates it changes BOOST.
BOOST_BEHIND_NS = 40_000
#: While it is asked how far it has come, an edge may be a little off.
ASKED_NS = 1000
#: From the last fall until it takes back its signals.
REST_NS = 100_000
#: From the directions to the first edge there, with what is worked out meanwhile.
CHIP_LEAD_NS = 140_000


class Stage:
    """A port, and what is seen of one motion on it.

    Args:
        motors: on the port.
        accesses: all that was written to it so far.
    """

    def __init__(self, motors: X4Step, accesses: list[Access]) -> None:
        self.motors = motors
        self._accesses = accesses
        self._told: Steps = (0, 0, 0, 0)

    def see(self, motion: Motion) -> Waves:
        """The lines while it was driven; the steps that are told of are edges."""
        begun = len(self._accesses)
        told = drive(self.motors, motion)
        # What a microcontroller wrote last is seen a little later.
        self.motors.pass_time(0.002)
        self._told = tuple(a + b for a, b in zip(self._told, told, strict=True))
        assert Waves(self._accesses).steps() == self._told
        if not motion.end:
            assert told == motion.way
        # What stood before: the directions of the motion before, clocks and signals low.
        before = [access for access in self._accesses[:begun] if access.register == 0][-1:]
        return Waves([*before, *self._accesses[begun:]])


def intervals_q8(motion: Motion) -> list[int]:
    return [
        piece.interval_q8 + n * piece.add_q8
        for block in motion.blocks()
        for piece in block.pieces
        for n in range(piece.ticks)
    ]


def assert_rules(
    waves: Waves, off_ns: float = 2 * CYCLE_NS, worked_out_ns: float = 2 * CYCLE_NS
) -> None:
    """What holds for every motion, however it ended.

    Args:
        waves: its lines.
        off_ns: so far pause and pulse may differ;
        worked_out_ns: and a pause may be so much longer.
    """
    assert waves.shortest_ns() >= SHORTEST_NS
    assert waves.lead_ns() >= LEAD_NS
    pulses = waves.pulses()
    together = {stretch for clock in waves.clocks for stretch in clock.stretches()}
    assert together <= set(pulses)
    lengths = [fall - rise for rise, fall in pulses]
    for pause, pulse in zip(waves.pauses_ns(), lengths[1:], strict=True):
        assert -off_ns <= pause - pulse <= worked_out_ns
    assert len(waves.boost.stretches()) <= 2
    for rise, fall in pulses:
        assert waves.active.at(rise)
        assert waves.active.stretches()[-1][1] >= fall
    assert len(waves.active.stretches()) <= 1


def assert_boost(waves: Waves, motion: Motion, behind_ns: int = 0) -> None:
    """High in every interval that is longer than the level one, and in no other.

    Args:
        waves: its lines.
        motion: driven whole.
        behind_ns: so long after the fall between two rates it may change.
    """
    law = intervals_q8(motion)
    edges = [start for start, _ in waves.active.stretches()] + [fall for _, fall in waves.pulses()]
    level = min(law)
    assert [waves.boost.at(at + behind_ns) for at in edges[:-1]] == [q8 > level for q8 in law]
    for at in (at for stretch in waves.boost.stretches() for at in stretch):
        # Lines on two ports of a board change a cycle apart.
        last = bisect_right(edges, at + 2 * CYCLE_NS) - 1
        assert at - edges[last] <= (behind_ns if last < len(law) else REST_NS)
        assert at >= edges[0] - 2 * CYCLE_NS


@given(st.lists(motions(), min_size=1, max_size=3))
@example([Motion((600, 0, 0, 0), 1000, 300)])
def test_paths(wanted: list[Motion]) -> None:
    with simulation() as lab, X4Step(1) as motors:
        stage = Stage(motors, lab.recorder().accesses)
        for motion in wanted:
            waves = stage.see(motion)
            assert_rules(waves)
            assert_boost(waves, motion)
            (start_ns, end_ns), *_ = waves.active.stretches()
            assert waves.pulses()[0][0] - start_ns >= LEAD_NS
            assert waves.pulses()[-1][1] == end_ns
            for clock in waves.clocks:
                assert not clock.blips
            assert not waves.active.blips
            assert not waves.boost.blips


@pytest.mark.parametrize("ramp", range(600, 1001, 25))
def test_boost_in_ramps_of_many_blocks(ramp: int) -> None:
    """However a path is cut: once up and once down in each ramp."""
    motion = Motion((20 * ramp + 500, 0, 0, 0), 20_000, ramp)
    assert len(motion.blocks()) > 1
    with simulation() as lab, X4Step(1) as motors:
        waves = Stage(motors, lab.recorder().accesses).see(motion)
    assert_rules(waves)
    assert_boost(waves, motion)


@given(st.lists(motions(ends=ENDS), min_size=1, max_size=4))
def test_brakes_and_stops_at_any_time(wanted: list[Motion]) -> None:
    """The motion after it is driven whole."""
    with simulation() as lab, X4Step(1) as motors:
        stage = Stage(motors, lab.recorder().accesses)
        for motion in [*wanted, Motion((3, -2, 0, 1), 500, 50)]:
            waves = stage.see(motion)
            assert_rules(waves)
            assert not waves.active.high
            assert not waves.boost.high


@pytest.mark.skipif(bool(missing()), reason=missing())
@pytest.mark.parametrize("kind", ["ppdev", "devport"])
@pytest.mark.parametrize("ends", [("",), ENDS], ids=["whole", "cut short"])
def test_the_fake_port_gets_what_the_simulated_one_gets(
    tmp_path: Path, kind: str, ends: tuple[str, ...]
) -> None:
    chance = random.Random(len(ends))
    wanted = [
        Motion(
            (*(chance.randint(-90, 90) for _ in range(3)), chance.choice([-95, 95])),
            freq := chance.choice([200, 700, 5000, 20_000]),
            chance.randint(0, min(freq, 1000)),
            chance.choice(ends),
            chance.random() * 1.1,
        )
        for _ in range(30)
    ]
    fake = FakePort(tmp_path)
    told = json.loads(fake.python("tests.x4step.motions", kind, json.dumps(wanted)))
    written = writes(after_claim(fake.events()))
    assert written == simulated_writes(NullPort(), wanted)
    cut = sum(tuple(made) != motion.way for made, motion in zip(told, wanted, strict=True))
    assert cut == (0 if ends == ("",) else pytest.approx(18, abs=4))
    rises = [0, 0, 0, 0]
    data = 0
    for register, value in written:
        if register == 0:
            for axis in range(4):
                if value & ~data & 2 << 2 * axis:
                    rises[axis] += 1 if value >> 2 * axis & 1 else -1
            data = value
    assert rises == [sum(axis) for axis in zip(*told, strict=True)]


@pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())
@settings(max_examples=12, phases=[Phase.explicit, Phase.generate])
@given(st.lists(motions((1000, 20_000), ENDS), min_size=1, max_size=2))
def test_the_firmware(wanted: list[Motion]) -> None:
    assert_firmware(wanted, WORKED_OUT_NS)


@pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())
@settings(max_examples=12, phases=[Phase.explicit, Phase.generate])
@given(st.lists(motions((300, 2000), ENDS), min_size=1, max_size=2))
def test_the_firmware_where_its_brakes_are_worked_out_in_time(wanted: list[Motion]) -> None:
    assert_firmware(wanted, ASKED_NS)


def assert_firmware(wanted: list[Motion], worked_out_ns: float) -> None:
    from tests.x4step.test_bridge import ChipLab

    lab = ChipLab()
    with X4Step(1, lab.around) as motors:
        stage = Stage(motors, lab.chip.twin.port.accesses)
        for motion in wanted:
            waves = stage.see(motion)
            assert_rules(waves, ASKED_NS, worked_out_ns)
            if waves.pulses() and not motion.end:
                (start_ns, _), *_ = waves.active.stretches()
                assert waves.pulses()[0][0] - start_ns <= CHIP_LEAD_NS
            if len(motion.blocks()) == 1 and not motion.end:
                assert_boost(waves, motion, BOOST_BEHIND_NS)
