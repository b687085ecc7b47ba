"""What is looked at on the motors: whether they suit their card, and the mill that is simulated."""

from collections.abc import Sequence
from typing import Final

from fraese.assembly.misfits import described, misfits
from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.phrases import joined, phrase


def _suit(patient: Patient) -> Finding:
    said = misfits(patient.config)
    found = described(patient.config) or phrase("Step/direction drives.")
    if not said:
        return Finding(phrase("motors"), State.OK, found)
    return Finding(phrase("motors"), State.WARN, found, joined(" ", said))


MOTOR_CHECKS: Final[Sequence[Check]] = (_suit,)
