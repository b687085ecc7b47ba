"""What the bench shows: bytes, currents, phases; and what can be done to a simulated mill.

Rule 1: facts are made when somebody looks, from what is there anyhow; else they cost nothing.
Rule 2: on a simulated mill bytes are what is on the pins. On metal they are what the card last did,
        worked out from the phases: ``is_seen`` says which.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from fraese.anythread import any_thread


@dataclass(frozen=True, slots=True)
class MotorFacts:
    """One motor.

    Attributes:
        name: of its axis.
        phase: index into the phase table, or pulses modulo nothing on a drive: 0.
        latched: the byte that the card holds for it; None: a drive has none.
        a_percent: current of phase A, signed, per cent of the maximum,
        b_percent: and of phase B.
        field: where its field points, in parts of one electrical turn, 0 to 1; None: no current.
        rotor: of a simulated mill: where its rotor stands, likewise; None: there is metal.
        is_blocked: of a simulated mill: somebody holds its carriage.
    """

    name: str
    phase: int
    latched: int | None
    a_percent: int
    b_percent: int
    field: float | None
    rotor: float | None = None
    is_blocked: bool = False


@dataclass(frozen=True, slots=True)
class BenchFacts:
    """The lines of the plug, and the motors behind the card.

    Attributes:
        data: the data byte.
        outputs: levels of the control pins, by DB25 pin (1, 14, 16, 17).
        motors: in motor order.
        table: the phase table in force; empty on a card that has none.
        table_name: its name, or its bytes in hex.
        is_seen: the bytes were seen on the pins; else they were worked out.
    """

    data: int
    outputs: dict[int, bool]
    motors: tuple[MotorFacts, ...]
    table: bytes
    table_name: str
    is_seen: bool


class Access(NamedTuple):
    """One access to the port: time in ns, register, value."""

    at_ns: int
    register: int
    value: int


class Bench(Protocol):
    """The machine as it lies open on a bench."""

    #: Phase tables that can be chosen while it is on; empty: none can.
    tables: tuple[str, ...]
    #: There is a mill whose carriages can be held.
    is_simulated: bool

    @any_thread
    def look(self) -> BenchFacts:
        """As it is now."""

    @any_thread
    def lines(self) -> tuple[Access, ...]:
        """The latest accesses, while they are listened to."""

    def listen(self, on: bool) -> bool:
        """Note every access from now on, or none; whether that is possible. At standstill.

        Only from the machine's thread.
        """

    def choose_table(self, name: str) -> None:
        """Drive the motors by this table from now on; at standstill, from the machine's thread.

        Raises:
            StateError: if that is not possible while the machine is on.
        """

    @any_thread
    def block(self, axis: str, blocked: bool) -> None:
        """Hold a carriage of a simulated mill, or let it go."""
