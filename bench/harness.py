"""How much faster than real time a test's machine is, by the processor time of this process.

Run: python -m bench.harness
"""

import time
from collections.abc import Callable
from pathlib import Path

from fraese.testing import Mill

_EXAMPLES = Path(__file__).parents[1] / "examples"
_BEST_OF = 3
#: Short lines of all axes: what engraving is made of.
_SHORT = "G21 G90 G64\nF1200\n" + "".join(
    f"G1 X{n % 40 + n % 3 / 10} Y{n // 40} Z-{n % 2}\n" for n in range(1, 400)
)


def _home(mill: Mill) -> object:
    return mill.home()


def _plate(mill: Mill) -> object:
    return mill.run(_EXAMPLES / "plate.ngc", yes=True)


def _short_lines(mill: Mill) -> object:
    return mill.run(_SHORT + "M2\n")


def _short_lines_looked_at(mill: Mill) -> object:
    mill.each(lambda: mill.carriages_mm)
    return _short_lines(mill)


def _long_way(mill: Mill) -> object:
    return mill.run("G21 G90\nG1 X250 Y150 F600\nG1 X10 Y10\nM2\n")


def main() -> None:
    """Print a table."""
    kinds: dict[str, Callable[[Mill], object]] = {
        "reference run of three axes": _home,
        "examples/plate.ngc": _plate,
        "400 short lines": _short_lines,
        "the same, carriages looked at every 0.1 s": _short_lines_looked_at,
        "long ways": _long_way,
    }
    print(f"{'':44}{'machine':>10}{'computer':>10}{'faster':>8}")
    for name, do in kinds.items():
        best = min(_timed(do) for _ in range(_BEST_OF))
        print(f"{name:44}{best[1]:8.1f} s{best[0]:8.2f} s{best[1] / best[0]:8.0f}")


def _timed(do: Callable[[Mill], object]) -> tuple[float, float]:
    """Processor time and machine time, s."""
    with Mill() as mill:
        if do is not _home:
            mill.home()
        machine_s, computer_s = mill.now_s, time.process_time()
        do(mill)
        return time.process_time() - computer_s, mill.now_s - machine_s


if __name__ == "__main__":
    main()
