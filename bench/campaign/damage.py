"""Files of the state and the configuration, damaged or newer: refused, or not trusted, or right.

a machine at rest, or killed in motion --> its files, kept --> one byte (bit, page, end) another
where --json: never a place that is said to be known and is another one; truth: the fake port
"""

import shutil
import signal
import sys
import time
from functools import cache
from pathlib import Path
from random import Random
from tempfile import mkdtemp
from threading import Lock
from typing import Final, NamedTuple

from bench.campaign.claims import claim_of
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.signals import fake_port_missing
from bench.campaign.warm import Warm
from fraese.journal import pages
from tests.rigs.lpt.shop import Shop, child_of, is_alive
from tests.rigs.lpt.steps import check_motors_off
from tests.rigs.lpt.terminal import Terminal

_PORT: Final = "ppdev"
_REFUSED: Final = 2
_DIGEST: Final = 16
_APP: Final = (sys.executable, "-m", "fraese")
_lock: Final = Lock()


class Left(NamedTuple):
    """What a machine left behind: its files, and where its carriages are."""

    state: Path
    true_steps: tuple[int, ...]


@cache
def _left(in_motion: bool) -> Left:
    folder = Path(mkdtemp(prefix="fraese-left-"))
    shop = Shop(folder, _PORT, popen=Warm)
    # Not so far that it would be taken for the program's motion.
    for way in ("X0.5", "Y-1"):
        assert shop.command("move", way, "--relative").code == 0
    if in_motion:
        with shop.begun("run", "long.ngc") as command:
            child = child_of(command.pid)
            time.sleep(0.5)
            command.send_signal(signal.SIGKILL)
            shop.fake.wait_for(lambda: not is_alive(child))
        # Its last words would say more than the journal, which is what is tried.
        next((folder / "user-state/fraese").glob("*.words")).unlink()
    return Left(folder / "user-state", shop.travelled_steps())


def _another(data: bytes, chance: Random) -> bytes:
    """A bit, a byte, some zeros, a page that was lost, or less of it."""
    used = 4 * pages.PAGE
    at = chance.choice((0, pages.SLOT)) + chance.randrange(used)
    page = at // pages.PAGE * pages.PAGE
    return chance.choice(
        (
            _put(data, at, bytes((data[at] ^ 1 << chance.randrange(8),))),
            _put(data, at, chance.randbytes(1)),
            _put(data, at, bytes(chance.randint(1, used))),
            _put(data, page, bytes(pages.PAGE)),
            data[:at],
        )
    )


def _put(data: bytes, at: int, part: bytes) -> bytes:
    return data[:at] + part + data[at + len(part) :]


def _copied(attempt: Attempt) -> tuple[Shop, Path, Left]:
    shop = Shop(attempt.folder, _PORT, popen=Warm)
    with _lock:
        left = _left(attempt.random.random() < 0.5)
    shutil.copytree(left.state, attempt.folder / "user-state")
    (journal,) = (attempt.folder / "user-state/fraese").glob("*.journal")
    return shop, journal, left


def journal(attempt: Attempt) -> Outcome:
    """Something in it is another."""
    shop, path, left = _copied(attempt)
    data = _another(path.read_bytes(), attempt.random)
    path.write_bytes(data)
    answer = shop.command("where", "--json")
    if answer.code == _REFUSED:
        assert "--fresh" in answer.noted, answer.noted
        assert path.read_bytes() == data, "it was written to"
        return Outcome(0, 1.0)
    claim = claim_of(answer)
    beyond = claim.beyond_steps(left.true_steps) if claim.is_to_the_step else 0
    return Outcome(beyond, 0.0, f"claimed {claim}, true {left.true_steps}")


def newer(attempt: Attempt) -> Outcome:
    """The records are those of a version to come: refused, and left as they are."""
    shop, path, _ = _copied(attempt)
    data = bytearray(path.read_bytes())
    for start in range(0, len(data), pages.PAGE):
        page = data[start : start + pages.PAGE]
        version = pages.VERSION + attempt.random.randint(1, 60_000)
        page[4:6] = version.to_bytes(2, "big")
        body = bytes(page[:-_DIGEST])
        data[start : start + pages.PAGE] = body + pages._digest(body)
    path.write_bytes(data)
    words = attempt.random.choice((("where",), ("move", "X1"), ("run", "part.ngc")))
    answer = shop.command(*words, "--json")
    assert answer.code == _REFUSED, f"exit code {answer.code}: {answer.noted}"
    assert "another version of fraese" in answer.noted, answer.noted
    assert path.read_bytes() == data, "it was written to"
    return Outcome(sum(map(abs, shop.travelled_steps())))


def configuration(attempt: Attempt) -> Outcome:
    """One byte of it is another: refused, or the command does what it says."""
    shop, chance = Shop(attempt.folder, _PORT, popen=Warm), attempt.random
    path = attempt.folder / "fraese.toml"
    data = path.read_bytes()
    path.write_bytes(_put(data, attempt.number % len(data), chance.randbytes(1)))
    answer = shop.command("move", "X1", "--relative", "--json")
    true_steps = shop.travelled_steps()
    if answer.code:
        assert answer.code in (1, _REFUSED), answer.noted
        assert answer.code == _REFUSED or not any(true_steps), answer.noted
        return Outcome(sum(map(abs, true_steps)), 1.0, answer.noted)
    if not shop.fake.count():
        # Another port: nothing of this one's machine is claimed.
        return Outcome(sum(map(abs, true_steps)), 0.0)
    claim = claim_of(answer)
    return Outcome(claim.beyond_steps(true_steps), 0.0, f"claimed {claim}, true {true_steps}")


def standstill(attempt: Attempt) -> Outcome:
    """SIGKILL to the app at rest, a second after a jog and a zero: it keeps everything."""
    shop, chance = Shop(attempt.folder, _PORT, popen=Warm), attempt.random
    terminal = Terminal(_APP, shop.folder, shop.environment, Warm)
    try:
        terminal.wait_for("Hold")
        terminal.press(chance.choice("34"), chance.choice(("right", "left")))
        shop.fake.wait_for(lambda: any(shop.travelled_steps()))
        _wait_for_rest(shop)
        time.sleep(chance.uniform(0, 0.5))
        terminal.process.kill()
        terminal.wait_for_end()
    finally:
        terminal.close()
    _wait_for_end(shop)
    claim, true_steps = claim_of(shop.command("where", "--json")), shop.travelled_steps()
    beyond = claim.beyond_steps(true_steps) + (not claim.is_to_the_step)
    check_motors_off(shop.fake.writes())
    return Outcome(beyond, None, f"claimed {claim}, true {true_steps}")


def _wait_for_rest(shop: Shop) -> None:
    """Two seconds without a step: the mark is lifted after one."""
    at_steps, since_s = shop.travelled_steps(), time.monotonic()
    while time.monotonic() < since_s + 2:
        if shop.travelled_steps() != at_steps:
            at_steps, since_s = shop.travelled_steps(), time.monotonic()
        time.sleep(0.01)


def _wait_for_end(shop: Shop) -> None:
    pid = shop.fake.events()[-1].pid
    shop.fake.wait_for(lambda: not is_alive(pid))


_MEASURES: Final = "1: refused"
KINDS: Final = (
    Kind("journal damaged", _MEASURES, journal, missing=fake_port_missing),
    Kind("journal of a newer version", "-", newer, missing=fake_port_missing),
    Kind("configuration damaged, byte by byte", _MEASURES, configuration,
         missing=fake_port_missing),
    Kind("SIGKILL to the app at rest", "-", standstill, many=100, missing=fake_port_missing),
)  # fmt: skip
