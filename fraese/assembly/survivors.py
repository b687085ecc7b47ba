"""What lives on through the end of a killed program, and what it knows of the machine's place.

    kind      who made the steps     asked with
    bridge    the microcontroller    STATUS, before anything resets it; beside the journal lies a
                                     ledger that says what its answer means
    ppdev     a process              nothing: it is gone by now, and its last words lie beside the
    devport   likewise               journal

Rule 1: asked only where the record says that the machine moves. A bridge only by who will drive it:
        the question brakes. What lies in a file is read by everybody.
Rule 2: believed only what is of the record's very session. Whatever does not fit is nothing: then
        the bounds of the record hold.
"""

import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from fraese.config import Config
from fraese.control.savedstate import SavedState
from fraese.control.survived import survived
from fraese.errors import FraeseError
from fraese.journal.files import create, open_plain, read_all
from fraese.kinds.port import port_kind
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
from fraese.motor.realtime import lastwords
from fraese.motor.realtime.lastwords import LastWords
from fraese.phrases import phrase

if TYPE_CHECKING:
    from fraese.motor.realtime.setup import WordsTo

KNOWN: Final = phrase(
    "The last program ended while the machine moved; what made the steps lived on, and"
    " the place is known to the step."
)


class Opening(NamedTuple):
    """Which opening of a machine it is, for what may outlive it.

    Attributes:
        token: its name, as the records have it.
        journal: of the machine; what lives on leaves its own file beside it.
    """

    token: bytes
    journal: Path


class Survivor(NamedTuple):
    """What lives on where steps are made in one way.

    Attributes:
        asks: for what it knows of that opening; None: nothing.
        by_anyone: it does no harm; else only who drives the machine may.
    """

    asks: Callable[[Config, Opening], LastWords | None]
    by_anyone: bool


def known(
    record: SavedState, config: Config, machine: Machine, journal: Path, *, to_drive: bool
) -> SavedState | None:
    """A record in motion, with the place as it is known for certain; None: it is not.

    Args:
        record: of the journal.
        config: the machine,
        machine: and its axes.
        journal: where it was.
        to_drive: this program drives the machine; else it only looks.
    """
    opening = Opening(record.session.encode("ascii", "replace"), journal)
    survivor = _survivor(config)
    if record.motion is None or survivor is None or len(opening.token) != TOKEN_BYTES:
        return None
    if not (to_drive or survivor.by_anyone):
        return None
    words = survivor.asks(config, opening)
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


# --- step process ---------------------------------------------------------------------------------


def words_to(opening: Opening | None) -> "WordsTo | None":
    """Where a step process is to leave its last words; None: nowhere, if that cannot be.

    Raises:
        ConfigError: if something else lies where the file should be.
    """
    from fraese.motor.realtime.setup import WordsTo

    if opening is None:
        return None
    path = _words_file(opening)
    try:
        # Says what else lies there.
        if (fd := open_plain(path, os.O_RDONLY)) is not None:
            os.close(fd)
        return WordsTo(lastwords.open_for(path), opening.token)
    except OSError:
        return None


def _last_words(config: Config, opening: Opening) -> LastWords | None:
    words = lastwords.read(_words_file(opening))
    return words if words is not None and words.token == opening.token else None


def _words_file(opening: Opening) -> Path:
    return opening.journal.with_suffix(".words")


_STEP_PROCESS: Final = Survivor(_last_words, by_anyone=True)
SURVIVORS: Final[Mapping[str, Survivor]] = {
    "bridge": Survivor(_ask_bridge, by_anyone=False),
}


def _survivor(config: Config) -> Survivor | None:
    is_opened = port_kind(config.port).opens is not None
    return SURVIVORS.get(config.port.kind, _STEP_PROCESS if is_opened else None)
