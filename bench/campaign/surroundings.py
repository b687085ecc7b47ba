"""What changes around a command that mills: the clock, the program's file, another command.

Truth: the fake port's carriages. The job goes on as it was begun, and what is claimed at its end is
where they are.
"""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Final

from bench.campaign.claims import claim_of, claimed
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.signals import begin, fake_port_missing
from bench.campaign.warm import Warm
from tests.rigs.lpt.shop import STEPS_PER_MM, Shop
from tests.rigs.lpt.steps import check_motors_off

_WITHIN_S: Final = 0.8
_YEAR_S: Final = 31_557_600
_HOUR_S: Final = 3600
#: Seconds by which the clock may be set, either way.
_SETS_S: Final = (1, 60, _HOUR_S, 86_400, _YEAR_S, 11 * _YEAR_S, 54 * _YEAR_S)
#: It ends at X1 Y0.5, which is nowhere else on its way, two seconds after its begin.
_PART: Final = "G21 G90\n" + "G1 X4 Y2 F1200\nX0 Y0\n" * 3 + "X1 Y0.5\nM2\n"
_END_STEPS: Final = (STEPS_PER_MM, STEPS_PER_MM // 2, 0)
#: What is put into its place.
_OTHER: Final = "G21 G90\n" + "G1 X-3 Y3 F1200\nX0 Y0\n" * 9 + "X-2 Y-2\nM2\n"
#: A command ends so soon if another one drives.
REFUSED_S: Final = 1.0
#: Accesses to the port in as long as another Python may take to start, on a busy machine.
_MINUTES: Final = 5_000_000


def clock_set(attempt: Attempt) -> Outcome:
    """The clock of the day is set while it moves, some times, and not back."""
    shop, chance = begin(attempt), attempt.random
    with shop.begun("run", "long.ngc", "--json") as command:
        for _ in range(chance.randint(1, 3)):
            time.sleep(chance.uniform(0, _WITHIN_S / 2))
            shop.fake.set_clock(chance.choice((-1, 1)) * chance.choice(_SETS_S))
        time.sleep(chance.uniform(0, _WITHIN_S / 2))
        chance.choice((command.terminate, command.kill))()
        at_ns = time.monotonic_ns()
        command.communicate(timeout=20)
    # The clock of the next one is another one still.
    shop.fake.set_clock(chance.choice((0, 1, -1)) * chance.choice(_SETS_S))
    _wait_for_the_end(shop)
    took_ms = (shop.fake.events()[-1].at_ns - at_ns) * 1e-6
    check_motors_off(shop.fake.writes())
    claim, true_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(true_steps) + (not claim.is_to_the_step)
    return Outcome(beyond, took_ms, f"claimed {claim}, true {true_steps}")


def _wait_for_the_end(shop: Shop) -> None:
    """Whoever had the port has given it back."""
    shop.fake.wait_for(lambda: shop.fake.events(max(0, shop.fake.count() - 1))[0].what == "X")


# --- the file ------------------------------------------------------------------------------------


def _truncate(path: Path, chance: Random) -> None:
    with path.open("r+b") as file:
        file.truncate(chance.randrange(path.stat().st_size))


def _insert(path: Path, chance: Random) -> None:
    text, at = path.read_text(), chance.randrange(len(_PART))
    with path.open("r+") as file:
        file.write(text[:at] + chance.choice("0123456789.XG \n") + text[at:])


def _rewrite(path: Path, _: Random) -> None:
    with path.open("r+") as file:
        file.write(_OTHER)


def _replace(path: Path, _: Random) -> None:
    fresh = path.with_suffix(".new")
    fresh.write_text(_OTHER)
    fresh.replace(path)


def _vanish(path: Path, _: Random) -> None:
    path.unlink()


_CHANGES: Final[tuple[Callable[[Path, Random], None], ...]] = (
    _truncate,
    _insert,
    _rewrite,
    _replace,
    _vanish,
)


def file_changed(attempt: Attempt) -> Outcome:
    """The program's file changes or vanishes while it runs: it is milled as it was begun."""
    shop, chance = begin(attempt), attempt.random
    (shop.folder / "part.ngc").write_text(_PART)
    change = chance.choice(_CHANGES)
    with shop.begun("run", "part.ngc", "--json") as command:
        time.sleep(chance.uniform(0, _WITHIN_S))
        change(shop.folder / "part.ngc", chance)
        answer = shop.end(command)
    assert answer.code == 0, f"{change.__name__}: exit code {answer.code}: {answer.noted}"
    check_motors_off(shop.fake.writes())
    off = sum(abs(a - b) for a, b in zip(shop.travelled_steps(), _END_STEPS, strict=True))
    off += claim_of(answer).beyond_steps(_END_STEPS)
    return Outcome(off, None, f"{change.__name__}: {answer.result}, {shop.travelled_steps()}")


# --- two of them ---------------------------------------------------------------------------------


def second(attempt: Attempt) -> Outcome:
    """Another command that drives: refused, told who, and the first one goes on."""
    chance = attempt.random
    port = chance.choice(("ppdev", "devport"))
    shop = Shop(attempt.folder, port, popen=Warm, capacity=_MINUTES)
    with shop.begun("run", "long.ngc", "--json") as command:
        time.sleep(chance.uniform(0, _WITHIN_S))
        since_s = time.monotonic()
        # With all the time that a person waits for it: Python's own start, too.
        other = subprocess.run(
            [sys.executable, "-m", "fraese", *chance.choice(_SECONDS)],
            cwd=shop.folder, env=shop.environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        took_s = time.monotonic() - since_s
        assert other.returncode == 1, f"exit code {other.returncode}: {other.stderr}"
        assert f"(process {command.pid})" in other.stderr, other.stderr
        looked = shop.command("where", "--json")
        assert looked.code == 0, looked.noted
        command.terminate()
        answer = shop.end(command)
    assert answer.code == 130, answer.noted
    at_port = {event.pid for event in shop.fake.events()}
    assert len(at_port) == 1, "another process was at the port"
    claim, true_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(true_steps) + (not claim.is_to_the_step)
    return Outcome(beyond, took_s, f"claimed {claim}, true {true_steps}")


_SECONDS: Final = (("move", "X1"), ("home",), ("run", "part.ngc"), ("where", "--fresh"))


def at_once(attempt: Attempt) -> Outcome:
    """Two commands that drive begin at the same moment: each moves or is refused."""
    shop, chance = begin(attempt), attempt.random
    started = []
    for _ in range(2):
        started.append(shop.start("move", "X1", "--relative", "--json"))
        time.sleep(chance.choice((0.0, chance.uniform(0, 0.1))))
    answers = [shop.end(process) for process in started]
    done = sum(answer.code == 0 for answer in answers)
    refused = sum(answer.code == 1 and "is driven by" in answer.noted for answer in answers)
    assert done + refused == 2, [answer.noted for answer in answers]
    assert done >= 1, "both were refused"
    claim, true_steps = claimed(shop), shop.travelled_steps()
    off = claim.beyond_steps(true_steps) + abs(true_steps[0] - done * STEPS_PER_MM)
    return Outcome(off, done, f"{done} moved, claimed {claim}, true {true_steps}")


KINDS: Final = (
    Kind("clock set while it moves", "ms from the end of the command to motors off", clock_set,
         missing=fake_port_missing),
    Kind("program file changed or gone while it runs", "-", file_changed,
         missing=fake_port_missing),
    Kind("second command while one mills", "s until it was refused", second,
         missing=fake_port_missing),
    Kind("two commands at the same moment", "of them moved", at_once,
         missing=fake_port_missing),
)  # fmt: skip
