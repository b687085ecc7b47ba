"""Jobs: what the run loop works off.

A job is a generator. It yields blocks, which are pushed as the queue has room, and waits by
yielding one of the classes below; what it gets back is the driver's report at that moment.

    report = yield block        taken by the queue (not yet played)
    report = yield STANDSTILL   everything pushed so far has been played
    report = yield Ask("...")   the operator has answered

So homing is written as it is read, a program streams, and both are stopped in one place.
"""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Final

from fraese.blocks import Block
from fraese.motor.seams import Report


@dataclass(frozen=True, slots=True)
class Standstill:
    """Wait until everything pushed has been played."""


@dataclass(frozen=True, slots=True)
class Ask:
    """Wait for standstill, then for the operator."""

    question: str


STANDSTILL: Final = Standstill()

Job = Generator[Block | Standstill | Ask, Report, None]
