"""Memory and time of ``fraese check`` on a file of a million lines; the aim is below 150 MB."""

import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

LINES = 1_000_000
AIM_MB = 150


def _lines() -> Iterator[str]:
    yield "G21 G90 F1200\n"
    for number in range(LINES - 2):
        x, y = number % 997 / 10, number // 997 % 1500 / 10
        yield f"G1 X{x:.3f} Y{y:.3f} Z{-(number % 7) / 10:.1f}\n"
    yield "M2\n"


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "million.ngc"
        with path.open("w") as file:
            file.writelines(_lines())
        begun_s = time.monotonic()
        words = ["check", str(path), "--json", "--state", folder]
        done = subprocess.run([sys.executable, "-m", "fraese", *words], check=False)
        took_s = time.monotonic() - begun_s
    # Linux counts in kilobytes.
    most_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1000
    print(f"{most_mb:.0f} MB, {took_s:.1f} s, {LINES / took_s:,.0f} lines/s")
    return done.returncode or most_mb > AIM_MB


if __name__ == "__main__":
    raise SystemExit(main())
