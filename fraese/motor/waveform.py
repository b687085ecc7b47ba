"""The lines of a port as a waveform file (VCD), for GTKWave, PulseView and ``fraese trace``.

    TracedPort --accesses--> Waveform --> FILE.vcd: one wire a line, ``pin03_x_clock``

Rule 1: a wire is named by its pin of the DB25 and by what hangs on it. What a card makes of the
        lines (coil currents) has wires of its own.
Rule 2: time is the driver's clock, in ns, and begins at the first access.
Rule 3: only changes are written. What a line was before its first write is not known (x).
Rule 4: a line that changes twice at one moment, as on a clock that jumps, does so 1 ns apart: no
        pulse is lost.
Rule 5: now and then all levels are written again, unchanged: a reader can begin there.
Rule 6: a file that cannot be begun is refused. One that cannot be gone on with ends there, and a
        sentence says so; what it shows goes on.
"""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, TextIO

from vcd import VCDWriter

from fraese.errors import TraceError
from fraese.motor.meaning import Meaning
from fraese.motor.pins import CONTROL_PINS, DATA_PINS, STATUS_PINS, Line
from fraese.motor.seams import CONTROL, DATA, STATUS
from fraese.phrases import phrase, reason

_PINS: Final[Mapping[int, Mapping[int, Line]]] = {
    DATA: DATA_PINS,
    STATUS: STATUS_PINS,
    CONTROL: CONTROL_PINS,
}
#: Between two writings of all levels, accesses.
_ALL_EVERY: Final = 50_000
#: Changes that are written together, if they come within a second.
_TOGETHER: Final = 500
_AT_LEAST_NS: Final = 1_000_000_000
_NOTHING_YET: Final = -1
_EVERY: Final = 0xFF


