"""The machine as it lies open on a bench: put together from card, simulated mill and controller.

    kind         bytes                      lines as they are played     table chosen while it is on
    simulation   seen on the pins           listened to                  yes, of the same length
    others       worked out from phases     no: fraese trace             no

Rule 1: nothing is noted, and no access takes any longer, until somebody listens.
"""

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Final

from fraese.anythread import any_thread
from fraese.config import Config
from fraese.control.benchfacts import Access, BenchFacts, MotorFacts
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.kinds.smc1500 import phase_table
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.core import MotorCore
from fraese.motor.phases import (
    LEVEL_MAPS,
    MOTZERO,
    PHASE_TABLES,
    TURN_STEPS,
    currents_of,
    field_angle,
    motor_bits,
)
from fraese.motor.pins import CONTROL_PINS, levels
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.ports.traced import Note, TracedPort
from fraese.motor.seams import Card, Clock, StepDriver
from fraese.phrases import phrase

#: So many of the latest accesses are kept.
_KEPT: Final = 4000


class Workbench:
    """See ``control/benchfacts.py: Bench``.

    Args:
        config: card and axes.
        controller: knows the phases.
        card: what the registers mean.
        driver: plays; listened to where it is the core itself.
        clock: of the driver.
        mill: the simulated one; None: there is metal.
    """

    def __init__(
        self,
        config: Config,
        controller: Controller,
        card: Card,
        driver: StepDriver,
        clock: Clock,
        mill: SimulatedMill | None,
    ) -> None:
        self._config = config
        self._controller = controller
        self._card = card if isinstance(card, SmcCard) else None
        self._core = driver if isinstance(driver, MotorCore) and mill is not None else None
        self._clock = clock
        self._mill = mill
        self._levels = LEVEL_MAPS[config.card.levels]
        self._table_name = config.card.table
        self._heard: deque[Access] = deque(maxlen=_KEPT)
        self.is_simulated = mill is not None
        self.tables: tuple[str, ...] = ()
        if self._card is not None and self._core is not None:
            length = len(self._card.table)
            same = [name for name, table in PHASE_TABLES.items() if len(table) == length]
            self.tables = tuple(dict.fromkeys((self._table_name, *same)))

    # --- looking -------------------------------------------------------------------------------

    @any_thread
    def look(self) -> BenchFacts:
        """As it is now."""
        state = self._controller.state()
        motors = tuple(
            self._motor(motor, name, phase, energised=state.energised)
            for motor, (name, phase) in enumerate(zip(state.axes, state.phases, strict=True))
        )
        data, control = self._pins(motors)
        return BenchFacts(
            data=data,
            outputs=levels(control, CONTROL_PINS),
            motors=motors,
            table=self._card.table if self._card else b"",
            table_name=self._table_name if self._card else "",
            is_seen=self._mill is not None,
        )

    def _pins(self, motors: tuple[MotorFacts, ...]) -> tuple[int, int]:
        if self._mill is not None:
            return self._mill.electronics.pins
        latched = [motor.latched for motor in motors if motor.latched is not None]
        return (latched[-1] if latched else 0), 0

    def _motor(self, motor: int, name: str, phase: int, *, energised: bool) -> MotorFacts:
        latched = self._latched(motor, phase, energised=energised)
        rotor, blocked = None, False
        if self._mill is not None:
            currents = self._mill.electronics.currents(motor)
            field: float | None = self._mill.electronics.angles[motor] / TURN_STEPS % 1
            there = self._mill.mill.rotors[motor]
            lag = there.lost_steps / TURN_STEPS
            rotor, blocked = ((field or 0.0) - lag) % 1, there.blocked
            field = field if any(currents) else None
        elif latched is not None:
            currents = currents_of(latched, self._levels)
            angle = field_angle(latched & 63, self._levels)
            field = None if angle is None else angle / TURN_STEPS
        else:
            level = 100 if energised else 0
            return MotorFacts(name, phase, None, level, level, None)
        return MotorFacts(name, phase, latched, *currents, field, rotor, blocked)

    def _latched(self, motor: int, phase: int, *, energised: bool) -> int | None:
        """What the card was told of this motor last."""
        card = self._card
        if card is None:
            return None
        idle = card.hold_table[phase] if card.hold_table and self._holds else MOTZERO
        return motor_bits(card.sockets[motor]) | (card.table[phase] if energised else idle)

    @property
    def _holds(self) -> bool:
        return self._config.standstill.current == "hold"

    # --- listening -----------------------------------------------------------------------------

    @any_thread
    def lines(self) -> tuple[Access, ...]:
        """The latest accesses."""
        for _ in range(3):
            try:
                return tuple(self._heard)
            except RuntimeError:
                continue  # one came in between
        return ()

    def listen(self, on: bool) -> bool:
        """Note every access from now on, or none."""
        core, mill = self._core, self._mill
        if core is None or mill is None:
            return False
        wires = core.run.wires
        if on and not wires.is_tapped:
            wires.tap(TracedPort(wires.port, self._clock.now_ns, self._note))
        elif not on and wires.is_tapped:
            wires.untap()
            self._heard.clear()
        return True

    @contextmanager
    def recorded(self, note: Note) -> Iterator[None]:
        """Tell somebody of every access meanwhile; begun and ended at standstill.

        Raises:
            StateError: there is metal, or somebody listens already.
        """
        core = self._core
        if core is None or core.run.wires.is_tapped:
            raise StateError(
                phrase("The lines cannot be recorded: there is metal, or somebody listens already.")
            )
        wires = core.run.wires
        wires.tap(TracedPort(wires.port, self._clock.now_ns, note))
        try:
            yield
        finally:
            wires.untap()

    def _note(self, at_ns: int, register: int, value: int) -> None:
        self._heard.append(Access(at_ns, register, value))

    # --- hands ---------------------------------------------------------------------------------

    def choose_table(self, name: str) -> None:
        """Drive the motors by this table from now on, from the entry that is nearest.

        Raises:
            StateError: if the machine runs, or that is not possible while it is on.
        """
        card = self._card
        if card is None or name not in self.tables:
            raise StateError(
                phrase(
                    "Another phase table is chosen by card.table in the configuration, and"
                    " counts from the next start."
                )
            )
        if self._controller.status is Status.RUN:
            raise StateError(
                phrase("The machine runs: another phase table is chosen at standstill.")
            )
        table, before = phase_table(name), card.table
        card.set_phases_of(table, [self._nearest(table, before[p]) for p in card.phases()])
        self._table_name = name

    def _nearest(self, table: bytes, byte: int) -> int:
        """The entry whose field points as nearly as can be where this one's does."""
        wanted = field_angle(byte, self._levels) or 0.0
        angles: Mapping[int, float] = {
            n: field_angle(entry, self._levels) or 0.0 for n, entry in enumerate(table)
        }
        half = TURN_STEPS / 2
        return min(angles, key=lambda n: abs((angles[n] - wanted + half) % TURN_STEPS - half))

    @any_thread
    def block(self, axis: str, blocked: bool) -> None:
        """Hold a carriage of the simulated mill, or let it go."""
        if self._mill is not None:
            self._mill.mill.block(self._controller.machine.index(axis), blocked)
