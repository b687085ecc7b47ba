"""Steps, as they can be counted from outside, on the wire."""

from collections.abc import Iterable, Sequence
from itertools import pairwise

from fraese.motor.seams import CONTROL, DATA

#: The bytes with which the phase-current card is switched off, motor by motor.
MOTORS_OFF = (0x1B, 0x5B, 0x9B)
#: The clock lines of step/direction drives.
CLOCKS = 0xAA


def data_bytes(writes: Iterable[tuple[int, int]]) -> list[int]:
    """What was written to the data register."""
    return [value for register, value in writes if register == DATA]


def steps_made(wiring: str, writes: Iterable[tuple[int, int]]) -> int:
    """Steps of all motors together, in a job that was begun with the motors off.

    On the phase-current card each phase byte is one step, after one a motor that energises it. On
    step/direction drives each clock line that rises is one.
    """
    data = data_bytes(writes)
    if wiring == "smc":
        return sum(value not in MOTORS_OFF for value in data) - len(MOTORS_OFF)
    return sum((~before & after & CLOCKS).bit_count() for before, after in pairwise([0, *data]))


def check_motors_off(writes: Sequence[tuple[int, int]]) -> None:
    """The last bytes switch all motors of the phase-current card off, and are latched."""
    last = writes[-3 * len(MOTORS_OFF) :]
    assert data_bytes(last) == list(MOTORS_OFF)
    # Each byte is followed by its strobe: set, then clear.
    strobes = [value & 1 for register, value in last if register == CONTROL]
    assert strobes == [1, 0] * len(MOTORS_OFF)


def check_contact(
    wiring: str,
    before: Sequence[tuple[int, int]],
    after: Sequence[tuple[int, int]],
    position_steps: Sequence[int],
) -> None:
    """A contact has stopped three motors that step together on each tick, within the tick in hand.

    Args:
        wiring: "smc", or one of step/direction drives.
        before: what had been written when the contact was first read.
        after: what was written from then on.
        position_steps: what the driver says was done.
    """
    made, in_all = steps_made(wiring, before), steps_made(wiring, [*before, *after])
    assert made > 300, "it had not moved yet"
    # The tick in hand is finished, and none is begun.
    assert in_all == -(-made // 3) * 3
    assert list(position_steps) == [in_all // 3] * 3
