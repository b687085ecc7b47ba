"""Which pin of the microcontroller is which pin of the plug, and what its writes mean there.

An Uno has no free 8-bit port, so a data byte is two writes, a few cycles apart:

    PORTD  D5 D4 D3 D2 D1 D0 -- --      bits 7 to 2; 1 and 0 are the serial line
    PORTB  -- -- -- 17 .. st D7 D6      bit 2 is nStrobe, the others 14, 16

`Decoder` puts them together again and says what a parallel port would have been told:
DATA 0x49, CONTROL 0x0A. Its rules:

1. A write that changes control pins is a CONTROL write. If data pins change with it, it is a DATA
   write first.
2. Any other write of a port with data pins is a DATA write, changed or not.
3. Two DATA writes of different ports within `PAIR_CYCLES` are one, dated by the first.
4. A write of a port that has control pins only is a CONTROL write, changed or not.
"""

from dataclasses import dataclass, field

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


@dataclass(frozen=True, slots=True)
class Board:
    """The wiring, in pins like "D2".

    Attributes:
        data: Data bits 0 to 7, DB25 pins 2 to 9.
        control: Control register bits 0 to 3: DB25 pins 1 (nStrobe), 14, 16, 17.
        status: Status register bits 7 to 3: DB25 pins 11, 10, 12, 13, 15.
        inverted_control: Control bits that the port inverts between register and pin.
        inverted_status: The same, of the status register.
    """

    data: tuple[str, ...]
    control: tuple[str, ...]
    status: tuple[str, ...]
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
)


def decode(events: Events, board: Board = UNO) -> Accesses:
    """A whole log as register writes, in order."""
    return Decoder(board).decode(events)


@dataclass(slots=True)
class Decoder:
    """Decodes a log piece by piece; keeps what it needs to go on.

    Attributes:
        board: The wiring.
    """

    board: Board = UNO
    _levels: npt.NDArray[np.uint8] = field(default_factory=lambda: np.zeros(3, np.uint8))
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
        events = events[np.isin(events["kind"], [ord(name) for name in PORTS + "R"])]
        if self._kept is not None:
            events = np.concatenate([self._kept, events])
        split = len(events) if until_cycle is None else _complete(events, until_cycle)
        self._kept = events[split:]
        return self._decoded(events[:split])

    def _decoded(self, events: Events) -> Accesses:
        if not len(events):
            return np.zeros(0, ACCESS)
        levels = self._forward(events)
        data = _gathered(levels, self.board.data)
        control = _gathered(levels, self.board.control) ^ np.uint8(self.board.inverted_control)
        self._levels = levels[:, -1]
        written = events["kind"] != ord("R")
        return _accesses(self.board, events[written], _changes(data), _changes(control), written)

    def _forward(self, events: Events) -> npt.NDArray[np.uint8]:
        """The three port registers before everything, and after each event: shape (3, n + 1)."""
        kinds = events["kind"]
        levels = np.empty((3, len(events) + 1), np.uint8)
        for row, name in enumerate(PORTS):
            touched = np.concatenate([[True], (kinds == ord(name)) | (kinds == ord("R"))])
            values = np.concatenate(
                [self._levels[row : row + 1], np.where(kinds == ord("R"), 0, events["value"])]
            )
            latest = np.maximum.accumulate(np.where(touched, np.arange(len(touched)), 0))
            levels[row] = values[latest]
        return levels


def resets(events: Events) -> list[tuple[int, int]]:
    """The resets in a log: (cycle, cause as the register MCUSR shows it)."""
    return [(int(e["cycle"]), int(e["value"])) for e in events[events["kind"] == ord("R")]]


def _complete(events: Events, until_cycle: int) -> int:
    """How many events cannot be the first half of something still to come."""
    gaps = np.diff(events["cycle"].astype(np.int64), append=until_cycle)
    alone = np.flatnonzero(gaps > PAIR_CYCLES)
    return int(alone[-1]) + 1 if len(alone) else 0


def _gathered(levels: npt.NDArray[np.uint8], pins: tuple[str, ...]) -> npt.NDArray[np.uint8]:
    value = np.zeros(levels.shape[1], np.uint8)
    for bit, pin in enumerate(pins):
        row = levels[PORTS.index(pin[0])]
        value |= ((row >> int(pin[1])) & 1) << bit
    return value


@dataclass(frozen=True, slots=True)
class _Changes:
    value: npt.NDArray[np.uint8]
    changed: npt.NDArray[np.bool_]


def _changes(values: npt.NDArray[np.uint8]) -> _Changes:
    return _Changes(values[1:], values[1:] != values[:-1])


def _accesses(
    board: Board, events: Events, data: _Changes, control: _Changes, written: npt.NDArray[np.bool_]
) -> Accesses:
    value, changed = data.value[written], data.changed[written]
    control_value, control_changed = control.value[written], control.changed[written]
    carries_data = np.isin(events["kind"], [ord(name) for name in {pin[0] for pin in board.data}])
    is_data = carries_data & (~control_changed | changed)
    is_control = control_changed | ~carries_data
    cycle = events["cycle"].astype(np.int64)
    first = _first_halves(events["kind"], cycle, is_data, is_control)
    second = np.concatenate([[False], first[:-1]])
    spread = np.where(second, cycle - np.concatenate([cycle[:1], cycle[:-1]]), 0)
    rows = np.zeros((len(events), 2), ACCESS)
    rows["register"] = (DATA, CONTROL)
    rows["cycle"] = cycle[:, None]
    rows["cycle"][:, 0] -= spread
    rows["spread"][:, 0] = spread
    rows["value"] = np.stack([value, control_value], axis=1)
    chosen: Accesses = rows[np.stack([is_data & ~first, is_control], axis=1)]
    return chosen


def _first_halves(
    kinds: npt.NDArray[np.uint8],
    cycle: npt.NDArray[np.int64],
    is_data: npt.NDArray[np.bool_],
    is_control: npt.NDArray[np.bool_],
) -> npt.NDArray[np.bool_]:
    """Which writes are the first half of a data byte."""
    if not len(kinds):
        return np.zeros(0, np.bool_)
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
    even: npt.NDArray[np.bool_] = (np.arange(len(fits)) - run_start) % 2 == 0
    return fits & even
