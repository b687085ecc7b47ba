"""Linear acceleration to 5000 rev/min, and what a motor makes of it with and without.

    .venv/bin/python examples/pulses/acceleration.py
    .venv/bin/python examples/pulses/acceleration.py --seconds 0.4

Time is virtual here: 133,333 pulses a second are more than a step process in Python makes. What is
made in real time shows ``real_time.py``.
"""

import argparse

from drives import HALF_STEPS, HYBRID, STEP_ANGLE_DEG, SUBDIVISION, TOP_RATE_HZ, Drives, drives
from speeds import rev_min

from fraese.x4step.paths import path

#: Seconds at full speed between the ramps.
_LEVEL_S = 0.1
_POINTS = 10


def rates_hz(port: Drives, times_s: list[float]) -> list[float]:
    """Pulse rate at those times after the first pulse."""
    rises_s = [at_ns * 1e-9 for at_ns, value in port.bytes_written() if value & 0b10]
    found, place = [], 0
    for time_s in times_s:
        while place < len(rises_s) - 2 and rises_s[place + 1] - rises_s[0] < time_s:
            place += 1
        found.append(1 / (rises_s[place + 1] - rises_s[place]))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description="Linear acceleration to 5000 rev/min.")
    parser.add_argument("--seconds", type=float, default=0.8, help="of each ramp")
    told = parser.parse_args()
    if not 0.01 <= told.seconds <= 10:
        parser.error("a ramp takes 0.01 to 10 seconds")

    ramp_ms = round(told.seconds * 1000)
    pulses = round(TOP_RATE_HZ * (told.seconds + _LEVEL_S))
    with drives(motor=HYBRID) as port:
        port.play(path((pulses, 0), TOP_RATE_HZ, ramp_ms))
        times = [told.seconds * n / _POINTS for n in range(1, _POINTS + 1)]
        print(f"{'s':>6} {'pulses/s':>10} {'linear':>10} {'rev/min':>9}")
        for at_s, rate in zip(times, rates_hz(port, times), strict=True):
            linear = TOP_RATE_HZ * at_s / told.seconds
            speed = rev_min(rate, STEP_ANGLE_DEG, SUBDIVISION)
            print(f"{at_s:6.3f} {rate:10.0f} {linear:10.0f} {speed:9.0f}")
        _tell(f"ramps of {told.seconds:g} s", port, pulses)
    with drives(motor=HYBRID) as port:
        port.play(path((pulses, 0), TOP_RATE_HZ, 0))
        _tell("no ramps", port, pulses)


def _tell(what: str, port: Drives, pulses: int) -> None:
    turned = port.mill.look().carriages_steps[0] / HALF_STEPS
    print(f"{what}: {pulses} pulses given, the motor turned by {turned:.0f} of them")


if __name__ == "__main__":
    main()
