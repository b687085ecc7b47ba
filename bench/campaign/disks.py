"""The disk of the state is full, fails, can only be read, or takes no more, while a command mills.

in mid-job     it goes on, or brakes with an alarm; never "refused", exit code 2, or a traceback
at the start   refused, and nothing has moved
afterwards     whoever looks finds the carriages within what is claimed; truth: the fake port
"""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Final

from bench.campaign.claims import claim_of
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.mounts import Disk, fill, missing, mounted, small
from bench.campaign.signals import begin, fake_port_missing
from bench.campaign.warm import Warm
from tests.rigs.lpt.shop import STEPS_PER_MM, Answer, Shop
from tests.rigs.lpt.steps import check_motors_off

_WITHIN_S: Final = 0.8
#: A job that goes on is ended after so long.
_GOES_ON_S: Final = 1.5
_SIZES_KB: Final = (80, 128, 256, 1024)
_REFUSED: Final = 2


def _milled(shop: Shop, attempt: Attempt, break_it: Callable[[], object]) -> tuple[Answer, float]:
    """A command that mills, and something breaks; how it ended, and when after that."""
    with shop.begun("run", "long.ngc", "--json") as command:
        time.sleep(attempt.random.uniform(0, _WITHIN_S))
        break_it()
        at_s = time.monotonic()
        while command.poll() is None and time.monotonic() < at_s + _GOES_ON_S:
            time.sleep(0.002)
        took_s = time.monotonic() - at_s
        command.terminate()
        answer = shop.end(command)
    # It may have been on its way out already, and deaf.
    assert answer.code in (1, 130, -signal.SIGTERM), f"exit code {answer.code}: {answer.noted}"
    assert '"refused"' not in answer.said, answer.noted
    check_motors_off(shop.fake.writes())
    return answer, took_s


def _looked(shop: Shop) -> tuple[int, str]:
    """What is not accounted for, and what was said."""
    answer = shop.command("where", "--json")
    true_steps = shop.travelled_steps()
    if answer.code == _REFUSED:
        # It knows nothing and says so.
        return 0, answer.noted
    claim = claim_of(answer)
    return claim.beyond_steps(true_steps), f"claimed {claim}, true {true_steps}"


def full(attempt: Attempt) -> Outcome:
    """Full from some moment on; room again before somebody looks, or not."""
    shop, state = begin(attempt), attempt.folder / "user-state"
    with small(state, attempt.random.choice(_SIZES_KB)):
        answer, took_s = _milled(shop, attempt, lambda: fill(state))
        if attempt.random.random() < 0.5:
            (state / "filler").unlink()
        off, said = _looked(shop)
    return Outcome(off, took_s, f"{answer.noted}; {said}")


def failing(attempt: Attempt) -> Outcome:
    """An error of the disk: what it had stays, and nothing more can be written."""
    shop, state = begin(attempt), attempt.folder / "user-state"
    disk = Disk(attempt.folder / "disk.img")
    with disk.on(state):
        answer, took_s = _milled(shop, attempt, disk.fail)
        off, said = _looked(shop)
    return Outcome(off, took_s, f"{answer.noted}; {said}")


def limited(attempt: Attempt) -> Outcome:
    """The system lets the command write no more, as where a quota is used up."""
    shop, chance = begin(attempt), attempt.random
    commands: list[int] = []
    start = shop.start

    def started(*words: object) -> "subprocess.Popen[str]":
        process = start(*words)
        commands.append(process.pid)
        return process

    shop.start = started  # type: ignore[method-assign]
    bytes_left = chance.choice((0, 100, 40_000))

    def limit() -> None:
        resource.prlimit(commands[0], resource.RLIMIT_FSIZE, (bytes_left, bytes_left))

    answer, took_s = _milled(shop, attempt, limit)
    off, said = _looked(shop)
    return Outcome(off, took_s, f"{answer.noted}; {said}")


def never(attempt: Attempt) -> Outcome:
    """Full, or to be read only, from the start: refused, and nothing has moved; or it goes well."""
    shop, chance = begin(attempt), attempt.random
    state = attempt.folder / "user-state"
    is_full = chance.random() < 0.5
    words = ("-t", "tmpfs", "-o", "size=64k" if is_full else "ro", "tmpfs")
    since_s = time.monotonic()
    with mounted(state, *words):
        if is_full:
            (state / "fraese").mkdir()
            fill(state)
        answer = shop.command("move", "X1", "--relative", "--json")
    took_s = time.monotonic() - since_s
    assert answer.code == _REFUSED, f"exit code {answer.code}: {answer.noted}"
    return Outcome(sum(map(abs, shop.travelled_steps())), took_s, answer.noted)


def output(attempt: Attempt) -> Outcome:
    """Standard output and error are full or gone: the job's exit code is the job's."""
    shop, chance = begin(attempt), attempt.random
    words = ["run", "part.ngc", *chance.choice(((), ("--json",)))]
    (shop.folder / "part.ngc").write_text("G21 G91\n(MSG,here)\nG1 X1 F900\nM2\n")
    fds = [chance.choice((_full, _gone))() for _ in range(2)]
    try:
        process = Warm(
            [sys.executable, "-m", "fraese", *words],
            cwd=shop.folder,
            env=shop.environment,
            stdin=subprocess.DEVNULL,
            stdout=fds[0],
            stderr=fds[1],
        )
    finally:
        for fd in fds:
            os.close(fd)
    code = process.wait(30)
    assert code == 0, f"exit code {code}"
    check_motors_off(shop.fake.writes())
    return Outcome(abs(shop.travelled_steps()[0] - STEPS_PER_MM), None, f"{shop.travelled_steps()}")


def _full() -> int:
    return os.open("/dev/full", os.O_WRONLY)


def _gone() -> int:
    """A pipe of which the reader has gone."""
    reads, writes = os.pipe()
    os.close(reads)
    return writes


def _missing() -> str:
    return fake_port_missing() or missing()


_ENDED: Final = "s until the command has ended (1.5: it goes on)"
KINDS: Final = (
    Kind("disk full while it mills", _ENDED, full, missing=_missing),
    Kind("disk fails while it mills", _ENDED, failing, missing=_missing),
    Kind("no more may be written while it mills", _ENDED, limited, missing=fake_port_missing),
    Kind("disk full or read-only at the start", "s until it was refused", never, missing=_missing),
    Kind("standard output full or gone", "-", output, missing=fake_port_missing),
)  # fmt: skip
