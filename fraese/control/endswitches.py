"""End switches and probe: what the inputs mean, which end was met, and what may still move.

As a rule all switches hang on one input. The driver names the ends that a contact may be, from what
moved; inputs that show no contact, and what is known of the position, leave out others:

    driver's candidates, in motor directions --motor_sign--> axis directions --near?--> ends
                                     ends on inputs that show contact ----------'

Rule 1: an end that a referenced position excludes is none. If that leaves nothing, nobody moved
        into an end, and it is any of those that the position allows.
Rule 2: on a closed switch nothing moves but a jog away from it, a reference run, and what the
        operator lets through by ignoring switches.
Rule 3: a probe without a pin of its own shares the end switches' input.
Rule 4: a contact that lasts from one command to the next is the same contact: what was known of it
        is kept, and counts until the input opens. A driver that has just begun knows nothing of it.
Rule 5: an input for referencing is watched in a reference run, and means nothing else.
"""

from collections.abc import Sequence

from fraese.anythread import any_thread
from fraese.blocks import Watch, WatchAction
from fraese.config import Config
from fraese.config.switches import SwitchLine
from fraese.control.position import Position
from fraese.errors import StateError, SwitchAlarm
from fraese.motor.pins import STATUS_PINS
from fraese.motor.seams import End, Report, StepDriver, SwitchMode
from fraese.phrases import joined, phrase

Bits = tuple[int, int]


def line_bits(line: SwitchLine) -> Bits:
    """Mask of an input's bit in the status register, and its value with contact."""
    return _bits(line.pin, bool(line.closed_reads))


def contact_bits(config: Config) -> Bits:
    """The same of all inputs on which contact stops the motors: any of them is enough."""
    mask = value = 0
    for line in config.switch_lines:
        if line.stops:
            bit, closed = line_bits(line)
            mask, value = mask | bit, value | closed
    return mask, value


def probe_bits(config: Config) -> Bits:
    """The same of the probe, which may share the end switches' input."""
    probe, switches = config.probe, config.switches
    if probe.pin is None:
        return _bits(switches.pin, bool(switches.closed_reads))
    return _bits(probe.pin, bool(probe.closed_reads))


def _bits(pin: int, is_set: bool) -> Bits:
    mask = STATUS_PINS[pin].bit
    return mask, mask if is_set else 0


