"""The simulated mill: a parallel port with a card and a machine on it.

Everything comes in through the registers, as on metal: the electronics latch on the strobe (or on
a clock edge), turn the fields of the motors, and the mechanics follow as far as they can.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Protocol

from fraese.motor.mill import Mill
from fraese.motor.phases import MOTRUN, MOTZERO, Currents, currents_of, field_angle
from fraese.motor.seams import Clock, End

#: All inputs at rest: bits 3 to 7 read 1, on these cards "no contact".
INPUTS_AT_REST: Final = 0xF8
_STROBE: Final = 1
_LONG_AGO_NS: Final = 10_000_000_000


class Electronics(Protocol):
    """A card as seen from the plug."""

    def data(self, value: int) -> None:
        """The data pins changed to this byte."""

    def control(self, value: int) -> None:
        """The control register was written."""

    #: Where each motor's field pointed last, in half-steps of a turn.
    angles: list[float]

    def currents(self, motor: int) -> Currents:
        """What a clamp meter would show on the coils."""

    def cut_power(self) -> None:
        """The supply is gone; rotors are free."""

    def restore_power(self) -> None:
        """The supply is back; currents are nil until something is commanded."""


class SmcElectronics:
    """SMC800/SMC1500: latches the data byte on nStrobe, holds the phase currents.

    Args:
        mill: what the motors move.
        clock: when it happens.
        levels: what the current codes really mean on this card.
        rest: the byte in whose field the rotors stand at first.
    """

    def __init__(
        self, mill: Mill, clock: Clock, levels: tuple[int, int, int, int], rest: int = MOTRUN[0]
    ) -> None:
        self._mill = mill
        self._now_ns = clock.now_ns
        self._levels = levels
        self._angle_of = [field_angle(byte, levels) for byte in range(64)]
        self.angles = [self._angle_of[rest & 63] or 0.0] * len(mill.rotors)
        self._latched = [MOTZERO] * len(mill.rotors)
        self._data = 0
        self._control = 0
        self._supplied = True

    def data(self, value: int) -> None:
        """Only seen at the next strobe."""
        self._data = value

    def control(self, value: int) -> None:
        """The strobe's setting edge latches."""
        if value & _STROBE and not self._control & _STROBE:
            self._latch(self._data)
        self._control = value

    def _latch(self, byte: int) -> None:
        motor = byte >> 6
        if motor >= len(self._latched):
            return
        self._latched[motor] = byte
        angle = self._angle_of[byte & 63]
        rotor = self._mill.rotors[motor]
        if angle is None:
            if rotor.powered:
                rotor.release()
            return
        delta = angle - self.angles[motor]
        self.angles[motor] = angle
        if not rotor.powered and self._supplied:
            rotor.energise()
        if delta:
            if delta > 4:
                delta -= 8
            elif delta < -4:
                delta += 8
            self._mill.turn(motor, delta, self._now_ns())

    def currents(self, motor: int) -> Currents:
        """From the byte last latched."""
        return currents_of(self._latched[motor] if self._supplied else MOTZERO, self._levels)

    def cut_power(self) -> None:
        """All coils without current; what is latched meanwhile moves nothing and is lost."""
        self._supplied = False
        for rotor in self._mill.rotors:
            rotor.release()

    def restore_power(self) -> None:
        """Currents flow again from the next byte on."""
        self._supplied = True
        self._latched = [MOTZERO] * len(self._mill.rotors)


class StepDirElectronics:
    """Step/direction drives: data bits 2k, 2k+1 are direction and clock of motor k.

    Args:
        mill: what the motors move.
        clock: when it happens.
        clock_idles_high: a step is then the falling edge.
        forward_high: level of the direction lines for positive steps.
    """

    def __init__(
        self,
        mill: Mill,
        clock: Clock,
        clock_idles_high: bool = False,
        forward_high: bool = True,
    ) -> None:
        self._mill = mill
        self._now_ns = clock.now_ns
        # Inverted wiring is turned round at the plug.
        self._inverted = (0xAA if clock_idles_high else 0) | (0 if forward_high else 0x55)
        self.angles = [0.0] * len(mill.rotors)
        # Pulled up before anybody writes: the first byte is no rising edge.
        self._data = 0xFF
        self.restore_power()

    def data(self, value: int) -> None:
        """A rising clock steps its motor."""
        value ^= self._inverted
        rising = value & ~self._data
        self._data = value
        for motor in range(len(self._mill.rotors)):
            if rising >> 2 * motor & 2:
                self._mill.turn(motor, 1 if value >> 2 * motor & 1 else -1, self._now_ns())

    def control(self, value: int) -> None:
        """ACTIVE and BOOST change the current, not the position."""

    def currents(self, motor: int) -> Currents:
        """A drive regulates its own currents; on or off is all that is known here."""
        level = 100 if self._supplied else 0
        return Currents(level, level)

    def cut_power(self) -> None:
        """Motors without current; the drives count on, and what they count is lost."""
        self._supplied = False
        for rotor in self._mill.rotors:
            rotor.release()

    def restore_power(self) -> None:
        """Current again: rotors turn to the nearest angle of their field."""
        self._supplied = True
        for rotor in self._mill.rotors:
            rotor.energise()


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
    """How the switch line meets the status register."""

    mask: int = 0x80
    closed_value: int = 0


class SimulatedMill:
    """A Port that is a card and a mill.

    Args:
        mill: the mechanics; ask and tell it directly.
        electronics: the card.
        clock: the same as the driver's, so that physics sees the time of every write.
        wiring: where the switch line is.

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
    ) -> None:
        self.mill = mill
        self.electronics = electronics
        self.inputs = INPUTS_AT_REST
        self._clock = clock
        self._wiring = wiring
        self._contacts = mill.contacts
        # The electronics take the writes themselves: one call less a register access.
        self.write_data = electronics.data
        self.write_control = electronics.control

    def read_status(self) -> int:
        """Inputs as they are now, the switch line with its lag and bounce."""
        contacts = self._contacts
        closed = contacts.closed if contacts.still else contacts.read(self._clock.now_ns())
        mask, closed_value = self._wiring.mask, self._wiring.closed_value
        return self.inputs & ~mask | (closed_value if closed else closed_value ^ mask)

    def close(self) -> None:
        """Nothing to give back."""

    # --- a person at the machine ---------------------------------------------------------------

    def look(self) -> "Sight":
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
            self.electronics.angles[motor] = state.field_angle
            # It has stood there for long: no contact is on its way.
            self.mill.place(motor, state.position_steps, self._clock.now_ns() - _LONG_AGO_NS)
            self.mill.rotors[motor].set_lost(state.lost_steps)

    def press(self, end: End) -> None:
        """Press a switch by hand, now."""
        self.mill.press(end, self._clock.now_ns())

    def let_go(self, end: End) -> None:
        """Take the hand off a switch, now."""
        self.mill.let_go(end, self._clock.now_ns())
