"""The same blocks on the polled core and on the firmware, and what each wrote to the registers.

    core      MotorCore -> card -> Recorder -> Lines      virtual time
    firmware  BLOCKS -> image -> PORTB, PORTC, PORTD      simulated cycles

Rule 1: both are told the same things at the same cycles: a brake that comes in the middle of an
        interval comes there for both.
Rule 2: registers, values and order are equal for the whole life of a run. The first write of every
        beat is at the same cycle, counted from the moment at which time began for the run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final, NamedTuple

from fraese.blocks import Block
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts, Line
from fraese.motor.bridge.records import Dry
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.phases import MOTRUN
from fraese.motor.ports.recorder import Recorder
from fraese.motor.seams import CONTROL, DATA, STATUS, Card, Report
from fraese.motor.switches import SwitchInput
from tests.bridge.device import Device

#: All inputs open: pin 11 low reads as 1 in bit 7.
OPEN: Final = 0xF8
SETTLE_CYCLES: Final = 16_000
#: The direction lines of clock and direction, all motors.
DIRECTIONS: Final = 0x55


class Write(NamedTuple):
    """One register write; the cycle counts from the begin of its run."""

    cycle: int
    register: int
    value: int


class Lines:
    """A port whose status register the test sets."""

    def __init__(self) -> None:
        self.status = OPEN

    def write_data(self, value: int) -> None:
        """Nothing listens."""

    def write_control(self, value: int) -> None:
        """Nothing listens."""

    def read_status(self) -> int:
        """What the test has set."""
        return self.status

    def close(self) -> None:
        """Nothing to give back."""


class Kind(NamedTuple):
    """A card for both peers."""

    card: Callable[[], Card]
    facts: CardFacts


PHASES: Final = Kind(
    lambda: SmcCard(outputs=(OutputPin(14), OutputPin(16), OutputPin(17))),
    CardFacts(
        c.CARD_PHASES, 3, MOTRUN, control_rest=0b1010, strobe=1,
        outputs=(Line(0b0010, 0), Line(0b0100, 0b0100), Line(0b1000, 0)),
        beat_cycles=SmcCard().beat_cycles, settle_cycles=SETTLE_CYCLES,
    ),
)  # fmt: skip


def clock_kind(profile: str, duty: float = 0.5, sockets: tuple[int, ...] = (0, 1, 2, 3)) -> Kind:
    """Clock and direction on four motors, with two outputs."""
    row = STEPDIR_PROFILES[profile]._replace(duty=duty)
    return Kind(
        lambda: StepDirCard(row, outputs=(OutputPin(1), OutputPin(14)), sockets=sockets),
        CardFacts(
            c.CARD_CLOCKS, 4, control_rest=0b1011, active=Line(0b1000, 0),
            boost=Line(0b0100, 0b0100), outputs=(Line(0b0001, 0), Line(0b0010, 0)),
            pulse_cycles=row.pulse_cycles, setup_cycles=row.setup_cycles,
            settle_cycles=SETTLE_CYCLES, motor_bits=tuple(3 << 2 * socket for socket in sockets),
            duty_q16=round(duty * 0x10000),
        ),
    )  # fmt: skip


class WatchedClock(VirtualClock):
    """A virtual clock that does things at given moments, when somebody waits beyond them."""

    def __init__(self) -> None:
        super().__init__()
        self.events: list[tuple[int, Callable[[], None]]] = []

    def wait_until(self, deadline_ns: int) -> int:
        """Stop on the way for what was to be done."""
        while self.events and self.events[0][0] <= deadline_ns:
            at_ns, act = self.events.pop(0)
            super().wait_until(at_ns)
            act()
        return super().wait_until(deadline_ns)


@dataclass
class Core:
    """The polled core with everything that it wrote.

    Attributes:
        dry: the dry point of every block pushed, as the device is told.
    """

    kind: Kind
    lines: Lines = field(default_factory=Lines)
    clock: WatchedClock = field(default_factory=WatchedClock)
    dry: list[Dry | None] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.recorder = Recorder(self.lines, self.clock)
        facts = self.kind.facts
        switch = SwitchInput(facts.switch_mask, facts.switch_value, facts.readings)
        self.driver = MotorCore(
            self.recorder, self.kind.card(), self.clock, switch, SETTLE_CYCLES / 16e6,
            safe_outputs=facts.safe,
        )  # fmt: skip
        self.recorder.accesses.clear()
        self._pushed = 0

    def push(self, blocks: Sequence[Block]) -> None:
        """Queue blocks, and note their dry points."""
        for block in blocks:
            assert self.driver.push(block)
            self._pushed += 1
            point = self.driver._run.queue.dry_point
            self.dry.append(point and Dry(self._pushed - point.serial, point.ticks_done))

    def play(self) -> Report:
        """Until nothing more is played."""
        report = self.driver.poll(1000.0)
        while report.running:
            report = self.driver.poll(1000.0)
        return report

    def writes(self) -> list[Write]:
        """Everything written, in cycles since ``base``."""
        base_ns = self.driver._run.ticks._base_ns
        return [
            Write((2 * (a.at_ns - base_ns) + 124) // 125, a.register, a.value)
            for a in self.recorder.accesses
            if a.register != STATUS
        ]


def open_inputs(device: Device) -> None:
    """No input has contact."""
    for pin, level in (("C0", False), ("C1", True), ("C2", True), ("C3", True), ("C4", True)):
        device.avr.set_pin(pin, level)


def device_for(kind: Kind) -> Device:
    """The firmware with that card, inputs open."""
    device = Device()
    open_inputs(device)
    device.upload(kind.facts)
    device.run(20_000)
    device.mark = device.avr.cycle
    return device


def device_writes(device: Device) -> list[Write]:
    """What the firmware wrote since it was made ready, in cycles since power-on."""
    accesses = device.accesses()
    later = accesses[accesses["cycle"] > device.mark]
    writes: list[Write] = []
    for access in later:
        write = Write(int(access["cycle"]), int(access["register"]), int(access["value"]))
        if writes and _is_second_half(writes[-1], write):
            write = write._replace(cycle=writes.pop().cycle)
        elif writes and _is_echo(writes, write):
            writes.pop()
        writes.append(write)
    return writes


def _is_echo(writes: Sequence[Write], control: Write) -> bool:
    """The data bits that share a port with control lines were written again, as they were."""
    last = writes[-1]
    if control.register != CONTROL or control.cycle - last.cycle > 1 or last.register != DATA:
        return False
    before = next((w.value for w in reversed(writes[:-1]) if w.register == DATA), None)
    return before is None or before == last.value


def _is_second_half(first: Write, second: Write) -> bool:
    """Control lines are on two ports of the board, written one right after the other."""
    return first.register == second.register == CONTROL and second.cycle - first.cycle <= 1


def steady_cycles(writes: Sequence[Write]) -> list[int]:
    """For every rising clock, how long the direction lines had not turned; on the pins."""
    data = [w for w in writes if w.register == DATA]
    turned, found = data[0].cycle, []
    for before, after in pairwise(data):
        if (before.value ^ after.value) & DIRECTIONS:
            turned = after.cycle
        elif after.value & ~before.value:
            found.append(after.cycle - turned)
    return found


#: How long the writes of a beat of three motors may take.
BEAT_CYCLES: Final = 500


def compare(
    core: Sequence[Write],
    device: Sequence[Write],
    late_cycles: int = 0,
    slack_cycles: int = BEAT_CYCLES,
) -> None:
    """The same writes in the same order, every beat at the same cycle.

    Args:
        core: cycles from the begin of the run; writes before it have cycles below 1.
        device: cycles of its own.
        late_cycles: how late the first write of a beat may be.
        slack_cycles: how long the writes of one beat may take altogether.
    """
    assert [w[1:] for w in device] == [w[1:] for w in core]
    first = next((i for i, w in enumerate(core) if w.cycle > 0), None)
    if first is None:
        return
    offset = device[first].cycle - core[first].cycle
    before = None
    for number, (mine, theirs) in enumerate(zip(core, device, strict=True)):
        if mine.cycle <= 0:
            continue
        late = theirs.cycle - offset - mine.cycle
        if late < 0 or (mine.cycle != before and mine.register == DATA):
            text = f"write {number}, at {mine.cycle}, came {late} cycles late"
            assert 0 <= late <= late_cycles, text
        assert 0 <= late < late_cycles + slack_cycles or mine.register == CONTROL
        before = mine.cycle
