"""What the step process makes of two motors in real time, at rates up to the paper's.

    .venv/bin/python examples/pulses/real_time.py

Nothing is on the port: what is measured is the real process with the real core up to the port's
door. A parallel port adds some 1.2 us to every byte.
"""

import argparse

from drives import MOTORS, STEP_ANGLE_DEG, SUBDIVISION, TOP_RATE_HZ
from speeds import rev_min

from fraese.errors import PortError
from fraese.motor.realtime.measure import measure, stepdir_duty

RATES_HZ = (5_000, 10_000, 20_000, 40_000, 60_000, TOP_RATE_HZ)


def main() -> None:
    parser = argparse.ArgumentParser(description="Pulse rates in real time.")
    parser.add_argument("rates", nargs="*", type=int, default=RATES_HZ, metavar="HZ")
    parser.add_argument("--seconds", type=float, default=1.0, help="for each rate")
    told = parser.parse_args()
    if told.seconds <= 0 or not all(10 <= rate <= TOP_RATE_HZ for rate in told.rates):
        parser.error(f"rates are 10 to {TOP_RATE_HZ} Hz, and last longer than 0 s")

    print(f"{'wanted':>8} {'rev/min':>8} {'made':>8} {'late, p99':>10} {'late > 1/4':>11}")
    for rate in told.rates:
        try:
            seen = measure(stepdir_duty("paper", rate, motors=MOTORS), told.seconds)
        except PortError as error:
            raise SystemExit(str(error)) from error
        speed = rev_min(rate, STEP_ANGLE_DEG, SUBDIVISION)
        late = seen.late_edges() / max(1, len(seen.late_us))
        p99_us = seen.percentiles_us()[1]
        print(f"{rate:8d} {speed:8.0f} {seen.played_hz:8.0f} {p99_us:7.1f} us {late:10.2%}")


if __name__ == "__main__":
    main()
