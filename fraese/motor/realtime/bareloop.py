"""What the machine itself takes from a loop that only looks at the time.

The steps cannot be more punctual than this. ``python -m fraese.motor.realtime.bareloop SECONDS``
prints one number a line: how long each interruption took, ns. It is a program of its own, since it
is measured under the same conditions as the step process.
"""

import subprocess
import sys
import time
from typing import Final

from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.setup import RealtimeOptions, Setup
from fraese.motor.realtime.system import prepare
from fraese.spawn import command, environment

_MODULE: Final = "fraese.motor.realtime.bareloop"
#: Two looks at the time are hardly a microsecond apart, ns: more is an interruption.
_INTERRUPTED_NS: Final = 3_000
_NS_PER_S: Final = 1_000_000_000
#: A rate at which the loop never sleeps, so that it is not run under SCHED_FIFO.
_NO_SLEEP_HZ: Final = 20_000.0


def interruptions_us(seconds: float) -> list[float]:
    """Measure in a process of its own.

    Args:
        seconds: for how long.

    Returns:
        How long each interruption took.
    """
    done = subprocess.run(
        command(_MODULE, str(seconds)),
        capture_output=True,
        start_new_session=True,
        check=True,
        text=True,
        env=environment(),
    )
    return [int(line) / 1000 for line in done.stdout.split()]


def _watch(seconds: float) -> list[int]:
    now_ns = time.monotonic_ns
    longer: list[int] = []
    last = now_ns()
    end = last + round(seconds * _NS_PER_S)
    while last < end:
        now = now_ns()
        if now - last > _INTERRUPTED_NS:
            longer.append(now - last)
        last = now
    return longer


def main(seconds: float) -> None:
    """Print the interruptions."""
    prepare(Setup(NullPort, SmcCard(), options=RealtimeOptions(top_rate_hz=_NO_SLEEP_HZ)))
    sys.stdout.writelines(f"{ns}\n" for ns in _watch(seconds))


if __name__ == "__main__":
    main(float(sys.argv[1]))
