"""The mechanics of a simulated mill: rotors, carriages and end switches, in half-steps.

Rule 1: a rotor turns to the nearest angle that the field asks for. The field and the rotor are
        both counted without wrapping; what lies between them is lost.
Rule 2: a rotor follows while its rate stays under its maximum, and while from one electrical turn
        to the next the rate changes by no more than its start/stop rate plus what its
        acceleration allows. Judged over eight half-steps, so that the uneven beat of a minor axis
        is not taken for a jerk; inertia smooths that in a real one too.
Rule 3: beyond that it stalls: it stays where it is until the field is slow enough to catch it
        again, a whole number of electrical turns away. So does a rotor that a hand or a missing
        current kept from following, if the field is fast by the time that it is free.
Rule 4: a rotor whose field stops dead above the start/stop rate overshoots by one turn. How fast
        it was at the end is judged from the last steps, in its favour: as if it had braked.
Rule 5: a carriage sits on its rotor. At the mechanical end it cannot go on; the rotor slips.
Rule 6: a switch closes at its end of travel, some time after the carriage got there, and bounces
        for some readings.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from fraese.motor.seams import End

#: Half-steps in one electrical turn: what a slipping rotor loses at a time.
TURN_STEPS: Final = 8
_NS_PER_S: Final = 1_000_000_000
#: A window of eight beats of a minor axis is uneven by up to one step.
_UNEVEN_STEPS: Final = 1.0
#: A rotor that runs too fast slips when its field is further ahead than this.
_MAX_LAG_STEPS: Final = 1.5
#: A motor's limits are not sharper than this.
_FUZZ: Final = 1.15


@dataclass(frozen=True, slots=True)
class RotorLimits:
    """What a motor can follow.

    Attributes:
        max_rate_hz: above it the motor hums, warms and does not move.
        jump_hz: start/stop rate.
        acceleration_hz_s: change of rate that the torque allows.
        snaps_to_pole: without current it turns to the nearest pole; else friction holds it.
    """

    max_rate_hz: float = 6000.0
    jump_hz: float = 1200.0
    acceleration_hz_s: float = 60_000.0
    snaps_to_pole: bool = False


class Rotor:
    """One motor and the carriage on its spindle.

    Attributes:
        field_steps: what the field asked for since the start, unwrapped.
        position_steps: where it holds its carriage, from the lower end of the travel.
        low_steps: the mechanical ends of the carriage's way,
        high_steps: a little behind the switches.
        blocked: somebody holds the carriage.
        powered: there is current in the coils.
    """

    __slots__ = (
        "_before_s", "_count", "_jump_hz", "_lag", "_loose", "_mark_ns", "_net", "_offset",
        "_rate_hz", "_rest_ns", "_seen_ns", "_stalled", "blocked", "field_steps", "high_steps",
        "limits", "low_steps", "position_steps", "powered",
    )  # fmt: skip

    def __init__(
        self, position_steps: float, low_steps: float, high_steps: float, limits: RotorLimits
    ) -> None:
        self.limits = limits
        self.low_steps = low_steps
        self.high_steps = high_steps
        self.blocked = False
        self.powered = False
        self._jump_hz = limits.jump_hz
        self._rest_ns = round(4 * _NS_PER_S / limits.jump_hz)
        self._seen_ns = -self._rest_ns - 1
        self.place(position_steps)

    def place(self, position_steps: float) -> None:
        """Put the carriage somewhere, the rotor in step with the field."""
        self.position_steps = position_steps
        self.field_steps = 0.0
        self._offset = position_steps
        self._loose = False
        self._stalled = False
        self._begin_window(self._seen_ns)

    @property
    def lost_steps(self) -> float:
        """Field ahead of rotor since it was placed; negative after an overshoot forward."""
        return self.field_steps - (self.position_steps - self._offset)

    def set_lost(self, lost_steps: float) -> None:
        """Take up a loss from an earlier run."""
        self.field_steps = lost_steps
        self._loose = bool(lost_steps % TURN_STEPS)

    def turn(self, delta: float, now_ns: int) -> None:
        """The field turned by ``delta`` half-steps, -4 to +4."""
        if now_ns - self._seen_ns > self._rest_ns:
            self._come_to_rest(now_ns)
        else:
            self._net += delta
            self._count += 1
            if self._count == TURN_STEPS:
                self._judge(now_ns)
        self._seen_ns = now_ns
        self.field_steps += delta
        if self._loose or not -4 < delta < 4:
            self.relock()
            return
        target = self.position_steps + delta
        if self.low_steps <= target <= self.high_steps and not self.blocked:
            self.position_steps = target
        else:
            self._loose = True

    def settle(self, now_ns: int) -> None:
        """Somebody looks: a rotor that has had no step for a while has come to rest."""
        if now_ns - self._seen_ns > self._rest_ns:
            self._come_to_rest(self._seen_ns)

    def relock(self) -> None:
        """Turn towards the nearest angle that the field asks for, as far as nothing hinders it."""
        self._loose = True
        if self._stalled or self.blocked or not self.powered:
            return
        half = TURN_STEPS / 2
        error = (self.lost_steps + half) % TURN_STEPS - half
        if error == -half:
            return  # the field pulls both ways
        target = self.position_steps + error
        self.position_steps = min(max(target, self.low_steps), self.high_steps)
        self._loose = self.position_steps != target

    def energise(self) -> None:
        """Current comes on."""
        self.powered = True
        self.relock()

    def release(self) -> None:
        """The current is gone, whether the rotor stood or not."""
        self._come_to_rest(self._seen_ns)
        self.powered = False
        self._loose = True
        if self.limits.snaps_to_pole and not self.blocked:
            self.position_steps -= (self.position_steps - self._offset) % 2

    def _begin_window(self, now_ns: int) -> None:
        self._mark_ns = now_ns
        self._count = 0
        self._net = self._rate_hz = self._lag = self._before_s = 0.0

    def _rate_before_rest_hz(self) -> float:
        """Signed rate at the last step, leaving out unevenness and what braking may have shed."""
        took_ns = self._seen_ns - self._mark_ns
        if self._count < TURN_STEPS // 2 or took_ns <= 0:
            mean_hz, steps_since = self._rate_hz, TURN_STEPS / 2 + self._count
        else:
            sure = max(0.0, abs(self._net) - _UNEVEN_STEPS)
            mean_hz = math.copysign(sure, self._net) * _NS_PER_S / took_ns
            steps_since = self._count / 2
        squared = mean_hz**2 - 2 * self.limits.acceleration_hz_s * steps_since
        return math.copysign(math.sqrt(max(0.0, squared)), mean_hz)

    def _come_to_rest(self, now_ns: int) -> None:
        """No step for a while: how did it stop? What comes next starts from rest."""
        rate_hz = self._rate_before_rest_hz()
        if abs(rate_hz) > _FUZZ * self._jump_hz and not self._loose:
            target = self.position_steps + (TURN_STEPS if rate_hz > 0 else -TURN_STEPS)
            if self.low_steps <= target <= self.high_steps:
                self.position_steps = target
        self._begin_window(now_ns)
        if self._stalled:
            self._stalled = False
            self.relock()

    def _judge(self, now_ns: int) -> None:
        """Eight steps later: could the rotor follow?"""
        took_s = (now_ns - self._mark_ns) / _NS_PER_S
        net, limits = self._net, self.limits
        if self._stalled:
            if abs(net) <= self._jump_hz * took_s:
                self._stalled = False
        else:
            between_s = (self._before_s + took_s) / 2
            may_gain = (self._jump_hz + limits.acceleration_hz_s * between_s) * took_s
            before = self._rate_hz * took_s
            # A reversal passes through rest: it must be able to stop, and then to start.
            jerk = abs(net - before) if net * before >= 0 else max(abs(net), abs(before))
            self._lag = max(0.0, self._lag + abs(net) - limits.max_rate_hz * took_s)
            too_fast_to_catch = self._loose and abs(net) > _FUZZ * self._jump_hz * took_s
            if jerk > may_gain + _UNEVEN_STEPS or self._lag > _MAX_LAG_STEPS or too_fast_to_catch:
                self._stalled = self._loose = True
        self._rate_hz = net / took_s if took_s else 0.0
        self._before_s = took_s
        self._mark_ns = now_ns
        self._count = 0
        self._net = 0.0


class Contacts:
    """All end switches in parallel on one line, with lag and bounce.

    Args:
        lag_s: from the carriage's arrival to the contact, and likewise for leaving.
        bounce_readings: readings after a change that alternate between new and old.

    Attributes:
        closed: the line, when it has stopped bouncing.
        still: nothing is on its way; ``closed`` is the reading.
    """

    def __init__(self, lag_s: float, bounce_readings: int) -> None:
        self._lag_ns = round(lag_s * _NS_PER_S)
        self._bounce_readings = bounce_readings
        self._pressed: dict[End, int] = {}
        self._leaving_until_ns = 0
        self.closed = False
        self._bouncing = 0
        self.still = True

    @property
    def any_pressed(self) -> bool:
        """Some switch is held down."""
        return bool(self._pressed)

    def pressed(self) -> frozenset[End]:
        """Switches that are held down now."""
        return frozenset(self._pressed)

    def change(self, end: End, pressed: bool, now_ns: int) -> None:
        """A switch is pressed or let go."""
        if pressed == (end in self._pressed):
            return
        self.still = False
        if pressed:
            self._pressed[end] = now_ns
        else:
            del self._pressed[end]
            self._leaving_until_ns = now_ns + self._lag_ns

    def read(self, now_ns: int) -> bool:
        """One reading of the line."""
        arrived = any(now_ns - since >= self._lag_ns for since in self._pressed.values())
        closed = arrived or now_ns < self._leaving_until_ns
        if closed != self.closed:
            self.closed = closed
            self._bouncing = self._bounce_readings
        reading = self.closed
        if self._bouncing:
            # New and old in turn; the last one that bounces is old.
            reading ^= self._bouncing % 2 == 1
            self._bouncing -= 1
        settled = all(now_ns - since >= self._lag_ns for since in self._pressed.values())
        self.still = settled and not self._bouncing and now_ns >= self._leaving_until_ns
        return reading


class Mill:
    """Rotors, carriages and switches of a machine; what a person sees and can do.

    Args:
        travel_steps: from switch to switch, per motor.
        limits: what each motor can follow.
        overrun_steps: from a switch to the mechanical end behind it.
        lag_s: see ``Contacts``.
        bounce_readings: see ``Contacts``.
        backlash_steps: how far a rotor turns back before its carriage follows, per motor.
    """

    def __init__(
        self,
        travel_steps: Sequence[int],
        limits: Sequence[RotorLimits],
        overrun_steps: int = 400,
        lag_s: float = 0.0,
        bounce_readings: int = 0,
        backlash_steps: Sequence[int] = (),
    ) -> None:
        self.travel_steps = tuple(travel_steps)
        self.rotors = [
            Rotor(travel // 2, -overrun_steps, travel + overrun_steps, limit)
            for travel, limit in zip(travel_steps, limits, strict=True)
        ]
        self.contacts = Contacts(lag_s, bounce_readings)
        self._backlash_steps = tuple(backlash_steps) or (0,) * len(self.rotors)
        self._has_backlash = any(self._backlash_steps)
        # Carriage ahead of rotor: between nothing and the backlash.
        self._slack_steps = [0.0] * len(self.rotors)
        self._by_hand: set[End] = set()

    def turn(self, motor: int, delta: float, now_ns: int) -> None:
        """The field of a motor turned."""
        rotor = self.rotors[motor]
        if self._has_backlash:
            before_steps = rotor.position_steps
            rotor.turn(delta, now_ns)
            self._drag(motor, rotor.position_steps - before_steps)
        else:
            rotor.turn(delta, now_ns)
        position_steps = rotor.position_steps + self._slack_steps[motor]
        if not 0 < position_steps < self.travel_steps[motor] or self.contacts.any_pressed:
            self.feel(motor, now_ns)

    def _drag(self, motor: int, turned_steps: float) -> None:
        """The rotor turns within the play before its carriage follows."""
        slack_steps = self._slack_steps[motor] - turned_steps
        self._slack_steps[motor] = min(max(slack_steps, 0.0), self._backlash_steps[motor])

    def set_slack(self, slack_steps: Sequence[float]) -> None:
        """Take up the play as it was left; the carriages stay where they are."""
        self._slack_steps[:] = slack_steps

    def slack_steps(self) -> tuple[float, ...]:
        """Carriage ahead of rotor, per motor."""
        return tuple(self._slack_steps)

    def feel(self, motor: int, now_ns: int) -> None:
        """Press or leave the switches of one carriage."""
        position_steps = self.rotors[motor].position_steps + self._slack_steps[motor]
        for end, at_end in (
            (End(motor, -1), position_steps <= 0),
            (End(motor, 1), position_steps >= self.travel_steps[motor]),
        ):
            self.contacts.change(end, at_end or end in self._by_hand, now_ns)

    def carriages_steps(self) -> tuple[float, ...]:
        """Where the carriages are, from the lower switch."""
        return tuple(
            rotor.position_steps + slack
            for rotor, slack in zip(self.rotors, self._slack_steps, strict=True)
        )

    def lost_steps(self) -> tuple[float, ...]:
        """Half-steps that were asked for and not made, per motor."""
        return tuple(rotor.lost_steps for rotor in self.rotors)

    def pressed(self) -> frozenset[End]:
        """Switches that are pressed, by a carriage or by hand."""
        return self.contacts.pressed()

    def press(self, end: End, now_ns: int = 0) -> None:
        """Press a switch by hand."""
        self._by_hand.add(end)
        self.feel(end.motor, now_ns)

    def let_go(self, end: End, now_ns: int = 0) -> None:
        """Take the hand off a switch."""
        self._by_hand.discard(end)
        self.feel(end.motor, now_ns)

    def block(self, motor: int, blocked: bool = True) -> None:
        """Hold a carriage, or let it go."""
        self.rotors[motor].blocked = blocked

    def place(self, motor: int, position_steps: float, now_ns: int = 0) -> None:
        """Put a carriage somewhere, before the work begins."""
        self.rotors[motor].place(position_steps)
        self.feel(motor, now_ns)
