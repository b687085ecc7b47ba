"""A neighbour on the same machine: a thread of LinuxCNC's HAL at the same period.

    slice   HAL | ours, with rights | ours, without any | HAL ...      in the same minutes

Rule 1: HAL's component ``timedelta`` tells by how much each interval differs from the period.
        Summed up, that is how late each cycle was, after the earliest one.
Rule 2: a thread of HAL catches up after a delay, with cycles that are too short; our steps never
        do. So the shortest interval is told, too.
Rule 3: HAL runs as it does for an ordinary user; ours with the rights that there are, and without
        any.
"""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from bench.timing import single
from bench.timing.figures import Row, Section, together

_HALRUN = shutil.which("halrun")
_REASON = "LinuxCNC is missing: apt-get install --no-install-recommends linuxcnc-uspace"
_NOBODY = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")
_PERIOD_NS = 50_000
_SLICES = 3
_PATIENCE_S = 30.0
#: Samples are taken up from memory by a process that may be slow.
_DEPTH = 200_000
_PROGRAM = """loadrt threads name1=beat period1={period}
loadrt timedelta
loadrt sampler depth={depth} cfg=s
net error timedelta.0.current-error => sampler.0.pin.0
addf timedelta.0 beat
addf sampler.0 beat
start
loadusr -w halsampler -n {count} {path}
show pin timedelta.0.jitter
"""


def _hal(seconds: float) -> tuple[Row, "np.typing.NDArray[np.int64]", str]:
    """One slice: the row, the errors of its intervals in ns, what HAL says about itself."""
    count = round(seconds * 1e9 / _PERIOD_NS)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        path = Path(folder) / "errors"
        program = Path(folder) / "beat.hal"
        program.write_text(_PROGRAM.format(period=_PERIOD_NS, depth=_DEPTH, count=count, path=path))
        assert _HALRUN is not None
        prefix = _NOBODY if os.geteuid() == 0 else ()
        done = subprocess.run(
            [*prefix, _HALRUN, "-f", str(program)],
            env={**os.environ, "HOME": folder},
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=seconds + _PATIENCE_S,
            check=True,
        )
        error_ns = np.array(
            [int(word) for word in path.read_text().split() if word.lstrip("-").isdecimal()]
        )
    notes = {line for line in (done.stdout + done.stderr).splitlines() if "Note" in line}
    return _row(error_ns), error_ns, "; ".join(sorted(notes))


def _row(error_ns: "np.typing.NDArray[np.int64]") -> Row:
    """Lateness from the errors of the intervals; the first ones are of the start."""
    error_ns = error_ns[np.flatnonzero(error_ns)[0] :]
    late_us = np.cumsum(error_ns) / 1000
    late_us -= late_us.min()
    played_hz = 1e9 / (_PERIOD_NS + error_ns.mean())
    return Row("HAL", late_us, _PERIOD_NS / 1000, float(played_hz))


def _intervals(error_ns: "np.typing.NDArray[np.int64]") -> str:
    median, p999 = np.percentile(np.abs(error_ns), (50, 99.9)) / 1000
    shortest_us = (error_ns.min() + _PERIOD_NS) / 1000
    return (
        f"intervals differ from 50 us by {median:.1f} us in the median, p99.9 {p999:.0f} us; the"
        f" shortest took {shortest_us:.1f} us."
    )


def neighbour(seconds: float) -> Section:
    """Alternate slices of so many seconds in all, each kind."""
    title = "Beside LinuxCNC's HAL, every 50 us"
    if _HALRUN is None:
        return Section("neighbour", title, [], [_REASON])
    slice_s = max(2.0, seconds / _SLICES)
    hal, ours, plain, errors_ns = [], [], [], []
    said, notes, plain_notes = "", "", ""
    for _ in range(_SLICES):
        measured, error_ns, said = _hal(slice_s)
        hal.append(measured)
        errors_ns.append(error_ns)
        measured, notes = single.row("ours", "x4step", slice_s)
        ours.append(measured)
        if os.geteuid() == 0:
            measured, plain_notes = single.row("plain", "x4step", slice_s, single.NO_RIGHTS)
            plain.append(measured)
    rows = [together("HAL thread, ordinary user", hal)]
    rows.append(together("X4Step, rights as granted", ours))
    if plain:
        rows.append(together("X4Step, ordinary rights", plain))
    return Section(
        "neighbour",
        title,
        rows,
        [
            f"HAL says: {said or 'nothing'}. Its thread does nothing but take its own times. Its"
            f" {_intervals(np.concatenate(errors_ns))} It catches up; our intervals are never"
            " shorter than 15/16 of what was planned.",
            f"Granted to ours: {notes}."
            + (f" With ordinary rights: {plain_notes}." if plain else ""),
        ],
    )
