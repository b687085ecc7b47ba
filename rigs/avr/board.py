"""Which pin of the microcontroller is which pin of the plug, and what its writes mean there.

An Uno has no free 8-bit port, so a data byte is two writes, a few cycles apart:

    PORTD  D5 D4 D3 D2 D1 D0 -- --      bits 7 to 2; 1 and 0 are the serial line
    PORTB  -- -- -- 17 .. st D7 D6      bit 2 is nStrobe, the others 14, 16

`Decoder` puts them together again and says what a parallel port would have been told:
DATA 0x49, CONTROL 0x0A. It goes by the levels of the pins: an output has its latch's level, an
input its pull-up's, or low. Its rules:

1. A write that changes control pins is a CONTROL write. If data pins change with it, it is a DATA
   write first. So a direction set before the latch shows as the glitch that it is.
2. Any other write of a port whose data pins are outputs is a DATA write, changed or not.
3. Two DATA writes of different ports within `PAIR_CYCLES` are one, dated by the first.
4. A write of a port with control outputs and no data pins is a CONTROL write, changed or not.
5. A reset makes all pins inputs; that is no write.
"""

from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from rigs.avr.binding import Events

#: Two halves of a byte are at most so far apart; the shortest half interval of a clock is 8.
PAIR_CYCLES = 5
DATA, STATUS, CONTROL = 0, 1, 2
#: One register write in the parallel port's terms. `spread` is the time between the two halves
#: of a data byte, in cycles; 0 where one write was enough.
ACCESS = np.dtype([("cycle", "<i8"), ("register", "u1"), ("value", "u1"), ("spread", "<u2")])
Accesses = npt.NDArray[np.void]
PORTS = "BCD"
#: The registers that make the levels: latches, then directions.
LATCHES = PORTS + PORTS.lower()
Bytes = npt.NDArray[np.uint8]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Board:
    """The wiring, in pins like "D2".

    Attributes:
        data: Data bits 0 to 7, DB25 pins 2 to 9.
        control: Control register bits 0 to 3: DB25 pins 1 (nStrobe), 14, 16, 17.
        status: Status register bits 7 to 3: DB25 pins 11, 10, 12, 13, 15.
        pulled_up: Pins with a resistor to 5 V on the board.
        inverted_control: Control bits that the port inverts between register and pin.
        inverted_status: The same, of the status register.
    """

    data: tuple[str, ...]
    control: tuple[str, ...]
    status: tuple[str, ...]
    pulled_up: tuple[str, ...] = ()
    inverted_control: int = 0x0B
    inverted_status: int = 0x80

    def status_pins(self, register: int) -> list[tuple[str, bool]]:
        """The pin levels at which a parallel port's status register would read so."""
        levels = register ^ self.inverted_status
        return [(pin, bool(levels >> (7 - i) & 1)) for i, pin in enumerate(self.status)]


#: ATmega328P on an Uno or a Nano. D13 (B5) is left alone: the boot loader blinks it.
UNO = Board(
    data=("D2", "D3", "D4", "D5", "D6", "D7", "B0", "B1"),
    control=("B2", "B3", "B4", "C5"),
    status=("C0", "C1", "C2", "C3", "C4"),
    pulled_up=("B2",),
)


def decode(events: Events, board: Board = UNO) -> Accesses:
    """A whole log as register writes, in order."""
    return Decoder(board).decode(events)


#: By kind of event: it is about a pin, or a reset.
_OF_PINS: Final[Flags] = np.array([chr(kind) in LATCHES + "R" for kind in range(256)])


