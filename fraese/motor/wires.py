"""From the card's entries to the port's registers, and what the motors stand with.

Rule 1: all writes go through here, in the card's order.
Rule 2: a reading that changes nothing goes no further: this is done after every step.
Rule 3: outputs that must be safe at standstill are off there. What they should be is remembered
        for the next start, but not over a run that ended before its end.
Rule 4: on the way out outputs and currents go off and the port is given back, whatever goes wrong.
"""

from collections.abc import Callable

from fraese.motor.reactions import Reactions
from fraese.motor.seams import Card, Entries, IdleLevel, Port
from fraese.motor.switches import InputWatcher
from fraese.motor.track import BETWEEN_TICKS


class Wires:
    """A card on a port.

    Args:
        port: registers to write; closed with the wires.
        card: what they mean.
        inputs: knows which readings are quiet.
        reactions: takes the others.
        safe_outputs: free outputs that are off whenever the motors stand (a laser).

    Attributes:
        access: one function a register, to be called with the value of an entry.
        energised: the coils have full current.
        port: as given.
        stale: entries that were made out before are not to be written any more.
    """

    def __init__(
        self,
        port: Port,
        card: Card,
        inputs: InputWatcher,
        reactions: Reactions,
        safe_outputs: int = 0,
    ) -> None:
        self._port = self.port = port
        self._card = card
        self._inputs = inputs
        self._reactions = reactions
        self._safe_outputs = safe_outputs
        self._outputs = 0
        self.energised = False
        self.stale = False
        self.access: tuple[Callable[[int], object], ...] = self._accesses(port)

    def _accesses(self, port: Port) -> tuple[Callable[[int], object], ...]:
        return port.write_data, self._sample, port.write_control

    @property
    def is_tapped(self) -> bool:
        """Somebody listens."""
        return self._port is not self.port

    def tap(self, listener: Port) -> None:
        """Let everything pass through this one from now on; at standstill."""
        self._port = listener
        self.access = self._accesses(listener)

    def untap(self) -> None:
        """Nobody listens any more; at standstill."""
        self.tap(self.port)

    def write(self, entries: Entries) -> None:
        """Do what the card says."""
        access = self.access
        for register, value in entries:
            access[register](value)

    def sample(self) -> None:
        """Read the status register between two ticks."""
        self._sample(BETWEEN_TICKS)

    def _sample(self, motor: int) -> None:
        """Read the status register after ``motor`` has made its step."""
        status = self._port.read_status()
        if status != self._inputs.quiet_status:
            self._reactions.examine(status, motor)

    def energise(self) -> None:
        """Full current."""
        self.write(self._card.energise())
        self.energised = True

    def idle(self, level: IdleLevel) -> None:
        """Standstill current."""
        self.write(self._card.idle(level))
        self.energised = False

    def signal_run(self) -> None:
        """A run begins: outputs as they should be."""
        self.write(self._card.set_outputs(self._safe_outputs, self._outputs))

    def signal_ramp(self, ramp: bool) -> None:
        """Tell the drives that the motors move, and whether the rate changes."""
        self.write(self._card.signals(True, ramp))

    def signal_rest(self) -> None:
        """The motors stand: ACTIVE and BOOST low, outputs that must be safe off."""
        self.write(self._card.signals(False, False))
        self.write(self._card.set_outputs(self._safe_outputs, 0))

    def set_outputs(self, mask: int, value: int, standing: bool = False) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        self._outputs = self._outputs & ~mask | value & mask
        now = mask & ~self._safe_outputs if standing else mask
        self.write(self._card.set_outputs(now, value))
        self.stale = True

    def forget_safe_outputs(self) -> None:
        """What ended before its end must not switch a laser on again at the next start."""
        self._outputs &= ~self._safe_outputs

    def close(self) -> None:
        """The last writes, whatever went wrong before them."""
        try:
            self.write(self._card.set_outputs(~0, 0))
            self.idle(IdleLevel.OFF)
        finally:
            self._port.close()
