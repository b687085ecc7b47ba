"""Which scenarios run in which boot, and how a boot is watched.

A boot takes some seconds, so scenarios share one, unless they need another kernel command line, or
a port whose inputs somebody drives.
"""

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from rigs.lpt.checks import Outcome
from rigs.lpt.kernel import Kernel
from rigs.lpt.machine import MARK, Access, Machine
from rigs.lpt.tools import END_MARK
from tests.rigs.lpt.fakeport import Event, FakePort

#: A move is under way when so much has happened at the port.
UNDER_WAY: Final = 3000


@dataclass(frozen=True)
class Boot:
    """One boot.

    Attributes:
        scenarios: names, in order.
        append: for the kernel's command line.
        driven: the port's inputs are driven by the host.
    """

    scenarios: tuple[str, ...]
    append: str = ""
    driven: bool = False


BOOTS: Final[Mapping[str, Boot]] = {
    "plain": Boot(
        (
            "job, smc on ppdev",
            "job, smc on devport",
            "job, x4step on ppdev",
            "job, x4step on devport",
            "SIGTERM on ppdev",
            "SIGTERM on devport",
            "kill -9 on ppdev",
            "driver's job, smc on ppdev",
            "kill -9 of the program, ppdev",
            "kill -9 of the step process, devport",
            "second program on ppdev",
            "second program on devport",
            "careless claimant",
            "printer driver",
            "no driver",
            "drivers loaded anew",
            "permissions",
            "looked over, ppdev",
            "looked over, devport",
        )
    ),
    "locked down": Boot(("lockdown", "locked job, smc on ppdev"), append="lockdown=integrity"),
    "driven": Boot(
        (
            "contact, smc on ppdev",
            "contact, x4step on ppdev",
            "contact, smc on devport",
            "contact, x4step on devport",
            "driver's contact, smc on ppdev",
        ),
        driven=True,
    ),
}


@contextmanager
def at_once(
    names: Iterable[str], kernel: Kernel, folder: Path
) -> Iterator[dict[str, "Future[dict[str, Outcome]]"]]:
    """Do these boots, as many at once as there are processors: each keeps one busy.

    Args:
        names: in ``BOOTS``.
        kernel: what to boot.
        folder: an empty one, for what they leave.
    """
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        booting = {}
        for name in names:
            results = folder / name.replace(" ", "-")
            results.mkdir()
            booting[name] = pool.submit(run, BOOTS[name], kernel, results)
        yield booting


def run(boot: Boot, kernel: Kernel, results: Path) -> dict[str, Outcome]:
    """Boot, do the scenarios, power off.

    Args:
        boot: which.
        kernel: what to boot.
        results: an empty folder, which the guest must see under the same path.
    """
    fake = FakePort(results) if boot.driven else None
    arguments = ("rigs.lpt.guest", str(results), *boot.scenarios)
    machine = Machine(kernel, results, arguments, boot.append, fake)
    logged = _drive(machine, fake, boot) if fake else {}
    machine.wait()
    accesses = logged or _from_marks(machine.trace(), boot)
    return {
        name: Outcome(json.loads((results / f"{name}.json").read_text()), accesses[name])
        for name in boot.scenarios
    }


def _from_marks(trace: list[Access], boot: Boot) -> dict[str, list[Access]]:
    """Cut the trace at its marks; a scenario that could not set any has the whole of it."""
    marks = [(i, a.value) for i, a in enumerate(trace) if a.is_write and a.register == MARK]
    found = dict.fromkeys(boot.scenarios, trace)
    for place, number in marks:
        if END_MARK < number <= len(boot.scenarios):
            end = next(i for i, value in marks if i > place and value == END_MARK)
            found[boot.scenarios[number - 1]] = trace[place + 1 : end]
    return found


def _drive(machine: Machine, fake: FakePort, boot: Boot) -> dict[str, list[Access]]:
    """Be the person at the machine: press the switch in the middle of each move."""
    found = {}
    for name in boot.scenarios:
        ready, go, done = (
            machine.results / file for file in (f"ready {name}", f"go {name}", f"{name}.json")
        )
        if not _wait(machine, fake, ready.exists):
            break
        begin = fake.count()
        go.touch()
        if _wait(machine, fake, lambda: fake.count() > begin + UNDER_WAY):  # noqa: B023
            fake.press()
        _wait(machine, fake, done.exists)
        fake.let_go()
        found[name] = list(_accesses(fake.events(begin)))
    return found


def _wait(machine: Machine, fake: FakePort, what: Callable[[], bool]) -> bool:
    """Until it can be seen (True), or the guest is off."""
    fake.wait_for(lambda: what() or not machine.is_running(), timeout_s=120)
    return what()


def _accesses(events: list[Event]) -> Iterator[Access]:
    """The fake port's log as if QEMU had traced it."""
    for event in events:
        if event.what in "RW":
            yield Access(event.at_ns * 1e-9, event.what == "W", event.register, event.value)
