"""Jogs on top of running jogs: the carriages do what was pressed.

    any thread      press --> [ waits: X 3 | Y -1 ]          brakes nothing, waits for nothing
    run loop        job   --> [ in hand: X+ | X+ ] --> blocks --> driver

Rule 1: presses add up. What waits of one axis becomes one line as soon as its turn comes; another
        axis waits its turn.
Rule 2: the opposite of what is in hand brakes at once, then goes the other way. The press that was
        being made counts as made, so that the axis stays on the grid of what was pressed; but the
        axis never goes on in the old direction for it. What had not begun is left out, and told.
Rule 3: what is held runs on to the limit, and is braked as soon as it is held no more; on an axis
        that is not referenced it is no longer than a jog. It begins behind what waits, and takes
        the place of what its own key was pressed for and has not begun.
Rule 4: of a key that is held, but moves by single widths, no more than one width waits, and when it
        is let go the axis stops at the next whole one.
Rule 5: nothing else is left out without a word (``tell``).
Rule 6: what is pressed in mm is added in mm: no rounding to steps adds up.
"""

import threading
from collections.abc import Callable

from fraese.anythread import any_thread
from fraese.control import lines, softlimits
from fraese.control.about import BY_HAND
from fraese.control.controller import Controller
from fraese.control.heldjog import Hold
from fraese.control.inhand import Hand, Held
from fraese.control.jobs import Job, Standstill
from fraese.control.jograte import JogRate
from fraese.control.presses import Group, Press, Waiting
from fraese.errors import FraeseError
from fraese.machine import three_decimals
from fraese.phrases import phrase

#: Of a held key, at widths that are finer than this, so much may wait.
_HELD_MM = 0.5


