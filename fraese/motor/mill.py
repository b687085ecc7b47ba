"""The mechanics of a simulated mill: rotors with their carriages, and the switches they press.

Rule 1: a carriage follows its rotor, after the rotor has turned through the backlash.
Rule 2: a switch is pressed by a carriage at its end of travel or beyond, or by hand.
Rule 3: switches are felt after every movement that may have changed them: at or beyond an end, and
        everywhere while one is pressed.
"""

from collections.abc import Sequence

from fraese.motor.contacts import Contacts
from fraese.motor.rotor import Rotor, RotorLimits
from fraese.motor.seams import End


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
