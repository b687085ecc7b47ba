"""MOTOR.ASM: one motor forward, the other back, 65,535 pulses each, out of two bytes.

The printed program writes 00001011 and 00000001 in turn, with a delay behind each: 48 passes of a
loop, and two times 784, so the pulses are high for 3 % of the time. Here:

    .venv/bin/python examples/pulses/two_motors.py --trace two.vcd
    .venv/bin/fraese trace two.vcd --to 500us

Misprints of the paper: the first delay is a byte that is loaded into a word, neither delay returns,
and one of its labels is the name of an instruction.
"""

import argparse
from pathlib import Path

from drives import HALF_STEPS, TOP_RATE_HZ, drives

from fraese.x4step.paths import path

PULSES = 0xFFFF
#: Passes of the delay loops: behind 00001011, and behind 00000001.
HIGH_PASSES, LOW_PASSES = 0x30, 2 * 0x0310


def main() -> None:
    parser = argparse.ArgumentParser(description="One motor forward, the other back.")
    parser.add_argument("--pulses", type=int, default=PULSES, help="of each motor")
    parser.add_argument("--rate", type=int, default=10_000, metavar="HZ", help="pulses a second")
    parser.add_argument(
        "--duty", type=float, default=HIGH_PASSES / (HIGH_PASSES + LOW_PASSES),
        metavar="SHARE", help="of the time for which a pulse is high; 0.5 is one delay for both",
    )  # fmt: skip
    parser.add_argument("--trace", type=Path, metavar="FILE.vcd", help="waveform of the lines")
    told = parser.parse_args()
    if not (told.pulses > 0 and 10 <= told.rate <= TOP_RATE_HZ and 0 < told.duty < 1):
        parser.error(f"at least 1 pulse, 10 to {TOP_RATE_HZ} Hz, and a share between 0 and 1")

    with drives(duty=told.duty, trace=told.trace) as port:
        port.play(path((told.pulses, -told.pulses), told.rate, 0))
        written = port.bytes_written()
        seen = port.mill.look()

    first = " ".join(f"{value:02X}" for _, value in written[:6])
    print(f"bytes       {first} ... {written[-1][1]:02X}, {len(written)} in all")
    (rise, _), (fall, _), (again, _) = (*written[:2], written[2] if written[2:] else written[1])
    print(f"pulse       {(fall - rise) / 1000:.3f} us high, {(again - fall) / 1000:.3f} us low")
    for motor, half_steps in enumerate(seen.carriages_steps, 1):
        print(f"motor {motor}     {half_steps / HALF_STEPS:+.0f} pulses")
    if told.trace:
        print(f"waveform    {told.trace}")


if __name__ == "__main__":
    main()
