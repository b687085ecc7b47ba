"""The bridge: whatever the device says, in whatever state the driver is.

The truth is what the device took: ``tests/bridge/sham.py``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import pytest
from hypothesis import event, example, given
from hypothesis import strategies as st

from fraese.assembly import Plant, assemble
from fraese.blocks import Block
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Decoder, frame
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.link import Link
from fraese.motor.bridge.session import STUCK_S
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.clock import VirtualClock
from fraese.motor.seams import IdleLevel, SwitchMode
from tests.bridge.sham import ACK_WIDTHS, RING, STATUS_WIDTHS, TRUTH, Liar, Lie, Sham
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of
from tests.helpers import configured
from tests.motor.workbench import steady

MOTORS = 3
#: One call waits for a few answers, and for each no longer than that.
_LONGEST_CALL_S = 2 * STUCK_S
_NUMBERS = st.one_of(st.integers(0, 8), st.integers(0, 2**32 - 1), st.just(2**32 - 1))
_KINDS = ["lost", "twice", "junk", "frame", "cut", "short", "flip", "late"]
_BENT = st.builds(
    Lie,
    st.just("bent"),
    st.dictionaries(st.integers(0, len(ACK_WIDTHS) - 1), _NUMBERS, min_size=0, max_size=2),
    st.dictionaries(st.integers(1, len(STATUS_WIDTHS) - 1), _NUMBERS, min_size=1, max_size=4),
)
_FRAMES = st.sampled_from([c.KIND_ACK, c.KIND_STATUS, c.KIND_HELLO_REPLY, c.KIND_BLOCKS, 0, 255])
_BROKEN = st.builds(
    Lie,
    st.sampled_from(_KINDS),
    data=st.binary(max_size=70),
    at=st.one_of(_FRAMES, st.integers(0, 0xFFFF)),
)
_TRUE = st.just(Lie("truth"))
LIES = st.one_of(
    st.lists(st.one_of(_BENT, _BENT, _BROKEN, _TRUE, _TRUE), min_size=1, max_size=30),
    st.lists(st.one_of(_BENT, _BROKEN), min_size=1, max_size=2),
)
_FOR_EVER = st.sampled_from([False, True, True])
STEPS = st.tuples(st.integers(1, 60), *[st.integers(-60, 60)] * (MOTORS - 1))
Call = tuple[str, object]
CALLS = st.lists(
    st.one_of(
        st.tuples(st.just("push"), STEPS),
        st.tuples(st.just("push"), STEPS),
        st.tuples(st.just("poll"), st.sampled_from([0.0, 0.02, 0.1, 0.5])),
        st.tuples(st.just("poll"), st.sampled_from([0.02, 0.5])),
        st.tuples(st.just("wait"), st.sampled_from([0.01, 0.3, 2.0])),
        st.tuples(
            st.sampled_from(["brake", "stop", "resume", "flush", "idle", "life", "outputs"]),
            st.just(0),
        ),
        st.tuples(st.just("override"), st.floats(0, 3)),
        st.tuples(st.just("mode"), st.sampled_from(list(SwitchMode))),
    ),
    min_size=4,
    max_size=25,
)


@dataclass
class Trial:
    """A driver, a device, and what was asked of them.

    Attributes:
        script: what becomes of the answers.
        for_ever: it begins anew at its end.
        honest: so many answers before that are true; the greeting has eight.
        pushed: blocks that were taken, in order.
    """

    script: list[Lie]
    for_ever: bool
    honest: int
    clock: VirtualClock = field(default_factory=VirtualClock)
    pushed: list[Block] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.sham = Sham(MOTORS, pace=7)
        self.lines: list[Liar] = []
        self.driver: BridgeDriver | None = None
        self.sentences: list[str] = []

    def open_line(self) -> Liar:
        # A device that is found again goes on as it did before.
        script, said = self.lies, sum(line.said for line in self.lines)
        self.lines.append(Liar(self.sham, self.clock, lambda number: script(said + number)))
        return self.lines[-1]

    def lies(self, number: int) -> Lie:
        """What becomes of the answer with that number, from 0."""
        at = number - self.honest
        if at < 0 or (at >= len(self.script) and not self.for_ever):
            return TRUTH
        return self.script[at % len(self.script)]

    def do(self, action: Callable[[], object], budget_s: float = 0.0) -> str:
        """One sentence, or none; within the time that such a call may take."""
        since_ns = self.clock.now_ns()
        # Virtual time is what counts; a busy machine takes its own.
        said = refusal_of(action, 60)
        assert is_a_sentence(said)
        took_s = (self.clock.now_ns() - since_ns) / 1e9
        assert took_s <= budget_s + _LONGEST_CALL_S, (took_s, said)
        self.sentences.append(said)
        return said

    def begin(self) -> None:
        def made() -> None:
            self.driver = BridgeDriver(self.open_line, SmcCard(), self.clock, patience_s=0.3)

        self.do(made, budget_s=6.0)

    def call(self, driver: BridgeDriver, name: str, value: object) -> None:
        actions: dict[str, Callable[[], object]] = {
            "push": lambda: self._push(driver, value),
            "poll": lambda: self._poll(driver, float(str(value))),
            "wait": lambda: self.clock.pass_by(round(float(str(value)) * 1e9)),
            "brake": driver.brake,
            "stop": driver.stop,
            "resume": driver.resume,
            "flush": driver.flush,
            "idle": lambda: driver.idle(IdleLevel.OFF),
            "life": driver.sign_of_life,
            "outputs": lambda: driver.set_outputs(1, 1),
            "override": lambda: driver.set_override(float(str(value))),
            "mode": lambda: driver.set_switch_mode(SwitchMode(value)),
        }
        budget_s = float(str(value)) if name in ("poll", "wait") else 0.0
        said = self.do(actions[name], budget_s)
        self.require_no_more_than_asked()
        if said:
            bounds = driver._picture.account.bounds()
            self.require_within(*zip(*bounds, strict=True))

    def _push(self, driver: BridgeDriver, steps: object) -> None:
        assert isinstance(steps, tuple)
        block = steady(*steps)
        if driver.push(block):
            self.pushed.append(block)

    def _poll(self, driver: BridgeDriver, budget_s: float) -> None:
        report = driver.poll(budget_s)
        self.require_within(report.position_steps)
        assert 0 <= report.finished <= report.playing <= len(self.pushed)
        assert 0 <= report.queued <= len(self.pushed)

    def require_within(self, *places: Sequence[int]) -> None:
        """No place is said to which nobody wanted to go, whatever was dropped on the way."""
        for motor in range(MOTORS):
            steps = [block.steps[motor] for block in self.pushed]
            lowest, highest = sum(min(n, 0) for n in steps), sum(max(n, 0) for n in steps)
            for place in places:
                assert lowest <= place[motor] <= highest, (place, lowest, highest)

    def require_no_more_than_asked(self) -> None:
        """What the device took are blocks that were pushed, in order, each of them once."""
        wanted = iter(block.steps for block in self.pushed)
        for queue in self.sham.taken:
            for block in queue:
                assert any(steps == block.steps for steps in wanted), (block, self.pushed)


@fuzzed(150)
@given(
    LIES, st.sampled_from([False, True, True]), st.sampled_from([0, 3, 8, 9, 10, 11, 12, 14]), CALLS
)
@example([Lie("bent", status={3: 200})], True, 0, [("push", (5, 0, 0)), ("poll", 0.1)])
@example([Lie("bent", status={5: 900})], True, 8, [("push", (5, 0, 0)), ("poll", 0.1)])
def test_a_device_may_say_anything(
    script: list[Lie], for_ever: bool, honest: int, calls: list[Call]
) -> None:
    trial = Trial(script, for_ever, honest)
    trial.begin()
    event(f"greeted: {trial.driver is not None}")
    if trial.driver is None:
        assert trial.sentences[-1]
        assert all(line.closed for line in trial.lines)
        return
    for name, value in calls:
        trial.call(trial.driver, name, value)
    for said in {said.partition(";")[0][:60] for said in trial.sentences}:
        event(said)
    event(f"started: {min(trial.sham.started, 3)}")
    trial.do(trial.driver.close)
    assert all(line.closed for line in trial.lines)


_PIECES = st.one_of(
    st.binary(max_size=80),
    st.builds(frame, _FRAMES, st.integers(0, 255), st.binary(max_size=c.PAYLOAD_MAX)),
)


@fuzzed(200)
@given(st.lists(_PIECES, max_size=20), st.integers(1, 40))
def test_bytes_mean_the_same_however_they_are_cut(pieces: list[bytes], size: int) -> None:
    line = b"".join(pieces)
    cut = [line[at : at + size] for at in range(0, len(line), size)]
    decoder, link = Decoder(), Link(1, RING)
    assert [item for part in cut for item in decoder.feed(part)] == Decoder().feed(line)
    for part in cut:
        for status in link.feed(part, 0):
            assert status.ack.session == 1


# --- the whole machine ---------------------------------------------------------------------------

#: A job ends so long after the last thing that it got on with, the way out included.
_LONGEST_JOB_S = 30.0


@dataclass
class Shop(Trial):
    """A machine on that device."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.sham = Sham(MOTORS, pace=40)
        self.plant: Plant | None = None

    def start(self, patch: pytest.MonkeyPatch) -> None:
        patch.setattr("fraese.motor.bridge.line.SerialLine", lambda *_: self.open_line())
        patch.setattr("fraese.assembly.drivers.MonotonicClock", lambda: self.clock)
        patch.setattr("fraese.motor.bridge.lifesign.LifeSign.start", lambda _: None)

        def made() -> None:
            self.plant = assemble(configured(port={"kind": "bridge", "device": "/dev/sham"}))

        self.do(made, budget_s=12.0)

    def job(self, controller: Controller, axis: str, way_mm: float) -> None:
        """A jog; what the device takes is no more than it."""
        motor, before = "xyz".index(axis), len(self.sham.taken)
        self.sham.taken.append([])
        since_ns = self.clock.now_ns()
        refused = self.do(lambda: controller.jog(axis, way_mm), 1.0)
        said = refused or self.do(controller.run, _LONGEST_JOB_S)
        assert not said or refused, said
        took_s = (self.clock.now_ns() - since_ns) / 1e9
        state = controller.state()
        event(f"{state.status.name} {state.alarm and state.alarm.number} {bool(refused)}")
        assert is_a_sentence(state.message)
        assert state.status is not Status.RUN
        if state.status is Status.ERROR:
            assert state.alarm is not None, state.message
            controller.acknowledge()
        blocks = [block.steps for queue in self.sham.taken[before:] for block in queue]
        asked = round(way_mm * float(controller.machine.axes[motor].steps_per_mm))
        for each, total in enumerate(map(sum, zip(*blocks, strict=True)) if blocks else ()):
            wanted = asked if each == motor else 0
            assert min(0, wanted) <= total <= max(0, wanted), (blocks, way_mm, took_s)


