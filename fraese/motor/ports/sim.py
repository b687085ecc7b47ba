"""The simulated mill: a parallel port with a card and a machine on it.

    write_data, write_control --> Electronics --> Rotor --> carriage --> Contacts
    read_status <------------------------------------------------------------'

Rule 1: a driver sees three registers and nothing else. What a person at the machine sees and does
        (look, press, switch off) goes past the registers.
Rule 2: physics is asked with the time of the driver's clock, whatever the wall clock says.
Rule 3: what stays as it is when everything is switched off can be kept and taken up again.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from fraese.motor.electronics import Electronics
from fraese.motor.feeler import Feeler
from fraese.motor.mill import Mill
from fraese.motor.phases import Currents
from fraese.motor.seams import Clock, End

#: All inputs at rest: bits 3 to 7 read 1, on these cards "no contact".
INPUTS_AT_REST: Final = 0xF8
#: Whether carriages that stand there, in half-steps of their motors, press a switch.
Pressed = Callable[[Sequence[float]], bool]
_LONG_AGO_NS: Final = 10_000_000_000


@dataclass(frozen=True, slots=True)
class Sight:
    """What a person at the machine sees.

    Attributes:
        carriages_steps: per motor, from the lower end switch.
        lost_steps: per motor, asked for and not made since the carriage was placed.
        pressed: switches that are held down.
        currents: per motor, both coils.
    """

    carriages_steps: tuple[float, ...]
    lost_steps: tuple[float, ...]
    pressed: tuple[End, ...]
    currents: tuple[Currents, ...]


class RotorState(NamedTuple):
    """A rotor as it stands when nobody moves it; kept from one run to the next."""

    position_steps: float
    lost_steps: float
    field_angle: float
    slack_steps: float = 0.0


@dataclass(frozen=True)
class Wiring:
    """How the switches meet the status register.

    Attributes:
        mask, closed_value: bit of the shared line, and what it is with contact.
        own: the same of every line of its own, as the mill has them.
        near: the same of switches for referencing, and what presses them.
    """

    mask: int = 0x80
    closed_value: int = 0
    own: tuple[tuple[int, int], ...] = ()
    near: tuple[tuple[int, int, Pressed], ...] = ()


class SimulatedMill:
    """A Port that is a card and a mill.

    Args:
        mill: the mechanics; ask and tell it directly.
        electronics: the card.
        clock: the same as the driver's, so that physics sees the time of every write.
        wiring: where the switch line is.
        feeler: a probe, and what it can touch; None: there is nothing.

    Attributes:
        mill: what a person at the machine sees.
        electronics: coils and supply.
        inputs: the status register without the switch line; a test may change other bits.
    """

    def __init__(
        self,
        mill: Mill,
        electronics: Electronics,
        clock: Clock,
        wiring: Wiring = Wiring(),
        feeler: Feeler | None = None,
    ) -> None:
        self.mill = mill
        self.electronics = electronics
        self.inputs = INPUTS_AT_REST
        self._clock = clock
        self._wiring = wiring
        self._feeler = feeler
        self._has_more = bool(wiring.own or wiring.near)
        self._contacts = mill.contacts
        # The electronics take the writes themselves: one call less a register access.
        self.write_data = electronics.data
        self.write_control = electronics.control

    def read_status(self) -> int:
        """Inputs as they are now, the switch line with its lag and bounce."""
        contacts = self._contacts
        closed = contacts.closed if contacts.still else contacts.read(self._clock.now_ns())
        mask, closed_value = self._wiring.mask, self._wiring.closed_value
        reading = self.inputs & ~mask | (closed_value if closed else closed_value ^ mask)
        if self._has_more:
            reading = self._more_lines(reading)
        if self._feeler is None:
            return reading
        return self._feeler.felt(reading, self.mill.carriages_steps())

    def _more_lines(self, reading: int) -> int:
        """What is on lines other than the shared one."""
        now_ns, mill = self._clock.now_ns(), self.mill
        for line, (mask, closed_value) in zip(mill.own_contacts, self._wiring.own, strict=True):
            closed = line.closed if line.still else line.read(now_ns)
            reading = reading & ~mask | (closed_value if closed else closed_value ^ mask)
        for mask, closed_value, is_pressed in self._wiring.near:
            closed = is_pressed(mill.carriages_steps())
            reading = reading & ~mask | (closed_value if closed else closed_value ^ mask)
        return reading

    def close(self) -> None:
        """Nothing to give back."""

    # --- a person at the machine ---------------------------------------------------------------

    def feel(self, feeler: Feeler | None) -> None:
        """From now on other things lie on the table; None: nothing does."""
        self._feeler = feeler

    def look(self) -> Sight:
        """What a person sees now, everything at rest judged."""
        now_ns = self._clock.now_ns()
        for motor, rotor in enumerate(self.mill.rotors):
            rotor.settle(now_ns)
            self.mill.feel(motor, now_ns)
        return Sight(
            carriages_steps=self.mill.carriages_steps(),
            lost_steps=self.mill.lost_steps(),
            pressed=tuple(sorted(self.mill.pressed())),
            currents=tuple(
                self.electronics.currents(motor) for motor in range(len(self.mill.rotors))
            ),
        )

    def states(self) -> tuple[RotorState, ...]:
        """What stays as it is when everything is switched off."""
        self.look()
        return tuple(
            RotorState(rotor.position_steps, rotor.lost_steps, angle, slack)
            for rotor, angle, slack in zip(
                self.mill.rotors, self.electronics.angles, self.mill.slack_steps(), strict=True
            )
        )

    def set_states(self, states: Sequence[RotorState]) -> None:
        """Find the machine as it was left."""
        self.mill.set_slack([state.slack_steps for state in states])
        for motor, state in enumerate(states):
            self.electronics.set_angle(motor, state.field_angle)
            # It has stood there for long: no contact is on its way.
            self.mill.place(motor, state.position_steps, self._clock.now_ns() - _LONG_AGO_NS)
            self.mill.rotors[motor].set_lost(state.lost_steps)

    def press(self, end: End) -> None:
        """Press a switch by hand, now."""
        self.mill.press(end, self._clock.now_ns())

    def let_go(self, end: End) -> None:
        """Take the hand off a switch, now."""
        self.mill.let_go(end, self._clock.now_ns())
