"""End switches, as a rule on one input for all of them; which one it is must be inferred.

Rule 1: after every motor movement the input is read, and at standstill at every poll.
Rule 2: K consecutive closed readings make a contact, the counts are those of the first of them.
        K consecutive open readings end it. With K = 1 this is the seed, exactly.
Rule 3: one motor moving: the contact is named from motor and direction, and stays named until
        the input opens again.
Rule 4: where ends have inputs of their own, contact is on any of them; which, those above see.
Rule 5: contact lags the motor by some ticks. So with several axes the candidates are all ends
        that the present block moves towards, or that a block moved towards which ended less than
        20 ms ago. Closed without a movement: any end. A set is shown as a set.
"""

from collections.abc import Callable
from typing import Final, NamedTuple

from fraese.blocks import Block, WatchAction
from fraese.motor.seams import End

#: A contact may come this long after the motor that made it has stopped.
CONTACT_LAG_NS: Final = 20_000_000

StepCounts = tuple[int, ...]


class SwitchInput(NamedTuple):
    """Which inputs end switches are on, and how they read with contact.

    Attributes:
        mask: bits of the status register (bit 7 is BUSY, DB25 pin 11); as a rule one.
        closed_value: what each of these bits is with contact; 0 on these cards.
        readings: consecutive readings that make or end a contact.
    """

    mask: int = 0x80
    closed_value: int = 0
    readings: int = 3


#: Never fulfilled: inputs stop nothing, and a floating one costs no time.
NO_SWITCH: Final = SwitchInput(mask=0, closed_value=1)


class Debounced:
    """One condition on the status register, true or false only after K equal readings.

    Attributes:
        is_true: the debounced condition.
        latched_steps: counts at the first of the readings that made it true.
    """

    def __init__(self, mask: int, value: int, readings: int) -> None:
        self._mask = mask
        self._value = value
        self._readings = readings
        self._run = 0
        self._first: StepCounts = ()
        self.is_true = False
        self.latched_steps: StepCounts | None = None

    @property
    def pending(self) -> bool:
        """Readings have begun to differ from the debounced condition."""
        return self._run > 0

    def take(self, status: int, steps: Callable[[], StepCounts]) -> bool:
        """Take one reading; True when this reading changed the debounced condition."""
        if self._holds(status) == self.is_true:
            self._run = 0
            return False
        if self._run == 0:
            self._first = steps()
        self._run += 1
        if self._run < self._readings:
            return False
        self._run = 0
        self.is_true = not self.is_true
        self.latched_steps = self._first if self.is_true else None
        return True

    def _holds(self, status: int) -> bool:
        return status & self._mask == self._value


class AnyOf(Debounced):
    """The same, where any of the bits is enough."""

    def _holds(self, status: int) -> bool:
        return (status ^ self._value) & self._mask != self._mask


class Inference:
    """Which ends a contact may be, from what moved lately."""

    def __init__(self, motors: int) -> None:
        self._every = frozenset(End(motor, sign) for motor in range(motors) for sign in (-1, 1))
        self._moving: frozenset[End] = frozenset()
        self._ended: list[tuple[int, frozenset[End]]] = []

    def begin(self, directions: tuple[int, ...]) -> None:
        """A block starts that moves in these directions (-1, 0, +1 per motor)."""
        self._moving = frozenset(End(motor, sign) for motor, sign in enumerate(directions) if sign)

    def end(self, now_ns: int) -> None:
        """The block ended."""
        if self._moving:
            self._drop_old(now_ns)
            self._ended.append((now_ns, self._moving))
            self._moving = frozenset()

    def candidates(self, now_ns: int) -> frozenset[End]:
        """Ends that a contact seen now may be."""
        self._drop_old(now_ns)
        return self._moving.union(*(ends for _, ends in self._ended)) or self._every

    def _drop_old(self, now_ns: int) -> None:
        self._ended = [item for item in self._ended if now_ns - item[0] < CONTACT_LAG_NS]


class InputWatcher:
    """Everything that is inferred from the status register.

    Args:
        motors: how many.
        switch: the inputs of the end switches.

    Attributes:
        status: the register as last read.
        quiet_status: a reading equal to this changes nothing and need not be examined.
        candidates: the ends that the present contact may be.
        latched_steps: counts at the first reading of the contact that fulfilled the last watch.
    """

    NO_STATUS: Final = -1

    def __init__(self, motors: int, switch: SwitchInput) -> None:
        self._input = switch
        self._switch = AnyOf(*switch)
        self._watched: Debounced | None = None
        self._watch_hides_switch = False
        self._watch_reacts = False
        self.inference = Inference(motors)
        self.status = 0
        self.quiet_status = self.NO_STATUS
        self.candidates: frozenset[End] = frozenset()
        self.latched_steps: StepCounts | None = None

    @property
    def switch_closed(self) -> bool:
        """Contact, after debouncing."""
        return self._switch.is_true

    @property
    def switch_acts(self) -> bool:
        """There is contact, and no watch of this block takes care of that input itself."""
        return self._switch.is_true and not self._watch_hides_switch

    def begin(self, block: Block) -> None:
        """A block starts: its directions and its watch."""
        self.inference.begin(tuple((n > 0) - (n < 0) for n in block.steps))
        watch = block.watch
        self._watch_hides_switch = bool(watch and watch.mask & self._input.mask)
        self._watch_reacts = bool(watch and watch.action is not WatchAction.IGNORE)
        self._watched = Debounced(watch.mask, watch.value, self._input.readings) if watch else None
        if watch:
            self.latched_steps = None
            self.quiet_status = self.NO_STATUS

    def end(self, now_ns: int) -> None:
        """The block ended, and its watch with it."""
        self.inference.end(now_ns)
        self._watched = None
        self._watch_hides_switch = False

    def take(self, status: int, steps: Callable[[], StepCounts], now_ns: int) -> bool:
        """Take a reading that is not quiet; True when it fulfils the watch of the block."""
        self.status = status
        switch, watched = self._switch, self._watched
        if switch.take(status, steps):
            self.candidates = self.inference.candidates(now_ns) if switch.is_true else frozenset()
        fulfilled = watched is not None and watched.take(status, steps)
        if watched is not None and fulfilled:
            self.latched_steps = watched.latched_steps
            self._watched = None
            self._watch_hides_switch &= self._watch_reacts
        settled = not switch.pending and self._watched is None
        self.quiet_status = status if settled else self.NO_STATUS
        return fulfilled
