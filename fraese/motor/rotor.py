"""One simulated motor: its rotor follows a field, in half-steps, as far as it can.

Rule 1: a rotor turns to the nearest angle that the field asks for. The field and the rotor are
        both counted without wrapping; what lies between them is lost.
Rule 2: a rotor follows while its rate stays under its maximum, and while from one electrical turn
        to the next the rate changes by no more than its start/stop rate plus what its
        acceleration allows. Judged over eight steps, or one electrical turn where a step is less
        than a half-step, so that the uneven beat of a minor axis is not taken for a jerk; inertia
        smooths that in a real one too.
Rule 3: beyond that it stalls: it stays where it is until the field is slow enough to catch it
        again, a whole number of electrical turns away. So does a rotor that a hand or a missing
        current kept from following, if the field is fast by the time that it is free.
Rule 4: a rotor whose field stops dead above the start/stop rate overshoots by one turn. How fast
        it was at the end is judged from the last steps, in its favour: as if it had braked.
Rule 5: a carriage sits on its rotor. At the mechanical end it cannot go on; the rotor slips.
Rule 6: a rotor remembers what first kept it from following, until somebody has been told, or until
        it has caught up with nothing lost.
Rule 7: in a band of rates a rotor resonates: it swings itself up while it stays there, and then
        falls out of step. What passes through leaves no swing behind.
Rule 8: angles are whole parts of a power of two, so that sums of them are exact.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Final

from fraese.motor.phases import TURN_STEPS
from fraese.phrases import phrase

_NS_PER_S: Final = 1_000_000_000
#: A rate is judged over so many steps at least.
_WINDOW: Final = 8
#: A window of beats of a minor axis is uneven by up to one step, and never judged finer than this.
_UNEVEN_STEPS: Final = 1.0
#: A rotor that runs too fast slips when its field is further ahead than this.
_MAX_LAG_STEPS: Final = 1.5
#: A motor's limits are not sharper than this.
_FUZZ: Final = 1.15
#: In a band in which it resonates, a rotor falls out of step after so long.
_SWINGS_UP_S: Final = 0.06


class Hindrance(Enum):
    """What keeps a rotor from following its field."""

    TOO_FAST = phrase("too fast")
    TOO_STEEP = phrase("too steep")
    STOPPED_DEAD = phrase("stopped too suddenly")
    BLOCKED = "blocked"
    AT_END = phrase("at the mechanical end")
    NO_CURRENT = phrase("without current")
    JUMP = phrase("its field jumped")
    RESONANCE = "resonance"


@dataclass(frozen=True, slots=True)
class RotorLimits:
    """What a motor can follow; rates in half-steps.

    Attributes:
        max_rate_hz: above it the motor hums, warms and does not move.
        jump_hz: start/stop rate.
        acceleration_hz_s: change of rate that the torque allows.
        snaps_to_pole: without current it turns to the nearest pole; else friction holds it.
        resonances_hz: bands of rates in which it cannot stay, from below to above.
    """

    max_rate_hz: float = 6000.0
    jump_hz: float = 1200.0
    acceleration_hz_s: float = 60_000.0
    snaps_to_pole: bool = False
    resonances_hz: tuple[tuple[float, float], ...] = ()


class Rotor:
    """One motor and the carriage on its spindle.

    Attributes:
        field_steps: what the field asked for since the start, unwrapped.
        position_steps: where it holds its carriage, from the lower end of the travel.
        low_steps: the mechanical ends of the carriage's way,
        high_steps: a little behind the switches.
        blocked: somebody holds the carriage.
        powered: there is current in the coils.
        hindrance: what first kept it from following since ``forget``; None: nothing did.

    Args:
        position_steps: where it stands.
        low_steps: the mechanical ends of the carriage's way, which may be infinite,
        high_steps: from below to above.
        limits: what it can follow.
        steps_in_turn: steps in which its field makes one electrical turn.
    """

    __slots__ = (
        "_before_s", "_count", "_forgiven", "_jump_hz", "_lag", "_loose", "_mark_ns", "_net",
        "_offset", "_rate_hz", "_rest_ns", "_seen_ns", "_stalled", "_step", "_swung_s", "_uneven",
        "_window",
        "blocked", "field_steps", "high_steps", "hindrance", "limits", "low_steps",
        "position_steps", "powered",
    )  # fmt: skip

    def __init__(
        self,
        position_steps: float,
        low_steps: float,
        high_steps: float,
        limits: RotorLimits,
        steps_in_turn: int = TURN_STEPS,
    ) -> None:
        self.limits = limits
        self._window = max(_WINDOW, steps_in_turn)
        self._step = TURN_STEPS / steps_in_turn
        self._uneven = max(_UNEVEN_STEPS, self._step)
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
        self.forget()
        self._begin_window(self._seen_ns)

    @property
    def lost_steps(self) -> float:
        """Field ahead of rotor since it was placed; negative after an overshoot forward."""
        return self.field_steps - (self.position_steps - self._offset)

    def set_lost(self, lost_steps: float) -> None:
        """Take up a loss from an earlier run."""
        self.field_steps = lost_steps
        self._loose = bool(lost_steps % TURN_STEPS)
        self.forget()

    @property
    def missed_steps(self) -> float:
        """What it has lost since ``forget``."""
        return self.lost_steps - self._forgiven

    def forget(self) -> None:
        """What is lost so far has been told; from here on it counts anew."""
        self._forgiven = self.lost_steps
        self.hindrance: Hindrance | None = None

    def turn(self, delta: float, now_ns: int) -> None:
        """The field turned by ``delta`` half-steps, -4 to +4."""
        if now_ns - self._seen_ns > self._rest_ns:
            self._come_to_rest(now_ns)
        else:
            self._net += delta
            self._count += 1
            if self._count == self._window:
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
            self._blame(Hindrance.BLOCKED if self.blocked else Hindrance.AT_END)

    def settle(self, now_ns: int) -> None:
        """Somebody looks: a rotor that has had no step for a while has come to rest."""
        if now_ns - self._seen_ns > self._rest_ns:
            self._come_to_rest(self._seen_ns)

    def rest(self) -> None:
        """No step will follow for a while."""
        self._come_to_rest(self._seen_ns)

    def relock(self) -> None:
        """Turn towards the nearest angle that the field asks for, as far as nothing hinders it."""
        self._loose = True
        if self._stalled or self.blocked or not self.powered:
            # A stall has been blamed already.
            if not self._stalled:
                self._blame(Hindrance.BLOCKED if self.blocked else Hindrance.NO_CURRENT)
            return
        half = TURN_STEPS / 2
        error = (self.lost_steps + half) % TURN_STEPS - half
        if error == -half:
            self._blame(Hindrance.JUMP)
            return  # the field pulls both ways
        target = self.position_steps + error
        self.position_steps = min(max(target, self.low_steps), self.high_steps)
        self._loose = self.position_steps != target
        if self._loose:
            self._blame(Hindrance.AT_END)
        elif self.lost_steps == self._forgiven:
            self.hindrance = None

    def _blame(self, hindrance: Hindrance) -> None:
        self.hindrance = self.hindrance or hindrance

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
        self._swung_s = 0.0
        self._net = self._rate_hz = self._lag = self._before_s = 0.0

    def _rate_before_rest_hz(self) -> float:
        """Signed rate at the last step, leaving out unevenness and what braking may have shed."""
        took_ns = self._seen_ns - self._mark_ns
        if self._count < self._window // 2 or took_ns <= 0:
            mean_hz, beats_since = self._rate_hz, self._window / 2 + self._count
        else:
            sure = max(0.0, abs(self._net) - self._uneven)
            mean_hz = math.copysign(sure, self._net) * _NS_PER_S / took_ns
            beats_since = self._count / 2
        squared = mean_hz**2 - 2 * self.limits.acceleration_hz_s * beats_since * self._step
        return math.copysign(math.sqrt(max(0.0, squared)), mean_hz)

    def _come_to_rest(self, now_ns: int) -> None:
        """No step for a while: how did it stop? What comes next starts from rest."""
        rate_hz = self._rate_before_rest_hz()
        if abs(rate_hz) > _FUZZ * self._jump_hz and not self._loose:
            target = self.position_steps + (TURN_STEPS if rate_hz > 0 else -TURN_STEPS)
            if self.low_steps <= target <= self.high_steps:
                self.position_steps = target
                self._blame(Hindrance.STOPPED_DEAD)
        self._begin_window(now_ns)
        if self._stalled:
            self._stalled = False
            self.relock()

    def _resonates(self, rate_hz: float, took_s: float) -> bool:
        """Whether it has swung itself up, a window in which it kept this rate later."""
        inside = any(low_hz < rate_hz < high_hz for low_hz, high_hz in self.limits.resonances_hz)
        self._swung_s = self._swung_s + took_s if inside else 0.0
        return self._swung_s > _SWINGS_UP_S

    def _judge(self, now_ns: int) -> None:
        """A window of steps later: could the rotor follow?"""
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
            if limits.resonances_hz and self._resonates(abs(net) / took_s if took_s else 0, took_s):
                self._stalled = self._loose = True
                self._blame(Hindrance.RESONANCE)
            elif jerk > may_gain + self._uneven or self._lag > _MAX_LAG_STEPS or too_fast_to_catch:
                self._stalled = self._loose = True
                too_fast = abs(net) > limits.max_rate_hz * took_s + self._uneven
                behind = too_fast or too_fast_to_catch or self._lag > _MAX_LAG_STEPS
                self._blame(Hindrance.TOO_FAST if behind else Hindrance.TOO_STEEP)
        self._rate_hz = net / took_s if took_s else 0.0
        self._before_s = took_s
        self._mark_ns = now_ns
        self._count = 0
        self._net = 0.0
