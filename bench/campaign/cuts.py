"""Power cuts: what was synced is left, the motors stand where they are, and the next start claims.

    command --fsync--> ext4 in a file --copied at the cut, mounted anew--> where --json
    all its processes killed at the same moment; carriages: the fake port's

Rule 1: before, there is a record at rest that was true: if the mark "in motion" is not on the disk
        before the first step, that one is believed, and wrong.
Rule 2: the file system's own journal is played as after a real cut. What a disk that lies about
        its cache loses is not tried.
"""

import contextlib
import os
import signal
import time
from random import Random
from typing import Final

from bench.campaign.claims import claimed
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.mounts import Disk, missing
from bench.campaign.signals import begin, fake_port_missing
from fraese.assembly import assemble
from fraese.control.recorder import JournalRecorder
from tests.helpers import configured
from tests.rigs.lpt.shop import Shop, children_of, is_alive

_MANY: Final = 200
_LATEST_S: Final = 10.0
_SOON_S: Final = 2.0
MARK_S: Final = 5.0


def cut(attempt: Attempt) -> Outcome:
    """At 0 to 10 s after the start of a command that mills."""
    shop, chance = begin(attempt), attempt.random
    disk = Disk(attempt.folder / "disk.img")
    state = attempt.folder / "user-state"
    with disk.on(state):
        assert shop.command("move", "X0.5", "--relative").code == 0
        before = shop.travelled_steps()
        process = shop.start("run", "long.ngc")
        time.sleep(_moment_s(chance))
        with contextlib.suppress(ProcessLookupError):
            for pid in (process.pid, *children_of(process.pid)):
                os.kill(pid, signal.SIGKILL)
        left = disk.as_cut(attempt.folder / "left.img")
        process.communicate(timeout=20)
        shop.fake.wait_for(lambda: not _at_port(shop))
    moved = shop.travelled_steps() != before
    with left.on(state):
        claim, true_steps = claimed(shop), shop.travelled_steps()
    trusted_wrong = claim.is_to_the_step and claim.low_steps != true_steps
    beyond = claim.beyond_steps(true_steps) + trusted_wrong
    figure = float(claim.width_steps) if moved else None
    return Outcome(beyond, figure, f"claimed {claim}, true {true_steps}")


def _moment_s(chance: Random) -> float:
    """Half of them soon, where the mark is made."""
    return chance.uniform(0, chance.choice((_SOON_S, _LATEST_S)))


def _at_port(shop: Shop) -> bool:
    return any(is_alive(pid) for pid in {event.pid for event in shop.fake.events()[-1:]})


def mark(attempt: Attempt) -> Outcome:
    """How long a start waits for its mark, on the disk that temporary files are on."""
    made = assemble(configured(), state=attempt.folder / "state", clock="paced")
    try:
        recorder = made.recorder
        assert isinstance(recorder, JournalRecorder)
        # The first one makes the file.
        recorder.before_motion()
        made.controller.set_zero("x", attempt.random.uniform(0, 9))
        recorder._say_resting()
        recorder.wait(MARK_S)
        since_s = time.monotonic()
        recorder.before_motion()
        took_ms = (time.monotonic() - since_s) * 1e3
    finally:
        made.close()
    return Outcome(0, took_ms)


def _missing() -> str:
    return fake_port_missing() or missing()


KINDS: Final = (
    Kind("power cut, 0 to 10 s after a start", "steps between the bounds", cut, _MANY, 2,
         missing=_missing),
    Kind("mark before motion", "ms that a start waits", mark, _MANY),
)  # fmt: skip
