"""What a check says: how it stands, what was found, what to change."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

from fraese.compiled import FORM, Form
from fraese.config import Config
from fraese.doctor.opening import Opening
from fraese.motor.ports.facts import PortFacts
from fraese.motor.realtime.kernel import KernelFacts
from fraese.motor.seams import Card


class State(Enum):
    """How something stands."""

    OK = "ok"
    WARN = "warn"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class Finding:
    """One answer.

    Attributes:
        name: of what was looked at.
        state: how it stands.
        found: what was found, a sentence.
        change: what would be better, and how; empty where nothing need be changed.
    """

    name: str
    state: State
    found: str
    change: str = ""


@dataclass(frozen=True, slots=True)
class Patient:
    """All that the checks look at; none of them looks anywhere else.

    Attributes:
        config: of the machine.
        card: what hangs on its port.
        port: the port from outside.
        opening: what came of opening it.
        kernel: what the system allows.
        sleeps: the step rates leave the step process time to sleep between two edges.
        awake: the machine can be kept from falling asleep.
        awake_note: what came of asking for that.
        form: in which our own modules run.
    """

    config: Config
    card: Card
    port: PortFacts
    opening: Opening
    kernel: KernelFacts
    sleeps: bool
    awake: bool
    awake_note: str
    form: Form = FORM


Check = Callable[[Patient], Finding]


def ask(checks: Sequence[Check], patient: Patient) -> list[Finding]:
    """One finding of each check, in order."""
    return [check(patient) for check in checks]
