"""The child in one process with its host, in a time of our own.

    Room: shared memory, player, chores, clock, core, simulated mill
          and the host's side: push, ask, brake, stop, command, fall silent, die

Time passes when the child looks at it, sleeps or dozes. What the host does is put down for a
moment, and happens when time passes that moment, wherever the child is just then: as between
processes.
"""

import heapq
import os
from collections.abc import Callable
from itertools import count

from fraese.blocks import Block
from fraese.motor.horizon import Horizon
from fraese.motor.realtime import mailbox
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.chores import Chores
from fraese.motor.realtime.clock import RealtimeClock
from fraese.motor.realtime.hostline import HostLine
from fraese.motor.realtime.memory import Memory
from fraese.motor.realtime.player import Player
from fraese.motor.realtime.records import encode
from fraese.motor.realtime.report import Told, read
from fraese.motor.realtime.ring import RingWriter
from fraese.motor.realtime.setup import ChargePump, RealtimeOptions
from fraese.motor.seams import Report
from tests.motor.workbench import TIRELESS, Workbench


class Time:
    """Time that passes with every look at it.

    Attributes:
        now: ns.
        naps_ns: how long was slept, and
        naps_ended_ns: until when.
    """

    def __init__(self, look_ns: int) -> None:
        self._look_ns = look_ns
        self._order = count()
        self._events: list[tuple[int, int, Callable[[], object]]] = []
        self.now = 0
        self.naps_ns: list[int] = []
        self.naps_ended_ns: list[int] = []

    def now_ns(self) -> int:
        self.advance(self._look_ns)
        return self.now

    def sleep_s(self, seconds: float) -> None:
        self.naps_ns.append(round(seconds * 1e9))
        self.advance(self.naps_ns[-1])
        self.naps_ended_ns.append(self.now)

    def at(self, seconds: float, action: Callable[[], object]) -> None:
        heapq.heappush(self._events, (round(seconds * 1e9), next(self._order), action))

    def advance(self, ns: int) -> None:
        until = self.now + ns
        while self._events and self._events[0][0] <= until:
            at, _, action = heapq.heappop(self._events)
            self.now = max(self.now, at)
            action()
        self.now = max(self.now, until)


class Line(HostLine):
    """The pipe from the host, in our time."""

    def __init__(self, time: Time) -> None:
        self._time = time
        self.broken = False

    def look(self) -> bool:
        return self.broken

    def doze(self, timeout_s: float) -> None:
        self._time.advance(round(timeout_s * 1e9))


class Room:
    """The child, and its host.

    Attributes:
        bench: simulated mill, card and core.
        time: everybody's.
        alive: the host gives signs of life.
        refusals: what commands were refused with.
    """

    def __init__(
        self,
        wiring: str = "smc",
        silent_s: float = 1.0,
        pump: ChargePump | None = None,
        sockets: tuple[int, ...] = (0, 1, 2),
    ) -> None:
        self.time = Time(look_ns=2_000)
        clock = RealtimeClock(self.time.now_ns, self.time.sleep_s)
        self.bench = Workbench(wiring, limits=TIRELESS, outputs=True, clock=clock, sockets=sockets)
        fd = shared.create()
        self.memory = Memory(fd)
        os.close(fd)
        self.words = self.memory.words
        self.line = Line(self.time)
        made = RealtimeOptions(silent_s=silent_s, pump=pump)
        self.chores = Chores(self.bench.core, clock, self.memory, self.line, made)
        clock.attendant = self.chores
        self.player = Player(self.bench.core, self.chores, self.words, self.line)
        self.chores.reporter.write(0)
        self._ring = RingWriter(self.words, self.memory.ring)
        self._numbers = count(1)
        self._horizon = Horizon()
        self._pushed = 0
        self.generation = 0
        self.alive = True
        self._beat()

    def _beat(self) -> None:
        if self.alive:
            self.words[shared.HEARTBEAT] = self.time.now
            self.time.at(self.time.now * 1e-9 + 0.05, self._beat)

    # --- the host ------------------------------------------------------------------------------

    def push(self, *blocks: Block) -> None:
        for block in blocks:
            self._pushed += 1
            point = self._horizon.add(self._pushed, block)
            relative = point and point.moved(-self._pushed)
            assert self._ring.put(encode(block, self.generation, relative))

    def ask(self) -> int:
        number = self.words[shared.ASKED] = next(self._numbers)
        return number

    def play(self, *blocks: Block) -> None:
        self.push(*blocks)
        self.ask()

    def wish(self, word: int) -> None:
        self.words[word] = next(self._numbers)
        self.words[shared.WISHES] = next(self._numbers)

    def brake(self) -> None:
        self.wish(shared.BRAKES)

    def override(self, factor: float) -> None:
        self.words[shared.OVERRIDE] = round(factor * 256)
        self.words[shared.WISHES] = next(self._numbers)

    def stop(self) -> None:
        self.wish(shared.STOPS)

    def post(self, kind: int, a: int = 0, b: int = 0) -> int:
        number = next(self._numbers)
        mailbox.post(self.words, number, kind, a, b)
        return number

    def answer(self, number: int) -> str | None:
        """None: not answered; empty: done; else why not."""
        if self.words[shared.ANSWER] != number:
            return None
        return self.memory.text() if self.words[shared.RESULT] == mailbox.REFUSED else ""

    def fall_silent(self) -> None:
        self.alive = False

    def die(self) -> None:
        self.alive = False
        self.line.broken = True

    def told(self) -> Told:
        told = read(self.memory)
        assert told is not None
        return told

    @property
    def report(self) -> Report:
        return self.told().report

    # --- time ----------------------------------------------------------------------------------

    def at(self, seconds: float, action: Callable[[], object]) -> None:
        self.time.at(seconds, action)

    def until(self, seconds: float) -> Report:
        """Let the child live until then, and on to the end of the run in hand."""
        while self.time.now < seconds * 1e9 and not (
            self.chores.leaving and self.bench.core.run.standing
        ):
            self.player.turn()
        return self.report
