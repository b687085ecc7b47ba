"""The four seams, and the facts that cross them.

    controller --blocks--> StepDriver --moves--> Card --entries--> Port --> metal
                               |
                             Clock

Everything behind a seam is a peer of the others. A peer is one class and one row in a table;
nobody above asks which one it has.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from operator import add, sub
from typing import Final, NamedTuple, Protocol

from fraese.anythread import any_thread
from fraese.blocks import Block
from fraese.errors import StateError
from fraese.phrases import phrase

#: The three registers of a parallel port, by their offset. Plain integers: they index a tuple of
#: functions several times a tick.
DATA: Final = 0
STATUS: Final = 1
CONTROL: Final = 2

#: Half of an interval, as a clock's share of it.
HALF_Q16: Final = 1 << 15

#: The value of a STATUS entry that speaks for every motor of the tick.
EVERY_MOTOR: Final = -1


class Entry(NamedTuple):
    """One access to the port: a write, or for STATUS a reading after ``value``, a motor."""

    register: int
    value: int


Entries = tuple[Entry, ...]


class Port(Protocol):
    """The three registers of a parallel port.

    Raises:
        PortError: from every method, when the port is not reachable.
    """

    def write_data(self, value: int) -> None:
        """Put a byte on DB25 pins 2 to 9."""

    def write_control(self, value: int) -> None:
        """Set the low four bits of the control register, as the register counts them."""

    def read_status(self) -> int:
        """The status register as it reads, bits 3 to 7; the others are to be ignored."""

    def close(self) -> None:
        """Give the port back. What is on the pins stays there."""


class Clock(Protocol):
    """Time as an argument."""

    def now_ns(self) -> int:
        """Nanoseconds since some fixed moment; never goes back."""

    def wait_until(self, deadline_ns: int) -> int:
        """Return at the deadline or after it, with the time then; at once if it has passed."""

    def pass_by(self, elapsed_ns: int) -> None:
        """Somebody has waited so long without this clock; where time only moves here, it does."""


class IdleLevel(Enum):
    """Current at standstill."""

    OFF = "off"
    HOLD = "hold"


class Card(Protocol):
    """What the registers mean; data and arithmetic, no clock.

    Order within a tick: the leader first, then motor order. A step counts at its rising edge.
    """

    #: How many motors the card drives.
    motors: int
    #: What one step is called: half-step, pulse.
    step_word: str
    #: Between a change of direction and the next edge.
    setup_cycles: int
    #: No pulse of a clock line, and no pause between two, is shorter; 0: there are no such lines.
    pulse_cycles: int
    #: Share of its interval for which a clock is away from rest, 1/65536.
    duty_q16: int
    #: The shortest beat into which a tick may be divided; 0: a tick is not divided.
    beat_cycles: int

    @property
    def fall(self) -> Entries:
        """What to write at the end of a tick's pulse; empty for a card without clock lines."""

    def begin(self, directions: Sequence[int], leader: int) -> Entries:
        """Take the directions (-1, 0, +1) and leader of a block; what must be set up before."""

    def tick(self, moving: int) -> Entries:
        """What makes the motors in the bit mask step once, in the block's directions.

        Nothing has happened yet: asked again, it is the same.
        """

    def stepped(self, moving: int) -> None:
        """That was written: the motors in the bit mask have made their step."""

    def signals(self, active: bool, boost: bool) -> Entries:
        """Tell the drives that motors run, and that they are in a ramp; only what changes."""

    def set_outputs(self, mask: int, value: int) -> Entries:
        """Change free outputs (bit 0: signal 1, bit 1: signal 2)."""

    def energise(self) -> Entries:
        """Full current in the present phases."""

    def idle(self, level: IdleLevel) -> Entries:
        """Holding current, or none."""

    def phases(self) -> tuple[int, ...]:
        """The phase index of every motor, to be kept over a restart."""

    def set_phases(self, phases: Sequence[int]) -> None:
        """Take up phase indices that were kept."""


class End(NamedTuple):
    """One end of one motor's travel; ``sign`` is +1 or -1."""

    motor: int
    sign: int