class EndSwitches:
    """The end switches of one machine, and its probe.

    Args:
        config: pins and levels.
        position: what is known of the position.
        driver: told whether a contact stops the motors.
    """

    #: The inputs, as last read.
    _report: Report

    def __init__(self, config: Config, position: Position, driver: StepDriver) -> None:
        self._contact = contact_bits(config)
        self._probe = probe_bits(config)
        # Inputs for referencing come first: where there is one, it is what is looked for.
        self._lines = sorted(config.switch_lines, key=lambda line: line.stops)
        self._reach_mm = 2 * config.homing.pull_off_mm
        self._machine = position.machine
        self._position = position
        self._driver = driver
        self._ignored = config.switches.mode == "ignore"
        self._kept: frozenset[End] = frozenset()

    @property
    def inputs(self) -> int:
        """How many inputs there are on which contact stops the motors."""
        return sum(line.stops for line in self._lines)

    def open(self) -> None:
        """The first word to the driver: whether a contact stops the motors."""
        self.ignore(self._ignored)

    def see(self, report: Report) -> None:
        """Take a report; every one of the driver's comes by here."""
        self._report = report
        if not report.switch_closed:
            self._kept = frozenset()

    # --- the inputs ----------------------------------------------------------------------------

    def watch(self, *, closed: bool, action: WatchAction, end: End | None = None) -> Watch:
        """A watch on the input of an end; without one, for no contact on any input."""
        return _watch(self._contact if end is None else self._bits_of(end), closed, action)

    def pin_of(self, end: End) -> int:
        """Of the input on which an end is looked for, DB25."""
        return self._line_of(end).pin

    def shows(self, end: End) -> bool:
        """Whether the input on which an end is looked for shows contact, as last read."""
        mask, closed = self._bits_of(end)
        if mask == self._contact[0]:
            return self.closed
        return self._report.inputs & mask == closed

    def _line_of(self, end: End) -> SwitchLine:
        name = self.name(end)
        found = next((line for line in self._lines if name in line.ends), None)
        return found or self._lines[-1]

    def _bits_of(self, end: End) -> Bits:
        return line_bits(self._line_of(end))

    def _showing(self) -> frozenset[End]:
        """Ends on inputs that show contact, as last read; all, where none does for the moment."""
        every = self._every()
        names = set[str]()
        for line in self._lines:
            mask, closed = line_bits(line)
            if line.stops and self._report.inputs & mask == closed:
                names |= line.ends
        return frozenset(end for end in every if self.name(end) in names) or every

    def probe_watch(self, *, closed: bool, action: WatchAction) -> Watch:
        """A watch on the probe input."""
        return _watch(self._probe, closed, action)

    @property
    def probe_closed(self) -> bool:
        """Whether the probe touches, as last read."""
        mask, touching = self._probe
        return self._report.inputs & mask == touching

    @property
    def closed(self) -> bool:
        """Contact, as last read."""
        return self._report.switch_closed

    @property
    @any_thread
    def ignored(self) -> bool:
        """Contacts do not stop the motors."""
        return self._ignored

    def ignore(self, ignored: bool) -> None:
        """Let contacts stop the motors, or not."""
        self._ignored = ignored
        self._driver.set_switch_mode(SwitchMode.IGNORE if ignored else SwitchMode.STOP)

    # --- which end -----------------------------------------------------------------------------

    @any_thread
    def ends(self, *, kept: bool = True) -> frozenset[End]:
        """Ends that the present contact may be, in axis directions.

        Args:
            kept: believe what was known when the last command ended.
        """
        axes = self._machine.axes
        candidates = frozenset(
            End(end.motor, end.sign * axes[end.motor].motor_sign) for end in self._report.candidates
        )
        if not candidates:
            return candidates
        every = self._showing()
        near = frozenset(end for end in every if self._is_near(end))
        ends = candidates & near or near or candidates & every or every
        # That it may be any end is no news.
        is_kept = kept and candidates >= every
        return ends & self._kept or ends if is_kept else ends

    def _every(self) -> frozenset[End]:
        """All ends that have a switch."""
        return frozenset(
            End(motor, sign)
            for motor, axis in enumerate(self._machine.axes)
            if axis.has_switches
            for sign in (-1, 1)
        )

    def _is_near(self, end: End) -> bool:
        if not self._position.referenced[end.motor]:
            return True
        axis = self._machine.axes[end.motor]
        limit_mm = axis.high_mm if end.sign > 0 else axis.low_mm
        at_mm = axis.to_mm(self._position.position_steps[end.motor])
        return (limit_mm - at_mm) * end.sign < self._reach_mm

    def name(self, end: End) -> str:
        """As in the original: xmin, xmax, ..."""
        return self._machine.axes[end.motor].name + ("max" if end.sign > 0 else "min")

    @any_thread
    def names(self) -> tuple[str, ...]:
        """Names of the ends that the present contact may be."""
        return tuple(self.name(end) for end in sorted(self.ends()))

    def take_up(self, names: Sequence[str]) -> None:
        """The contact may be one of these ends: so it was known when the last command ended."""
        self._kept = frozenset(end for end in self._every() if self.name(end) in names)

    # --- what may move -------------------------------------------------------------------------

    def require_open(self) -> None:
        """See that no contact stands in the way.

        Raises:
            StateError: if a switch is closed, and not ignored.
        """
        if self.closed and not self._ignored:
            raise StateError(
                phrase(
                    "End switch {in_words} is closed: jog away from it, reference the"
                    " machine, or let switches be ignored; nothing has moved.",
                    in_words=self._in_words(),
                )
            )

    def watch_for_jog(self, motor: int, distance_steps: int) -> Watch | None:
        """What a jog needs in order to leave a closed switch; None: nothing is in its way.

        Raises:
            StateError: if it would not move away from the contact.
        """
        if not self.closed or self._ignored:
            return None
        ends = self.ends()
        sign = 1 if distance_steps > 0 else -1
        if End(motor, sign) in ends or End(motor, -sign) not in ends:
            self.require_open()
        return self.watch(closed=False, action=WatchAction.IGNORE)

    def alarm(self) -> SwitchAlarm:
        """What is to be said after a contact has stopped the motors."""
        return SwitchAlarm(
            phrase(
                "End switch {in_words} closed: stopped at {in_words_2}.",
                in_words=self._in_words(),
                in_words_2=self._position.in_words(),
            ),
            ends=list(self.names()),
        )

    def _in_words(self) -> str:
        return joined(phrase(" or "), self.names()) or phrase("unknown")


def _watch(bits: tuple[int, int], closed: bool, action: WatchAction) -> Watch:
    mask, with_contact = bits
    return Watch(mask, with_contact if closed else mask ^ with_contact, action)
