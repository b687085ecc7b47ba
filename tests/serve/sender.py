"""A sender in the same process, on a machine whose time is its own: what it says, what it hears."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fraese.assembly import Plant
from fraese.serve.session import Session
from fraese.serve.settings import Changes
from fraese.serve.store import Store
from tests.helpers import homed
from tests.helpers import plant as fresh


class Bench:
    """A machine with a sender at it.

    Attributes:
        heard: lines that the sender was told, in their order.
        written: keys of the configuration that were to be changed.
    """

    def __init__(self, plant: Plant, store: Path | None = None) -> None:
        self.plant = plant
        self.controller = plant.controller
        self.heard: list[str] = []
        self.written: dict[str, Any] = {}
        self._now_s = 0.0
        self._during: list[tuple[Callable[[], bool], Callable[[], object]]] = []
        self.session = Session(plant.controller, Store(store), self._write, self._tick, waits=False)
        plant.controller.set_tell(self.session.tell)
        plant.controller.set_break_key(self._between)
        plant.controller.set_show_pos(self.session.between)
        self.session.connected("here", self._hear)
        self.work()

    def _tick(self) -> float:
        self._now_s += 1.0
        return self._now_s

    def _write(self, changes: Changes) -> str:
        self.written |= changes
        return ""

    def _hear(self, text: str) -> None:
        self.heard += [line for line in text.split("\r\n") if line]

    def _between(self) -> None:
        """Between two rounds of a job: what was to be done when something is so."""
        for wait in [wait for wait in self._during if wait[0]()]:
            self._during.remove(wait)
            wait[1]()

    def when(self, is_so: Callable[[], bool], do: Callable[[], object]) -> None:
        """Do this once while a job runs, as soon as something is so."""
        self._during.append((is_so, do))

    def work(self) -> None:
        """Let the machine do what waits."""
        for _ in range(10_000):
            if not self.session.has_work:
                return
            self.session.turn()
        raise AssertionError("it never comes to an end")

    def bytes(self, data: bytes) -> bool:
        """Say this, and no more."""
        self.session.feed(data)
        return True

    def say(self, *lines: str) -> list[str]:
        """Say lines, let the machine work; what was heard since."""
        before = len(self.heard)
        self.bytes("".join(line + "\n" for line in lines).encode())
        self.work()
        return self.heard[before:]

    def ask(self) -> str:
        """A status report."""
        self.bytes(b"?")
        return self.heard[-1]

    @property
    def word(self) -> str:
        """Which state it reports."""
        return self.ask()[1:].split("|")[0]

    @property
    def at_mm(self) -> tuple[float, ...]:
        """Where the machine is, by its own account."""
        return self.controller.state().position_mm


def bench(**sections: Any) -> Bench:
    """Of a machine that has been referenced."""
    return Bench(homed(**sections))


def unreferenced(**sections: Any) -> Bench:
    """Of one that has not."""
    return Bench(fresh(**sections))
