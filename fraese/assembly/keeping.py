"""Where a machine's state is kept: its journal, the lock, and what earlier versions left.

Rule 1: the state belongs to one machine: kind of port and device. A simulated mill and a real one
        never share it.
Rule 2: who only looks takes no lock and writes nothing.
Rule 3: a file of earlier versions held any machine's state. The machine that it fits takes it up
        once, if it has no journal yet; from then on it has another name, so that no other machine
        believes it.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from fraese.assembly.meaning import fits_old, meaning, still_meant
from fraese.assembly.survivors import KNOWN, known
from fraese.config import Config
from fraese.control.savedstate import SavedState, state_in
from fraese.errors import ConfigError
from fraese.journal import Holder, Journal, MachineLock, machine_file
from fraese.journal.files import open_plain, read_all
from fraese.kinds.port import port_kind
from fraese.machine import Machine
from fraese.phrases import phrase, reason

#: Of versions before there was a journal; what it is called once it was taken up.
OLD_FILE: Final = "state.json"
TAKEN_UP: Final = "state.json.old"
_MOST_BYTES: Final = 1 << 20


class Keeping:
    """The kept state of one machine.

    Args:
        folder: of the state.
        config: which machine it is.
        machine: its axes.
    """

    def __init__(self, folder: Path, config: Config, machine: Machine) -> None:
        self._config, self._machine = config, machine
        path = machine_file(folder, config.port.kind, _device(config))
        self._old = folder / OLD_FILE
        self.journal = Journal(path)
        self._lock = MachineLock(path.with_suffix(".lock"))

    @property
    def path(self) -> Path:
        """The journal's file."""
        return self.journal.path

    @property
    def descriptor(self) -> int | None:
        """Of the lock, for a process that moves the motors too."""
        return self._lock.descriptor

    def take_lock(self) -> None:
        """Be the one program that drives the machine.

        Raises:
            BusyError: if another one is.
            ConfigError: if the folder cannot be written.
        """
        self._lock.take(_typed())

    def holder(self) -> Holder | None:
        """Who drives the machine now; None: nobody."""
        return self._lock.holder()

    def load(self, *, to_write: bool) -> tuple[SavedState | None, list[str]]:
        """What was kept and still means something, and what is to be said about it.

        Args:
            to_write: this program drives the machine; else it only looks.

        Raises:
            ConfigError: if it cannot be read, is damaged, or from a newer version.
        """
        notes: list[str] = []
        found = self.journal.read()
        if found is not None:
            axes = len(self._machine.axes)
            record = state_in(found.payload, axes, str(self.path))
            kept: SavedState | None = None
            if found.is_trusted:
                kept = self._of_survivor(record, to_write=to_write)
                notes += [KNOWN] if kept else []
            kept = kept or record.believed(is_trusted=found.is_trusted)
        else:
            kept = self._from_old(to_write=to_write)
        if kept is None:
            return None, []
        meant, forgotten = still_meant(kept, self._config, self._machine)
        return meant, [forgotten] if forgotten else notes

    def _of_survivor(self, record: SavedState, *, to_write: bool) -> SavedState | None:
        """See ``known``; who drives can ask but once, so the answer is written down.

        Raises:
            ConfigError: if that cannot be; then nothing is driven, so that the answer stays.
        """
        # Counts of axes that were configured otherwise are other places here.
        if record.axes != meaning(self._config, self._machine):
            return None
        kept = known(record, self._config, self._machine, self.path, to_drive=to_write)
        if kept is not None and to_write:
            try:
                self.write(kept, durable=True)
            except ConfigError as error:
                # A driver that is opened now would overwrite what knows the place.
                raise ConfigError(
                    phrase(
                        "{error} What made the steps knows the place since the last crash,"
                        " and only there can it be kept: mend that first, or start with"
                        " --fresh and reference the machine.",
                        error=error,
                    )
                ) from error
        return kept

    def _from_old(self, *, to_write: bool) -> SavedState | None:
        """See rule 3."""
        try:
            fd = open_plain(self._old, os.O_RDONLY)
            if fd is None:
                return None
            try:
                text = read_all(fd, _MOST_BYTES)
            finally:
                os.close(fd)
            kept = state_in(text, len(self._machine.axes), str(self._old))
            if not fits_old(kept, self._config, self._machine):
                return None
            if to_write:
                self._old.replace(self._old.with_name(TAKEN_UP))
        except OSError as error:
            raise ConfigError(
                phrase(
                    "{old}: cannot be taken up: {reason}; start with --fresh.",
                    old=self._old,
                    reason=reason(error),
                )
            ) from error
        return kept.believed()

    def start_anew(self) -> None:
        """Forget what was kept, when the first record is written."""
        self.journal.start_anew()

    def write(self, state: SavedState, durable: bool) -> None:
        """Put a state down.

        Raises:
            ConfigError: if it cannot be written.
        """
        self.journal.write(state.model_dump_json().encode(), durable=durable)

    def close(self) -> None:
        """Let another program have the machine."""
        self.journal.close()
        self._lock.let_go()


def _device(config: Config) -> str:
    """What tells machines of one kind apart."""
    return port_kind(config.port).address(config.port)


def _typed() -> str:
    """The command as people know it."""
    words = [Path(sys.argv[0] or "fraese").stem.replace("__main__", "fraese"), *sys.argv[1:]]
    return " ".join(words)


@contextlib.contextmanager
def closed_on_failure(keeping: Keeping | None) -> Iterator[None]:
    """Let go of the machine if it cannot be put together."""
    try:
        yield
    except BaseException:
        if keeping is not None:
            keeping.close()
        raise
