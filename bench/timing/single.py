"""One measurement in a process of its own: ``python -m bench.timing.single DUTY SECONDS FILE``.

Writes to the file: lateness as 32-bit floats in us, after one line of JSON about it.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from bench.timing.figures import Row
from fraese.motor.realtime.measure import measure, smc_duty, stepdir_duty
from fraese.spawn import command, environment

DUTIES = {"smc": smc_duty, "x4step": lambda: stepdir_duty("x4step")}
_MODULE = "bench.timing.single"
#: For those who are root: all that makes root more than a user is taken away, but not the files.
NO_RIGHTS = ("setpriv", "--bounding-set=-all", "--inh-caps=-all")


def row(name: str, duty: str, seconds: float, prefix: tuple[str, ...] = ()) -> tuple[Row, str]:
    """Measure in another process, as another user if the prefix says so; notes of the child."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        path = Path(folder) / "samples"
        subprocess.run(
            [*prefix, *command(_MODULE, duty, str(seconds), str(path))],
            env=environment(),
            check=True,
            start_new_session=True,
        )
        head, _, data = path.read_bytes().partition(b"\n")
    facts = json.loads(head)
    late_us = np.frombuffer(data, np.float32).astype(np.float64)
    return Row(name, late_us, facts["interval_us"], facts["played_hz"], facts["slipped"]), facts[
        "notes"
    ]


def main(duty: str, seconds: float, path: Path) -> None:
    """Measure, and write it down."""
    result = measure(DUTIES[duty](), seconds)
    facts = {
        "interval_us": result.duty.interval_us,
        "played_hz": result.played_hz,
        "slipped": result.late_ticks,
        "notes": ", ".join(result.notes),
    }
    data = result.late_us.astype(np.float32).tobytes()
    path.write_bytes(json.dumps(facts).encode() + b"\n" + data)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), Path(sys.argv[3]))
