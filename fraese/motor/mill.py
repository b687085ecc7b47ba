"""The mechanics of a simulated mill: rotors with their carriages, and the switches they press.

Rule 1: a carriage follows its rotor, after the rotor has turned through the backlash.
Rule 2: a switch is pressed by a carriage at its end of travel or beyond, or by hand.
Rule 3: switches are felt after every movement that may have changed them: at or beyond an end, and
        everywhere while one is pressed.
Rule 4: a switch does not close at quite the same place every time. By how much it is off is drawn
        when the carriage has got clear of it, from numbers that are the same in every run.
Rule 5: everything here is counted in half-steps of the motor, and in its direction: which way that
        moves a carriage, and how far in millimetres, is known further up.
"""

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from fraese.motor.contacts import Contacts
from fraese.motor.phases import TURN_STEPS
from fraese.motor.rotor import Rotor, RotorLimits
from fraese.motor.seams import End

#: So many standard deviations from where a switch should close it is not felt any more.
_CLEAR: Final = 5


@dataclass(frozen=True, slots=True)
class Slide:
    """A motor and what it moves, in half-steps of the motor.

    Attributes:
        travel_steps: from one end to the other; infinite: it turns endlessly.
        limits: what the motor can follow.
        overrun_steps: from an end of the travel to the mechanical end behind it.
        backlash_steps: how far the rotor turns back before its carriage follows.
        has_switches: an end switch at both ends of the travel.
        steps_in_turn: steps of the electronics in which the field makes one electrical turn.
        scatter_steps: standard deviation of where its switches close.
    """

    travel_steps: float
    limits: RotorLimits = field(default_factory=RotorLimits)
    overrun_steps: float = 400
    backlash_steps: float = 0
    has_switches: bool = True
    steps_in_turn: int = TURN_STEPS
    scatter_steps: float = 0

    @property
    def middle_steps(self) -> int:
        """Where the carriage of a new machine stands."""
        return 0 if math.isinf(self.travel_steps) else int(self.travel_steps // 2)

    @property
    def ends_steps(self) -> tuple[float, float]:
        """The mechanical ends."""
        if math.isinf(self.travel_steps):
            return -math.inf, math.inf
        return -self.overrun_steps, self.travel_steps + self.overrun_steps

    @property
    def switches_steps(self) -> tuple[float, float]:
        """From where on the carriage presses its switches, downwards and upwards."""
        if self.has_switches and not math.isinf(self.travel_steps):
            return 0, self.travel_steps
        return -math.inf, math.inf


class Mill:
    """Rotors, carriages and switches of a machine; what a person sees and can do.

    Args:
        slides: one for each motor.
        lag_s: see ``Contacts``.
        bounce_readings: see ``Contacts``.
        own_lines: ends whose switches are on lines of their own, a set for each.

    Attributes:
        slides: as given.
        rotors: one for each motor.
        switches_steps: from where on each carriage presses its switches, the next time.
        contacts: the switches on the shared line,
        own_contacts: and those on each other one.
    """

    def __init__(
        self,
        slides: Sequence[Slide],
        lag_s: float = 0.0,
        bounce_readings: int = 0,
        own_lines: Sequence[frozenset[End]] = (),
    ) -> None:
        self.slides = tuple(slides)
        self.rotors = [
            Rotor(slide.middle_steps, *slide.ends_steps, slide.limits, slide.steps_in_turn)
            for slide in slides
        ]
        self.switches_steps = [slide.switches_steps for slide in slides]
        self.contacts = Contacts(lag_s, bounce_readings)
        self.own_contacts = tuple(Contacts(lag_s, bounce_readings) for _ in own_lines)
        self._line_of = {
            end: line
            for ends, line in zip(own_lines, self.own_contacts, strict=True)
            for end in ends
        }
        self._has_backlash = any(slide.backlash_steps for slide in slides)
        # Carriage ahead of rotor: between nothing and the backlash.
        self._slack_steps = [0.0] * len(self.rotors)
        self._by_hand: set[End] = set()
        #: Motors whose switches were pressed since their places were drawn.
        self._to_be_drawn: set[int] = set()
        self._chance = random.Random(0)

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
        low_steps, high_steps = self.switches_steps[motor]
        if not low_steps < position_steps < high_steps or self._any_pressed:
            self.feel(motor, now_ns)
        elif self._to_be_drawn:
            self._draw(motor, position_steps)

    def _drag(self, motor: int, turned_steps: float) -> None:
        """The rotor turns within the play before its carriage follows."""
        slack_steps = self._slack_steps[motor] - turned_steps
        most_steps = self.slides[motor].backlash_steps
        self._slack_steps[motor] = min(max(slack_steps, 0.0), most_steps)

    def set_slack(self, slack_steps: Sequence[float]) -> None:
        """Take up the play as it was left; the carriages stay where they are."""
        self._slack_steps[:] = slack_steps

    def slack_steps(self) -> tuple[float, ...]:
        """Carriage ahead of rotor, per motor."""
        return tuple(self._slack_steps)

    def feel(self, motor: int, now_ns: int) -> None:
        """Press or leave the switches of one carriage."""
        position_steps = self.rotors[motor].position_steps + self._slack_steps[motor]
        low_steps, high_steps = self.switches_steps[motor]
        for end, at_end in (
            (End(motor, -1), position_steps <= low_steps),
            (End(motor, 1), position_steps >= high_steps),
        ):
            if at_end and self.slides[motor].scatter_steps:
                self._to_be_drawn.add(motor)
            line = self._line_of.get(end, self.contacts)
            line.change(end, at_end or end in self._by_hand, now_ns)
        if self._to_be_drawn:
            self._draw(motor, position_steps)

    def _draw(self, motor: int, position_steps: float) -> None:
        """The switches of a carriage that is clear of them will close a little elsewhere."""
        slide = self.slides[motor]
        low_steps, high_steps = slide.switches_steps
        clear_steps = _CLEAR * slide.scatter_steps
        is_clear = low_steps + clear_steps < position_steps < high_steps - clear_steps
        if motor not in self._to_be_drawn or not is_clear:
            return
        self._to_be_drawn.remove(motor)
        off_steps = [self._chance.gauss(0, slide.scatter_steps) for _ in range(2)]
        self.switches_steps[motor] = low_steps + off_steps[0], high_steps + off_steps[1]

    def carriages_steps(self) -> tuple[float, ...]:
        """Where the carriages are, from the lower end of the travel."""
        return tuple(
            rotor.position_steps + slack
            for rotor, slack in zip(self.rotors, self._slack_steps, strict=True)
        )

    def lost_steps(self) -> tuple[float, ...]:
        """Half-steps that were asked for and not made, per motor."""
        return tuple(rotor.lost_steps for rotor in self.rotors)

    def pressed(self) -> frozenset[End]:
        """Switches that are pressed, by a carriage or by hand."""
        return self.contacts.pressed().union(*(line.pressed() for line in self.own_contacts))

    @property
    def _any_pressed(self) -> bool:
        own = self.own_contacts
        return self.contacts.any_pressed or (bool(own) and any(line.any_pressed for line in own))

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
