"""What is looked at on the program itself: in which form its modules run."""

from collections.abc import Mapping, Sequence
from typing import Final

from fraese.compiled import Form
from fraese.doctor.findings import Check, Finding, Patient, State
from fraese.phrases import phrase

#: What to do where it could be faster.
_CHANGES: Final[Mapping[Form, str]] = {
    Form.PLAIN: phrase(
        "Install a C compiler and Python's headers (Debian: sudo apt install gcc python3-dev), then"
        " this program again: a step costs a third of the time."
    ),
    Form.STALE: phrase("Say make compiled."),
}


def _form(patient: Patient) -> Finding:
    found = phrase("It runs {form}.", form=patient.form.in_words())
    change = _CHANGES.get(patient.form, "")
    return Finding(phrase("program"), State.WARN if change else State.OK, found, change)


PROGRAM_CHECKS: Final[Sequence[Check]] = (_form,)
