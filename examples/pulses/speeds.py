"""Pulse rate and speed: table 3 of the paper, for any motor and any subdivision.

    .venv/bin/python examples/pulses/speeds.py
    .venv/bin/python examples/pulses/speeds.py --angle 0.9 --subdivision 16 --rate 20000

A turn has 360 / angle steps, and a step so many pulses as the drive divides it into:

    speed [rev/min] = rate [Hz] * 60 * angle / (360 * subdivision)
"""

import argparse

from drives import STEP_ANGLE_DEG, SUBDIVISION, TOP_RATE_HZ

SPEEDS = (1, 10, 60, 100, 300, 600, 1000, 1500, 2000, 3000, 4000, 5000)


def rev_min(rate_hz: float, angle_deg: float, subdivision: int) -> float:
    """Speed at a pulse rate."""
    return rate_hz * 60 * angle_deg / (360 * subdivision)


def rate_hz(speed_rev_min: float, angle_deg: float, subdivision: int) -> float:
    """Pulse rate for a speed."""
    return speed_rev_min * 360 * subdivision / (60 * angle_deg)


def main() -> None:
    parser = argparse.ArgumentParser(description="Pulse rate against speed.")
    parser.add_argument("--angle", type=float, default=STEP_ANGLE_DEG, help="of a step, degrees")
    parser.add_argument("--subdivision", type=int, default=SUBDIVISION, help="pulses for a step")
    parser.add_argument("--rate", type=float, metavar="HZ", help="one rate instead of the table")
    told = parser.parse_args()
    if told.angle <= 0 or told.subdivision < 1 or (told.rate is not None and told.rate <= 0):
        parser.error("angle, subdivision and rate are above 0")

    motor = told.angle, told.subdivision
    speeds = [rev_min(told.rate, *motor)] if told.rate else SPEEDS
    print(f"step angle {told.angle:g} degrees, {told.subdivision} pulses for a step")
    print(f"{'rev/min':>9} {'pulses/s':>11} {'interval, us':>13}")
    for speed in speeds:
        rate = rate_hz(speed, *motor)
        # A rate that is as good as the paper's is still the paper's.
        mark = "" if rate < TOP_RATE_HZ + 1 else "  faster than the paper's drives"
        print(f"{speed:9.1f} {rate:11.1f} {1e6 / rate:13.2f}{mark}")


if __name__ == "__main__":
    main()
