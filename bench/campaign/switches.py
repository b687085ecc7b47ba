"""End switches that are bad ones, in reference runs, jogs and programs; truth: the fake port.

    for one reading     a wrong one, at random moments
    bounces             after each change some readings are one way and the other
    sticks              once closed, it stays so
    opens late          once closed, it opens only some way further
    closed at start     somebody holds it, and lets go at some moment, or of a jog never

Whatever comes of the job, ok or an alarm: an axis that is said to be referenced has its zero where
the switch is, but for what a bounce takes, and any other one is where its counts say.
"""

import threading
from functools import partial
from typing import Final

from bench.campaign.claims import claim_of
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.signals import fake_port_missing
from bench.campaign.warm import Warm
from tests.rigs.lpt.shop import STEPS_PER_MM, Answer, Shop
from tests.rigs.lpt.steps import check_motors_off

_TRAVEL_MM: Final = 8
_PULL_OFF_STEPS: Final = STEPS_PER_MM // 2
#: As long as a contact bounces it is not one: so many readings later, at a step each.
_SPREAD_STEPS: Final = 15
_PROGRAM: Final = "G21 G91\nG1 X{x} Y{y} F900\nG1 X-{y} Y-{x}\nG1 X1 Y1\nM2\n"
#: A command is over within this, and most of it is motion.
_LIFE_S: Final = 2.0


def _words(attempt: Attempt, shop: Shop) -> tuple[str, ...]:
    chance = attempt.random
    axis = chance.choice("xy")
    x, y = (round(chance.uniform(0.5, 4.5), 2) for _ in range(2))
    (shop.folder / "job.ngc").write_text(_PROGRAM.format(x=x, y=y))
    jog = ("move", f"{axis}{chance.choice((x, -x))}", "--relative")
    return chance.choice((("home", axis), jog, ("run", "job.ngc")))


def _meddle(fault: str, attempt: Attempt, shop: Shop, words: tuple[str, ...]) -> threading.Thread:
    """What the switch does while the command runs."""
    fake, chance, over = shop.fake, attempt.random, threading.Event()
    moments_s = sorted(chance.uniform(0, _LIFE_S) for _ in range(chance.randint(1, 5)))
    if fault == "closed":
        fake.press()
    elif fault != "glitches":
        fake.spoil_switch(fault)

    def act() -> None:
        at_s = 0.0
        for moment_s in moments_s:
            over.wait(moment_s - at_s)
            at_s = moment_s
            if fault == "glitches":
                fake.spoil_switch(fault)
        # A reference run tries all ends, for a minute, as long as nobody lets go.
        if fault == "closed" and ("home" in words or len(moments_s) > 1):
            fake.let_go()

    return threading.Thread(target=act, daemon=True)


def bad(fault: str, attempt: Attempt) -> Outcome:
    """One job with it."""
    port = attempt.random.choice(("ppdev", "devport"))
    shop = Shop(attempt.folder, port, travel_mm=_TRAVEL_MM, popen=Warm)
    words = _words(attempt, shop)
    hand = _meddle(fault, attempt, shop, words)
    process = shop.start(*words, "--json")
    hand.start()
    try:
        answer = shop.end(process)
    finally:
        process.kill()
        hand.join()
    # Refused is only what has moved nothing.
    may_be = (0, 1) if any(shop.travelled_steps()) else (0, 1, 2)
    assert answer.code in may_be, f"{words}: exit code {answer.code}: {answer.noted}"
    if shop.fake.count():
        check_motors_off(shop.fake.writes())
    looked = shop.command("where", "--json")
    off, beyond = _off(shop, looked)
    said = f"{words}: {answer.result['message']}; {looked.said}, {shop.fake.carriages_steps()}"
    return Outcome(beyond, off, said)


def _off(shop: Shop, looked: Answer) -> tuple[float | None, int]:
    """How far zero is off, if there was a reference run; and what is not accounted for."""
    claim, off, beyond = claim_of(looked), None, 0
    assert claim.low_steps is not None
    assert claim.high_steps is not None
    travelled, carriages = shop.travelled_steps(), shop.fake.carriages_steps()
    for motor, (axis, referenced) in enumerate(looked.result["referenced"].items()):
        low, high = claim.low_steps[motor], claim.high_steps[motor]
        if referenced:
            assert axis in "xy", "z was not asked for"
            off = abs(carriages[motor] - _PULL_OFF_STEPS - low)
            beyond += max(off - _SPREAD_STEPS, 0)
        else:
            beyond += max(low - travelled[motor], travelled[motor] - high, 0)
    return off, beyond


_NAMES: Final = {
    "glitches": "end switch wrong for one reading",
    "bounces": "end switch bounces",
    "sticks": "end switch sticks",
    "late": "end switch opens late",
    "closed": "end switch closed at start",
}
KINDS: Final = tuple(
    Kind(name, "steps that zero is off", partial(bad, fault), missing=fake_port_missing)
    for fault, name in _NAMES.items()
)