class Jogs:
    """Presses of jog keys, and the job that works them off.

    Args:
        controller: the machine.
        tell: told what a person should know, a sentence,
        refuse: and what was not done, likewise; both are called in the run loop's thread.

    Attributes:
        rate: how fast they go.
    """

    def __init__(
        self,
        controller: Controller,
        tell: Callable[[str], object],
        refuse: Callable[[str], object],
    ) -> None:
        self._controller = controller
        self._tell = tell
        self._refuse = refuse
        self._axes = controller.machine.axes
        self.rate = JogRate(controller)
        self._lock = threading.Lock()
        self._waiting = Waiting(self._axes)
        self._hand: Hand | None = None
        self._held: Held | None = None
        self._is_turned = False
        # Presses that were left out when it was turned; None: that is no news.
        self._left_out: int | None = None
        # Which job works off what waits; another one has no right to it any more.
        self._job: object | None = None
        # Where each axis came to rest by what was pressed: in steps, and not rounded.
        self._rests: dict[int, tuple[int, float]] = {}

    # --- from any thread -----------------------------------------------------------------------

    @any_thread
    def press(self, name: str, *, steps: int = 0, mm: float = 0.0, held: bool = False) -> bool:
        """Let this be done in its turn; whether there is a job that does it.

        Args:
            name: of the axis,
            steps: which is to go so far,
            mm: or so far.
            held: it comes from a key that is held down.
        """
        press = Press(self._controller.machine.index(name), steps, mm)
        with self._lock:
            hand, axis = self._hand, self._axes[press.motor]
            way = press.way_steps(axis)
            self._end_hold()
            if hand is not None and hand.hold is not None:
                self._waiting.add(press)
            elif self._is_turned and hand is not None and press.motor == hand.motor:
                self._waiting.add_first(press)
            elif hand is not None and press.motor == hand.motor and way * hand.sign < 0:
                self._turn(hand)
                self._waiting.add_first(press)
            elif not (held and self._is_enough(press)):
                self._waiting.add(press)
            return self._job is not None

    @any_thread
    def hold(self, name: str, sign: int, hold: Hold) -> bool:
        """Let this axis run in its turn, for as long as it is held; whether there is a job for it.

        Args:
            name: of the axis,
            sign: and which way.
            hold: says whether it is held.
        """
        with self._lock:
            self._end_hold()
            motor = self._controller.machine.index(name)
            if not self._is_turned:
                self._waiting.drop(motor, sign)
            self._held = Held(motor, sign, hold)
            return self._job is not None

    @any_thread
    def let_go(self) -> None:
        """A held key was let go: brake, or stop at the next whole width."""
        with self._lock:
            self._end_hold()
            hand = self._hand
            if hand is None or hand.hold is not None:
                return
            if not self._is_turned and self._has_more(hand):
                self._waiting.drop(hand.motor, hand.sign)
                self._waiting.turn(hand.motor)
                self._is_turned = True

    @any_thread
    def forget(self) -> None:
        """After a stop: nothing waits any more."""
        with self._lock:
            self._clear()

    @property
    @any_thread
    def waiting(self) -> tuple[tuple[str, int], ...]:
        """What waits: names of axes, and how many presses, signed."""
        with self._lock:
            return tuple((self._axes[motor].name, n) for motor, n in self._waiting.counts())

    def _end_hold(self) -> None:
        if self._held is not None:
            self._held.hold.let_go()

    def _turn(self, hand: Hand) -> None:
        self._left_out = self._waiting.drop(hand.motor, hand.sign)
        self._waiting.turn(hand.motor)
        self._is_turned = True

    def _is_enough(self, press: Press) -> bool:
        """Of a held key so much waits already."""
        axis, waits = self._axes[press.motor], self._waiting.of_axis(press.motor)
        way_mm = sum(abs(each.way_steps(axis)) for each in (*waits, press)) * axis.step_mm
        return bool(waits) and way_mm > _HELD_MM

    def _has_more(self, hand: Hand) -> bool:
        return len(hand.ends_steps) > 1 or bool(self._waiting.of_axis(hand.motor))

    # --- from the run loop's thread ------------------------------------------------------------

    def start(self) -> None:
        """Take up what waits as a job; ``run`` works it off. What is refused is told.

        Raises:
            StateError: if the machine is not ready; nothing waits any more.
        """
        job = object()
        try:
            self._controller.require_ready()
            with self._lock:
                self._job = job
            hand = self._next(job)
            if hand is not None:
                self._controller.start(phrase("jog"), self._work(job, hand), BY_HAND)
        except FraeseError:
            self.forget()
            raise

    def _work(self, job: object, hand: Hand | None) -> Job:
        where, rate = self._controller.position, self.rate
        try:
            while hand is not None:
                yield from lines.line_to(where, hand.target, rate.feed_mm_min, hand.watch)
                yield Standstill(cut=self._cuts(job, hand))
                self._put_down(job, hand)
                hand = self._next(job)
        finally:
            with self._lock:
                if self._job is job:
                    self._clear()

    def _cuts(self, job: object, hand: Hand) -> Callable[[], bool]:
        """Says whether what is in hand is to end at once."""

        def is_over() -> bool:
            let_go = hand.hold is not None and not hand.hold.is_held
            return self._job is job and (let_go or self._is_turned)

        return is_over

    def _next(self, job: object) -> Hand | None:
        """What is to be done now; None: nothing any more."""
        while True:
            with self._lock:
                if self._job is not job:
                    return None
                if not self._waiting and self._held is None:
                    self._clear()
                    return None
                try:
                    if self._waiting:
                        self._hand = self._aimed(self._waiting.take())
                    else:
                        self._hand = self._taken_hold()
                except FraeseError as error:
                    self._hand, refused = None, str(error)
                else:
                    if self._hand is not None:
                        return self._hand
                    continue
            self._refuse(refused)

    def _clear(self) -> None:
        self._end_hold()
        self._waiting.clear()
        self._job = self._hand = self._held = None
        self._is_turned, self._left_out = False, None

    def _aimed(self, group: Group) -> Hand | None:
        """What a group asks for from here, no longer than a jog may be; None: nothing.

        Raises:
            LimitError: if the axis stands at its limit already.
            StateError: if it would move into a closed switch.
        """
        motor, jog = group.motor, self._controller.config.jog
        axis, where = self._axes[motor], self._controller.position
        here = where.position_steps[motor]
        rest_steps, at_mm = self._rests.get(motor, (here, axis.to_mm(here)))
        if rest_steps != here:
            at_mm = axis.to_mm(here)
        ends_mm = [at_mm] if not group.presses else []
        for press in group.presses:
            at_mm += press.way_steps(axis) * axis.step_mm
            if ends_mm and abs(axis.to_steps(at_mm) - here) > axis.to_steps(jog.max_mm):
                break
            ends_mm.append(at_mm)
        self._waiting.put_back(Group(motor, group.presses[len(ends_mm) :]))
        ends_steps = tuple(axis.to_steps(mm) for mm in ends_mm)
        distance_steps = ends_steps[-1] - here
        if not distance_steps:
            self._rests[motor] = here, ends_mm[-1]
            return None
        target = softlimits.jog_target(where, motor, distance_steps, jog.max_mm, clamp=True)
        watch = self._controller.switches.watch_for_jog(motor, distance_steps)
        sign = 1 if distance_steps > 0 else -1
        return Hand(motor, sign, ends_steps, tuple(ends_mm), target, watch)

    def _taken_hold(self) -> Hand | None:
        """What is held, if it still is.

        Raises:
            LimitError: if the axis stands at its limit.
            StateError: if it would move into a closed switch.
        """
        held, self._held = self._held, None
        if held is None or not held.hold.is_held:
            return None
        motor, sign = held.motor, held.sign
        axis, where = self._axes[motor], self._controller.position
        longest_mm = self._controller.config.jog.max_mm
        if where.referenced[motor] and not axis.is_endless:
            longest_mm = max(longest_mm, axis.high_mm - axis.low_mm)
        way_steps = sign * axis.to_steps(longest_mm)
        target = softlimits.jog_target(where, motor, way_steps, longest_mm, clamp=True)
        watch = self._controller.switches.watch_for_jog(motor, way_steps)
        self._held = held
        return Hand(motor, sign, (), (), target, watch, held.hold)

    def _put_down(self, job: object, hand: Hand) -> None:
        """It has come to rest: at its end, at the limit, or where it was turned."""
        with self._lock:
            if self._job is not job:
                return
            if hand.hold is not None:
                told = self._dropped(hand, hand.hold)
            else:
                told = self._turned(hand) if self._is_turned else self._ended(hand)
            self._hand, self._is_turned = None, False
        if told:
            self._tell(told)

    def _dropped(self, hand: Hand, hold: Hold) -> str:
        """What was held came to rest; something is to be said if that was not by letting it go."""
        self._rests.pop(hand.motor, None)
        is_its = self._held is not None and self._held.hold is hold
        if is_its:
            self._held = None
        if self._here(hand) != hand.target[hand.motor] or not hold.is_held:
            return ""
        hold.let_go()
        name, where = self._axes[hand.motor].name.upper(), self._controller.position
        if where.referenced[hand.motor]:
            return phrase("{name} has stopped at its soft limit.", name=name)
        return phrase(
            "{name} is not referenced: held, it goes no further than a jog (jog.max_mm).",
            name=name,
        )

    def _ended(self, hand: Hand) -> str:
        """At its end, or at the limit; what is to be said of that."""
        axis, here = self._axes[hand.motor], self._here(hand)
        self._rests[hand.motor] = here, hand.ends_mm[-1]
        if here == hand.ends_steps[-1] or here != hand.target[hand.motor]:
            return ""
        del self._rests[hand.motor]
        waits = self._waiting.of_axis(hand.motor)
        self._waiting.drop(hand.motor, hand.sign)
        short_mm = abs(hand.ends_mm[-1] - axis.to_mm(here)) + sum(
            abs(press.way_steps(axis)) * axis.step_mm
            for press in waits
            if press.way_steps(axis) * hand.sign > 0
        )
        name, short = axis.name.upper(), axis.with_unit(three_decimals(short_mm))
        return phrase(
            "{name} has stopped at its soft limit, {short} short of what was pressed.",
            name=name,
            short=short,
        )

    def _turned(self, hand: Hand) -> str:
        """Where it came to rest when the opposite key was pressed, or the held key let go."""
        axis, here, sign = self._axes[hand.motor], self._here(hand), hand.sign
        beyond = [n for n, end in enumerate(hand.ends_steps) if (end - here) * sign >= 0]
        if not beyond:
            return ""
        end_mm = hand.ends_mm[beyond[0]]
        self._rests[hand.motor] = here, end_mm
        way_steps = self._waiting.first_way(axis)
        if way_steps * sign < 0 and (end_mm / axis.step_mm + way_steps - here) * sign > 0:
            # Never on in the old direction.
            del self._rests[hand.motor]
        left_out, self._left_out = self._left_out, None
        if left_out is None or not (gone := left_out + len(beyond) - 1):
            return ""
        sense = "+" if sign > 0 else "−"
        turned = axis.name.upper() + sense
        if gone == 1:
            return phrase(
                "{turned} was turned round: 1 press that had not begun is left out.", turned=turned
            )
        return phrase(
            "{turned} was turned round: {gone} presses that had not begun are left out.",
            turned=turned,
            gone=gone,
        )

    def _here(self, hand: Hand) -> int:
        return self._controller.position.position_steps[hand.motor]