class Waveform:
    """A waveform file.

    Args:
        path: of the file. A waveform that was there before is gone.
        scope: what the lines belong to, one word.
        meaning: what hangs on them.

    Attributes:
        path: as given.
        changes: moments at which something changed.
        missing: accesses that could not be noted.
        failure: why the file ends before its end; empty: it does not.

    Raises:
        TraceError: if it cannot be written, or there is another kind of file.
    """

    def __init__(self, path: Path, scope: str, meaning: Meaning) -> None:
        self.path = path
        self.changes = self.missing = 0
        self.failure = ""
        self._file = _opened(path)
        self._decoder = meaning.decoder()
        writer = VCDWriter(self._file, timescale="1 ns", version="fraese")
        self._wires: dict[int, list[tuple[Line, Any]]] = {
            register: [
                (line, writer.register_var(scope, _name(pin, meaning.pins), "wire", size=1))
                for pin, line in pins.items()
            ]
            for register, pins in _PINS.items()
        }
        names = self._decoder.names if self._decoder else ()
        self._quantities = [writer.register_var(scope, name, "real") for name in names]
        self._values = [0] * len(names)
        self._levels = [_NOTHING_YET] * len(_PINS)
        self._just_changed = [0] * len(_PINS)
        self._texts: dict[tuple[int, int, int], str] = {}
        self._pending: list[str] = []
        self._begin_ns: int | None = None
        self._now_ns = self._written_ns = 0
        self._until_all = _ALL_EVERY
        try:
            writer.flush()
        except OSError as error:
            with suppress(OSError):
                self._file.close()
            raise _refusal(path, error) from error

    @property
    def duration_s(self) -> float:
        """From the first access to the last moment that was written."""
        return self._written_ns * 1e-9

    @property
    def is_whole(self) -> bool:
        """Everything that happened is in it."""
        return not self.failure and not self.missing

    def note(self, at_ns: int, register: int, value: int) -> None:
        """A register was written, or read, with this value; never raises for the file."""
        if self.failure:
            return
        if self._begin_ns is None:
            self._begin_ns = at_ns
        before = self._levels[register]
        bits = _EVERY if before == _NOTHING_YET else before ^ value
        text = self._changed(register, value)
        if not text:
            return
        now_ns = self._moment_ns(at_ns - self._begin_ns, register, bits)
        self.changes += 1
        self._until_all -= 1
        if not self._until_all:
            self._until_all = _ALL_EVERY
            text += self._all()
        is_same = now_ns == self._now_ns and self.changes > 1
        self._now_ns = now_ns
        self._write(text if is_same else f"#{now_ns}\n{text}")

    def skip(self, accesses: int) -> None:
        """So many accesses could not be noted just now."""
        self.missing += accesses
        if not self.failure:
            self._write(f"$comment {accesses} accesses are missing here $end\n")

    def close(self, at_ns: int) -> None:
        """The last moment, and the end of the file. Safe to call twice."""
        if self._file.closed:
            return
        if self._begin_ns is not None:
            end_ns = at_ns - self._begin_ns
            if end_ns > self._now_ns:
                self._now_ns = end_ns
                self._write(f"#{end_ns}\n")
        self._flush()
        with suppress(OSError):
            self._file.close()

    def sentence(self) -> str:
        """What became of it, for people."""
        if self.failure:
            return phrase(
                "{path}: the waveform ends soon after {duration_s:.6g} s: {failure}; the"
                " job went on without it.",
                path=self.path,
                duration_s=self.duration_s,
                failure=self.failure,
            )
        said = phrase(
            "{path}: waveform of {duration_s:.6g} s, {changes} changes",
            path=self.path,
            duration_s=self.duration_s,
            changes=self.changes,
        )
        if not self.missing:
            return said + "."
        return phrase("{said}; {missing} accesses are missing.", said=said, missing=self.missing)

    def _moment_ns(self, at_ns: int, register: int, bits: int) -> int:
        """When a change is written: never before the last one, or together with its own."""
        now_ns = max(at_ns, self._now_ns)
        if now_ns == self._now_ns and self._just_changed[register] & bits:
            now_ns += 1
        if now_ns > self._now_ns:
            self._just_changed = [0] * len(_PINS)
        self._just_changed[register] |= bits
        return now_ns

    def _changed(self, register: int, value: int) -> str:
        """What there is to write for an access; empty: nothing has changed."""
        text = ""
        before = self._levels[register]
        if value != before:
            self._levels[register] = value
            key = (register, before, value)
            text = self._texts.get(key, "") or self._texts.setdefault(key, self._text(*key))
        if self._decoder is not None:
            for number, now in self._decoder.seen(register, value):
                if self._values[number] != now:
                    self._values[number] = now
                    text += self._quantities[number].format_value(now) + "\n"
        return text

    def _text(self, register: int, before: int, value: int) -> str:
        """Lines of a register that differ."""
        is_first = before == _NOTHING_YET
        return "".join(
            wire.format_value(int(bool(value & line.bit) != line.inverted)) + "\n"
            for line, wire in self._wires[register]
            if is_first or (before ^ value) & line.bit
        )

    def _all(self) -> str:
        lines = "".join(
            self._text(register, _NOTHING_YET, level)
            for register, level in enumerate(self._levels)
            if level != _NOTHING_YET
        )
        values = zip(self._quantities, self._values, strict=True)
        return f"$dumpall\n{lines}{''.join(w.format_value(v) + chr(10) for w, v in values)}$end\n"

    def _write(self, text: str) -> None:
        """Gather text; now and then, and at least every second of the waveform, write it."""
        self._pending.append(text)
        if len(self._pending) >= _TOGETHER or self._now_ns - self._written_ns > _AT_LEAST_NS:
            self._flush()

    def _flush(self) -> None:
        if self.failure:
            return
        try:
            self._file.write("".join(self._pending))
            self._file.flush()
        except OSError as error:
            self._fail(error)
        else:
            self._pending.clear()
            self._written_ns = self._now_ns

    def _fail(self, error: OSError) -> None:
        self.failure = error.strerror or str(error)
        with suppress(OSError):
            self._file.close()


def _opened(path: Path) -> TextIO:
    try:
        if path.is_file() and not _is_waveform(path):
            raise TraceError(
                phrase(
                    "{path} is there and is no waveform; it is not overwritten. Name another file.",
                    path=path,
                )
            )
        return path.open("w", encoding="ascii")
    except OSError as error:
        raise _refusal(path, error) from error


def _is_waveform(path: Path) -> bool:
    """A file may be overwritten: it is empty, or begins as a VCD file does."""
    with path.open("rb") as file:
        return file.read(64).lstrip()[:1] in (b"", b"$")


def _refusal(path: Path, error: OSError) -> TraceError:
    return TraceError(
        phrase("{path}: the waveform cannot be written: {reason}.", path=path, reason=reason(error))
    )


def _name(pin: int, names: Mapping[int, str]) -> str:
    return f"pin{pin:02d}_{names.get(pin, 'free')}"