class Ended(Enum):
    """Why the motors stand."""

    #: Nothing was asked for yet, or they run.
    NOT = "not"
    #: Everything pushed has been played.
    TARGET = "target"
    #: An end switch closed.
    SWITCH = "switch"
    #: The watch of a block was fulfilled.
    WATCH = "watch"
    #: ``stop()``.
    STOP = "stop"
    #: ``flush()`` after a hold.
    FLUSH = "flush"
    #: The host was silent while the motors ran: braked, dropped, switched off.
    SILENCE = "silence"


@dataclass(frozen=True, slots=True)
class Report:
    """What a driver really did. Steps count from the opening of the driver.

    Attributes:
        position_steps: signed count of every motor.
        travelled_steps: the same, both directions added.
        playing: serial number, from 1, of the block now playing, or of the last one that was
            finished or dropped: the n-th block that was pushed is number n.
        finished: how many blocks were played to their last tick; one that was dropped half-way, or
            before it began, is none of them.
        tag: the tag of the block now playing, or of the last one.
        tick: ticks done in the present block.
        free: how many more blocks can be pushed.
        queued: blocks waiting or playing.
        due_ns: when the next tick is due, in the driver's clock; 0 at standstill.
        rate_hz: ticks per second of the leader, 0 at standstill.
        running: steps are being made.
        held: the throttle is closed and the motors stand; the queue waits.
        energised: the coils have full current.
        inputs: the status register as last read.
        switch_closed: contact, after debouncing.
        candidates: the ends that the contact may be; one: certain; empty: no contact.
        latched_steps: counts at the first reading of the contact that fulfilled a watch.
        ended: why the motors stand.
        torn: motors stopped without ramp above their start/stop rate: position uncertain.
        late_ticks: ticks that came late by more than a quarter of their interval.
        dry_queues: how often the queue ran dry and the driver braked.
        phases: phase index of every motor.
    """

    position_steps: tuple[int, ...]
    travelled_steps: tuple[int, ...]
    playing: int
    finished: int
    tag: int
    tick: int
    free: int
    queued: int
    due_ns: int
    rate_hz: float
    running: bool
    held: bool
    energised: bool
    inputs: int
    switch_closed: bool
    candidates: frozenset[End]
    latched_steps: tuple[int, ...] | None
    ended: Ended
    torn: frozenset[int]
    late_ticks: int
    dry_queues: int
    phases: tuple[int, ...]

    def found_at(self, position_steps: tuple[int, ...]) -> "Report":
        """Of motors that have gone on since: their phases are those of this place, too.

        A phase index may be a turn too large or too small then; cards take it as it is.
        """
        moved = map(sub, position_steps, self.position_steps)
        return replace(
            self, position_steps=position_steps, phases=tuple(map(add, self.phases, moved))
        )


class SwitchMode(Enum):
    """What an end switch does to a block that does not watch it."""

    STOP = "stop"
    IGNORE = "ignore"


class StepDriver(Protocol):
    """Plays blocks and says what was really done.

    Only ``brake``, ``stop`` and ``set_override`` may be called from any thread: they set one flag.

    Raises:
        PortError: from every method, when the metal is not reachable.
    """

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken."""

    def poll(self, budget_s: float) -> Report:
        """Play for at most that long, in the driver's clock, and say where things stand."""

    @any_thread
    def brake(self) -> None:
        """Close the throttle; the queue stays."""

    def resume(self) -> None:
        """Open the throttle again."""

    @any_thread
    def set_override(self, factor: float) -> None:
        """Play what was planned with a higher feed override no faster than with this one."""

    def flush(self) -> None:
        """Drop the queue.

        Raises:
            StateError: while steps are being made.
        """

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest."""

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
        """

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now."""

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""

    def close(self) -> None:
        """Motors off, port given back. Safe to call twice."""


def only_at_standstill(what: str) -> StateError:
    """Why a driver does not do something while motors run; half a sentence says what."""
    return StateError(
        phrase("The motors run: {what} at standstill; brake or stop first.", what=what)
    )