@fuzzed(60)
@given(
    LIES,
    _FOR_EVER,
    st.sampled_from([0, 9, 13, 18, 20, 21, 22, 24, 26, 28, 40]),
    st.lists(
        st.tuples(st.sampled_from("xyz"), st.sampled_from([-1.0, 0.01, 0.5, 2.0])),
        min_size=1,
        max_size=3,
    ),
)
@example([Lie("bent", status={1: 5, 8: 0xFFFFFFFF})], True, 20, [("x", 2.0)])
@example([Lie("bent", status={1: 5})], True, 26, [("x", 2.0)])
@example([Lie("bent", status={1: 0, 2: 0})], False, 28, [("x", -1.0)])
@example([Lie("bent", status={1: 3}), Lie("bent", status={1: 0, 2: 0})], True, 9, [("x", -1.0)])
@example([Lie("bent", status={1: 5, 2: 3, 4: 1, 5: 7, 8: 16_000})], True, 22, [("x", 2.0)])
@example(
    [Lie("bent", status={1: 0}), Lie("bent", status={9: 0}), Lie("lost", at=66)],
    True,
    0,
    [("x", -1.0)],
)
@example(
    [
        TRUTH,
        Lie("bent", status={1: 0}),
        Lie("bent", {0: 2**32 - 1}, {1: 0}),
        TRUTH,
        Lie("bent", status={4: 0}),
    ],
    True,
    0,
    [("x", -1.0), ("x", -1.0)],
)
def test_a_machine_on_such_a_device(
    script: list[Lie], for_ever: bool, honest: int, jobs: list[tuple[str, float]]
) -> None:
    shop = Shop(script, for_ever, honest)
    with pytest.MonkeyPatch.context() as patch:
        shop.start(patch)
        if shop.plant is None:
            assert shop.sentences[-1]
            return
        for axis, way_mm in jobs:
            shop.job(shop.plant.controller, axis, way_mm)
        shop.do(shop.plant.close, 2.0)
