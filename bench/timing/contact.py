"""From a contact to the last step, on the fake port: counted in its log.

    status line goes to contact ---- read ---- rest of the tick in hand ---- nothing more
                  ^ from outside, at a random moment      ^ counted

The step process drives ``ppdev`` under the preloaded fake port of the tests. Three motors step on
every tick; a tick is made of one access after the other, so the contact falls anywhere in it.
"""

import random
import tempfile
import time
from functools import partial
from pathlib import Path

from bench.timing.figures import Section
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.ppdev import PpdevPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.measure import Duty
from fraese.motor.realtime.setup import RealtimeOptions, Setup
from fraese.motor.seams import CONTROL, DATA, STATUS
from fraese.motor.switches import SwitchInput
from tests.rigs.lpt.fakeport import CONTACT, Event, FakePort, missing
from tests.rigs.lpt.steps import MOTORS_OFF

_MODULE = "bench.timing.contact"
_RATE_HZ = 2000.0
_MOTORS = 3
_TRIALS = 20
_UNDER_WAY = 1500
_EACH_S = 2.0


def main() -> None:
    """In the process that has the port: three motors step until the contact stops them."""
    duty = Duty(SmcCard(), _RATE_HZ, _MOTORS, block_ticks=20_000)
    setup = Setup(
        partial(PpdevPort, "/dev/parport0"),
        duty.card,
        switch=SwitchInput(readings=1),
        options=RealtimeOptions(top_rate_hz=_RATE_HZ),
    )
    driver = RealtimeDriver(setup)
    try:
        driver.push(duty.block())
        while driver.poll(0.1).running:
            pass
    finally:
        driver.close()


def contact(seconds: float) -> Section:
    """So many seconds of trials, each at a random moment."""
    title = "From contact to the last step"
    if missing():
        return Section("contact", title, [], [missing()])
    chance = random.Random(8253)
    trials = max(3, min(_TRIALS, round(seconds / _EACH_S)))
    steps_after: list[int] = []
    after_us: list[float] = []
    for _ in range(trials):
        with tempfile.TemporaryDirectory() as folder:
            steps, us = _trial(FakePort(Path(folder)), chance)
        steps_after.append(steps)
        after_us.append(us)
    counts = ", ".join(f"{steps_after.count(n)} times {n}" for n in sorted(set(steps_after)))
    return Section(
        "contact",
        title,
        [],
        [
            f"In {trials} trials at {_RATE_HZ:g} ticks/s with {_MOTORS} motors, the contact at a"
            f" random moment, so many steps were made after it was read: {counts}. A tick has"
            f" {_MOTORS}, and the input is read after each: at most {_MOTORS - 1} are left. From"
            f" the reading to the last step: {max(after_us):.1f} us at most.",
        ],
    )


def _trial(fake: FakePort, chance: random.Random) -> tuple[int, float]:
    """Steps after the contact was read, and the time until the last of them."""
    process = fake.start(_MODULE)
    try:
        fake.wait_for(lambda: fake.count() > _UNDER_WAY)
        time.sleep(chance.uniform(0.0, 0.05))
        fake.press()
        process.communicate(timeout=60)
    finally:
        process.kill()
    events = fake.events()
    read = next(
        i for i, e in enumerate(events) if (e.what, e.register, e.value) == ("R", STATUS, CONTACT)
    )
    after = [e for e in events[read:] if _is_step(e)]
    last_ns = _latched_ns(events, after[-1]) if after else events[read].at_ns
    return len(after), (last_ns - events[read].at_ns) / 1000


def _is_step(event: Event) -> bool:
    return (event.what, event.register) == ("W", DATA) and event.value not in MOTORS_OFF


def _latched_ns(events: list[Event], step: Event) -> int:
    """When the strobe after it was over."""
    begin = events.index(step)
    strobes = [e.at_ns for e in events[begin:] if (e.what, e.register) == ("W", CONTROL)]
    return strobes[1]


if __name__ == "__main__":
    main()