@dataclass(slots=True)
class Decoder:
    """Decodes a log piece by piece; keeps what it needs to go on.

    Attributes:
        board: The wiring.
    """

    board: Board = UNO
    _latches: Bytes = field(default_factory=lambda: np.zeros(6, np.uint8))
    _kept: Events | None = None

    def decode(self, events: Events, until_cycle: int | None = None) -> Accesses:
        """The register writes in the next piece of a log.

        Args:
            events: The next piece, as `Avr.take_log` gives it.
            until_cycle: The log is known up to here. What is newer than `PAIR_CYCLES` is kept
                back, for its other half may come with the next piece. None: nothing follows.

        Returns:
            An array of `ACCESS`.
        """
        events = events[_OF_PINS[events["kind"]]]
        if self._kept is not None and len(self._kept):
            events = np.concatenate([self._kept, events])
        if not len(events):
            # Most pieces are of a moment in which no pin is written.
            return np.zeros(0, ACCESS)
        split = len(events) if until_cycle is None else _complete(events, until_cycle)
        self._kept = events[split:]
        return self._decoded(events[:split])

    def _decoded(self, events: Events) -> Accesses:
        if not len(events):
            return np.zeros(0, ACCESS)
        latches = self._forward(events)
        self._latches = latches[:, -1].copy()
        levels = self._levels(latches)
        data = _gathered(levels, self.board.data)
        control = _gathered(levels, self.board.control) ^ np.uint8(self.board.inverted_control)
        return _accesses(events, data, control, self._speaks(events, latches[3:, 1:]))

    def _forward(self, events: Events) -> Bytes:
        """The six registers before everything, and after each event: shape (6, n + 1)."""
        kinds = events["kind"]
        reset = kinds == ord("R")
        written = np.where(reset, 0, events["value"])
        latches = np.empty((len(LATCHES), len(events) + 1), np.uint8)
        for row, name in enumerate(LATCHES):
            touched = np.concatenate([[True], (kinds == ord(name)) | reset])
            values = np.concatenate([self._latches[row : row + 1], written])
            latest = np.maximum.accumulate(np.where(touched, np.arange(len(touched)), 0))
            latches[row] = values[latest]
        return latches

    def _levels(self, latches: Bytes) -> Bytes:
        """The levels of the pins of B, C and D."""
        pulled = np.array([[_mask(self.board.pulled_up, name)] for name in PORTS], np.uint8)
        latch, direction = latches[:3], latches[3:]
        # The latch of an input switches the chip's own pull-up.
        return (latch & direction) | ((latch | pulled) & ~direction)

    def _speaks(self, events: Events, directions: Bytes) -> tuple[Flags, Flags]:
        """Which events write data outputs; which write control outputs of a port without data."""
        to_data = np.zeros(len(events), np.bool_)
        to_control = np.zeros(len(events), np.bool_)
        for row, name in enumerate(PORTS):
            written = events["kind"] == ord(name)
            data, control = (_mask(p, name) for p in (self.board.data, self.board.control))
            to_data |= written & ((directions[row] & data) != 0)
            to_control |= written & ((directions[row] & control) != 0) & (data == 0)
        return to_data, to_control


def resets(events: Events) -> list[tuple[int, int]]:
    """The resets in a log: (cycle, cause as the register MCUSR shows it)."""
    return [(int(e["cycle"]), int(e["value"])) for e in events[events["kind"] == ord("R")]]


def _complete(events: Events, until_cycle: int) -> int:
    """How many events cannot be the first half of something still to come."""
    gaps = np.diff(events["cycle"].astype(np.int64), append=until_cycle)
    alone = np.flatnonzero(gaps > PAIR_CYCLES)
    return int(alone[-1]) + 1 if len(alone) else 0


def _mask(pins: tuple[str, ...], port: str) -> int:
    return sum(1 << int(pin[1]) for pin in pins if pin[0] == port)


def _gathered(levels: Bytes, pins: tuple[str, ...]) -> Bytes:
    value = np.zeros(levels.shape[1], np.uint8)
    for bit, pin in enumerate(pins):
        row = levels[PORTS.index(pin[0])]
        value |= ((row >> int(pin[1])) & 1) << bit
    return value


def _accesses(events: Events, data: Bytes, control: Bytes, speaks: tuple[Flags, Flags]) -> Accesses:
    to_data, to_control = speaks
    real = events["kind"] != ord("R")
    data_changed = real & (data[1:] != data[:-1])
    control_changed = real & (control[1:] != control[:-1])
    is_data = (to_data & ~control_changed) | data_changed
    is_control = to_control | control_changed
    cycle = events["cycle"].astype(np.int64)
    first = _first_halves(events["kind"], cycle, is_data & to_data, is_control)
    second = np.concatenate([[False], first[:-1]])
    spread = np.where(second, np.diff(cycle, prepend=cycle[0]), 0)
    rows = np.zeros((len(events), 2), ACCESS)
    rows["register"] = (DATA, CONTROL)
    rows["cycle"] = cycle[:, None]
    rows["cycle"][:, 0] -= spread
    rows["spread"][:, 0] = spread
    rows["value"] = np.stack([data[1:], control[1:]], axis=1)
    chosen: Accesses = rows[np.stack([is_data & ~first, is_control], axis=1)]
    return chosen


def _first_halves(
    kinds: Bytes, cycle: npt.NDArray[np.int64], is_data: Flags, is_control: Flags
) -> Flags:
    """Which writes are the first half of a data byte."""
    fits = np.zeros(len(kinds), np.bool_)
    fits[:-1] = (
        is_data[:-1]
        & is_data[1:]
        & ~is_control[:-1]
        & (kinds[:-1] != kinds[1:])
        & (np.diff(cycle) <= PAIR_CYCLES)
    )
    # In a run of neighbours that all fit, every other one begins a pair.
    starts = fits & ~np.concatenate([[False], fits[:-1]])
    run_start = np.maximum.accumulate(np.where(starts, np.arange(len(fits)), 0))
    even: Flags = (np.arange(len(fits)) - run_start) % 2 == 0
    return fits & even
