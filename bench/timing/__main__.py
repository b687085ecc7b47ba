"""How late the steps are: the step process on a port that leads nowhere, and beside others.

``python -m bench.timing`` prints tables; ``--all`` measures everything at full length, some eight
minutes, and writes the page docs/timing.md anew with its pictures. Let the machine do nothing else
meanwhile.
"""

import argparse
import os
import platform
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from bench.timing import contact, neighbour, page, paired, steps
from bench.timing.figures import Section
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.system import PRIORITY

#: What there is, and for how many seconds on the page.
SECTIONS: dict[str, tuple[Callable[[float], Section], float]] = {
    "smc": (steps.phase_card, 20.0),
    "x4step": (steps.x4step, 60.0),
    "paper": (steps.paper, 8.0),
    "app": (paired.paired, 60.0),
    "neighbour": (neighbour.neighbour, 20.0),
    "contact": (contact.contact, 40.0),
}
_DEFAULT_S = 8.0


def _load() -> str:
    return f"{os.getloadavg()[0]:.2f}"


def conditions() -> str:
    """The machine, in a sentence."""
    found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.M)
    facts = kernel_facts(PRIORITY)
    virtual = ", a virtual machine" if facts.is_virtual else ""
    return (
        f"Machine: {found[1] if found else platform.machine()}, {len(facts.cores)} cores{virtual};"
        f" Linux {platform.release()}, Python {platform.python_version()}."
    )


def measured(key: str, seconds: float) -> Section:
    """One section, with the load under which it was measured."""
    before = _load()
    section = SECTIONS[key][0](seconds)
    return replace(section, load=f"{before}, {_load()}")


def main() -> None:
    """Measure, print, and write the page if asked to."""
    parser = argparse.ArgumentParser(prog="bench.timing", description=__doc__)
    parser.add_argument("--only", choices=SECTIONS, action="append", help="one of them")
    parser.add_argument("--seconds", type=float, help=f"for each; {_DEFAULT_S:g} without --all")
    parser.add_argument("--all", action="store_true", help="at full length, and write the page")
    given = parser.parse_args()
    if given.all and given.only:
        sys.exit("--all and --only exclude each other: the page has all sections, or stays.")
    done: list[Section] = []
    for key in given.only or SECTIONS:
        seconds = given.seconds or (SECTIONS[key][1] if given.all else _DEFAULT_S)
        section = measured(key, seconds)
        print(page.markdown([section], "" if done else conditions()), flush=True)
        done.append(section)
    if given.all:
        print(*page.write(done, conditions()), sep="\n")


if __name__ == "__main__":
    main()
