"""What lives on through the end of a killed program, and what it knows of the machine's place.

    kind      who made the steps     asked with
    bridge    the microcontroller    STATUS, before anything resets it; beside the journal lies a
                                     ledger that says what its answer means

Rule 1: asked only where the record says that the machine moves, and by who will drive it: the
        question brakes.
Rule 2: believed only what is of the record's very session. Whatever does not fit is nothing: then
        the bounds of the record hold.
"""

import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from fraese.config import Config
from fraese.control.savedstate import SavedState
from fraese.control.survived import survived
from fraese.errors import FraeseError
from fraese.journal.files import create, open_plain, read_all
from fraese.machine import Machine
from fraese.motor.bridge.ledger import (
    SIZE,
    TOKEN_BYTES,
    Book,
    FileLedger,
    Ledger,
    book_in,
    this_boot,
)
from fraese.motor.clock import MonotonicClock
from fraese.motor.realtime.lastwords import LastWords

KNOWN: Final = (
    "The last program ended while the machine moved; what made the steps lived on, and the place is"
    " known to the step."
)


class Opening(NamedTuple):
    """Which opening of a machine it is, for what may outlive it.

    Attributes:
        token: its name, as the records have it.
        journal: of the machine; what lives on leaves its own file beside it.
    """

    token: bytes
    journal: Path


def known(record: SavedState, config: Config, machine: Machine, journal: Path) -> SavedState | None:
    """A record in motion, with the place as it is known for certain; None: it is not.

    Args:
        record: of the journal.
        config: the machine,
        machine: and its axes.
        journal: where it was.
    """
    opening = Opening(record.session.encode("ascii", "replace"), journal)
    asks = SURVIVORS.get(config.port.kind)
    if record.motion is None or asks is None or len(opening.token) != TOKEN_BYTES:
        return None
    words = asks(config, opening)
    return None if words is None else survived(record, words, machine)


# --- bridge ---------------------------------------------------------------------------------------


def ledger_of(opening: Opening | None) -> Ledger:
    """Where the driver of a bridge writes down what it sends; nowhere, if that cannot be.

    Raises:
        ConfigError: if something else lies where the file should be.
    """
    boot = this_boot()
    if opening is None or not boot:
        return Ledger()
    path = _ledger_file(opening)
    try:
        fd = open_plain(path, os.O_RDWR)
        file = os.fdopen(create(path) if fd is None else fd, "r+b", buffering=0)
    except OSError:
        return Ledger()
    return FileLedger(file, opening.token, boot)


def _book_of(opening: Opening) -> Book | None:
    """What a dead program's driver wrote down in this run of the computer."""
    try:
        fd = open_plain(_ledger_file(opening), os.O_RDONLY)
        if fd is None:
            return None
        try:
            book = book_in(read_all(fd, SIZE + 1))
        finally:
            os.close(fd)
    except (OSError, FraeseError):
        return None
    is_ours = book is not None and (book.token, book.boot) == (opening.token, this_boot())
    return book if is_ours else None


def _ledger_file(opening: Opening) -> Path:
    return opening.journal.with_suffix(".ledger")


def _ask_bridge(config: Config, opening: Opening) -> LastWords | None:
    book = _book_of(opening)
    if book is None:
        return None
    # Nobody else needs pyserial.
    from fraese.motor.bridge.line import SerialLine, chosen_port
    from fraese.motor.bridge.survivor import ask

    try:
        device = chosen_port(config.port.device)
    except FraeseError:
        # The driver will say so.
        return None
    return ask(partial(SerialLine, device, config.port.baud), MonotonicClock(), book)


SURVIVORS: Final[Mapping[str, Callable[[Config, Opening], LastWords | None]]] = {
    "bridge": _ask_bridge,
}
