"""How late the steps are: the step process on a port that leads nowhere, idle and under load.

``python -m bench.timing --seconds 10``; the machine should do nothing else meanwhile.
"""

import argparse
import os
from typing import Final

import numpy as np

from fraese.motor.realtime.bareloop import interruptions_us
from fraese.motor.realtime.measure import Duty, Lateness, hogs, measure, smc_duty, stepdir_duty

DUTIES: Final = {
    "smc": ("phase card, 5 kHz, three axes", smc_duty()),
    "x4step": ("X4Step, 20 kHz, four axes", stepdir_duty("x4step")),
    "paper": ("the paper, 133 kHz, one axis", stepdir_duty("paper", motors=1)),
}


def _line(name: str, result: Lateness) -> str:
    percentiles = "".join(f"{value:10.2f}" for value in result.percentiles_us())
    ticks = len(result.late_us)
    return (
        f"{name:34}{percentiles}{result.late_edges():9}{result.late_ticks:9}{ticks:10}"
        f"{result.dry_queues:5}{result.played_hz:10.0f}"
    )


def _measure(name: str, duty: Duty, seconds: float) -> Lateness:
    result = measure(duty, seconds)
    print(_line(name, result), flush=True)
    return result


def _bare(seconds: float) -> None:
    """What the machine takes from a loop that only looks at the time."""
    taken_us = interruptions_us(seconds)
    median, p99, longest = np.percentile(taken_us or [0.0], (50, 99, 100))
    print(
        f"a bare loop is interrupted {len(taken_us) / seconds:.0f} times a second, for"
        f" {median:.1f} us (p99 {p99:.1f}, longest {longest:.1f})"
    )


def main() -> None:
    """Print one line for each duty, idle and with a hog on every core."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=4.0, help="for each line")
    parser.add_argument("--only", choices=DUTIES, help="one of them")
    parser.add_argument("--block-ticks", type=int, default=2000, help="length of the blocks")
    given = parser.parse_args()
    cores = os.cpu_count() or 1
    _bare(given.seconds)
    columns = "".join(f"{name:>10}" for name in ("median", "p99", "p99.9", "longest"))
    print(
        f"{'late by, us':34}{columns}{'> 1/4':>9}{'slipped':>9}{'edges':>10}{'dry':>5}"
        f"{'played Hz':>10}"
    )
    for key, (name, duty) in DUTIES.items():
        if given.only not in (None, key):
            continue
        fed = Duty(duty.card, duty.rate_hz, duty.motors, given.block_ticks)
        result = _measure(name, fed, given.seconds)
        with hogs(cores):
            _measure(f"  {cores} hogs", fed, given.seconds)
        print(f"  {'; '.join(result.notes)}")


if __name__ == "__main__":
    main()
