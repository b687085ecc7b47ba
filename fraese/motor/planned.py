"""A waveform of steps that somebody else times: what a parallel port would see of the same blocks.

    controller --> PlannedDriver --> the driver of the bridge
                        |  blocks that were played, as its reports say
                        v
                   a thread: MotorCore on no port --> TracedPort --> Waveform

Rule 1: only what was played is drawn. A block counts when a report says that it is done; of one
        that was dropped half-way, as many ticks as the counts show.
Rule 2: times within a run are those of the plan: holds and a lowered rate are not in them. A run
        begins when the driver was told to begin it.
Rule 3: nobody waits for the thread but ``close``.
"""

import copy
import threading
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from queue import SimpleQueue
from typing import Final

from fraese.anythread import any_thread
from fraese.blocks import Block, Piece, leader_of, steps_done
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.null import NullPort
from fraese.motor.ports.traced import TracedPort
from fraese.motor.seams import Card, Clock, IdleLevel, Report, StepDriver, SwitchMode
from fraese.motor.switches import NO_SWITCH
from fraese.motor.waveform import Waveform

_A_RUN_S: Final = 1e6
_NS_PER_S: Final = 1_000_000_000
_ENOUGH: Final = 1 << 30


class _Inputs(NullPort):
    """Inputs as the last report has them; all else goes nowhere."""

    def __init__(self) -> None:
        self.status = 0

    def read_status(self) -> int:
        """As reported."""
        return self.status


class PlannedTrace:
    """The thread that draws.

    Args:
        waveform: its file.
        card: of the driver; a copy of it is used.
        clock: of the driver.
        settle_s: wait after energising.
        safe_outputs: free outputs that are off whenever the motors stand.
    """

    def __init__(
        self, waveform: Waveform, card: Card, clock: Clock, settle_s: float, safe_outputs: int
    ) -> None:
        self.waveform = waveform
        self._time = clock
        self._begin_ns = clock.now_ns()
        self._settle_ns = round(settle_s * _NS_PER_S)
        self._clock = VirtualClock()
        self._port = _Inputs()
        traced = TracedPort(self._port, self._clock.now_ns, waveform.note)
        # Inputs have had their effect already.
        self._core = MotorCore(
            traced, copy.deepcopy(card), self._clock, NO_SWITCH, settle_s, _ENOUGH, safe_outputs
        )
        self._last: Block | None = None
        self._until_ns = 0
        self._closed = False
        self._work: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._draw, name="waveform", daemon=True)
        self._thread.start()

    def on(self, driver: StepDriver) -> "PlannedDriver":
        """That driver, which stands, with what it plays drawn."""
        return PlannedDriver(driver, self)

    def now_ns(self) -> int:
        """Since the beginning."""
        return self._time.now_ns() - self._begin_ns

    def play(self, block: Block, run_ns: int) -> None:
        """A block was played, in a run that began then."""
        self._work.put(partial(self._play, block, run_ns))

    def rest(self) -> None:
        """The motors stand."""
        self._work.put(self._rest)

    def inputs(self, status: int) -> None:
        """The inputs are so."""
        self._work.put(partial(setattr, self._port, "status", status))

    def standing(self, action: Callable[[MotorCore], None], at_ns: int) -> None:
        """Something was done at standstill."""
        self._work.put(partial(self._standing, action, at_ns))

    def outputs(self, mask: int, value: int) -> None:
        """Free outputs were changed."""
        self._work.put(partial(self._core.set_outputs, mask, value))

    def close(self) -> None:
        """The driver is closed: the file is whole. Safe to call twice."""
        if self._closed:
            return
        self._closed = True
        self._work.put(self._rest)
        self._work.put(None)
        self._thread.join()
        self._clock.wait_until(self.now_ns())
        self._core.close()
        self.waveform.close(self._clock.now_ns())

    # --- in the thread ---------------------------------------------------------------------------

    def _draw(self) -> None:
        while (work := self._work.get()) is not None:
            work()

    def _play(self, block: Block, run_ns: int) -> None:
        """Take a block, and play what lies before it: the last one of a run brings it to rest."""
        core = self._core
        if self._last is None:
            self._clock.wait_until(run_ns)
            self._until_ns = self._clock.now_ns() + self._settle_ns
        core.accept(block, None)
        if self._last is not None:
            self._until_ns += self._last.duration_cycles() * 125 // 2
            core.poll(max(0, self._until_ns - self._clock.now_ns()) / _NS_PER_S)
        self._last = block

    def _rest(self) -> None:
        if self._last is not None:
            self._core.poll(_A_RUN_S)
            self._last = None

    def _standing(self, action: Callable[[MotorCore], None], at_ns: int) -> None:
        self._rest()
        self._clock.wait_until(at_ns)
        action(self._core)


class PlannedDriver:
    """A StepDriver that passes everything on, and has drawn what was played.

    Args:
        driver: to pass on to.
        trace: draws.

    Raises:
        PortError: if the driver cannot be asked.
    """

    def __init__(self, driver: StepDriver, trace: PlannedTrace) -> None:
        self._driver = driver
        self._trace = trace
        self._waiting: deque[Block] = deque()
        self._report = report = driver.poll(0)
        # What it played before this is not drawn.
        self._finished, self._pushed = report.finished, report.playing
        self._position = list(report.position_steps)
        self._inputs = report.inputs
        self._run_ns: int | None = None
        trace.inputs(report.inputs)

    def push(self, block: Block) -> bool:
        """Pass on; it is drawn when it was played."""
        is_taken = self._driver.push(block)
        if is_taken:
            self._waiting.append(block)
            self._pushed += 1
        return is_taken

    def poll(self, budget_s: float) -> Report:
        """Pass on, and have drawn what was played since."""
        before_ns = self._trace.now_ns()
        report = self._driver.poll(budget_s)
        if self._run_ns is None and (report.running or report.finished > self._finished):
            self._run_ns = before_ns
        self._hear(report, before_ns)
        return report

    def _hear(self, report: Report, before_ns: int) -> None:
        trace = self._trace
        if report.inputs != self._inputs:
            self._inputs = report.inputs
            trace.inputs(report.inputs)
        run_ns = before_ns if self._run_ns is None else self._run_ns
        self._report = report
        for block in self._done(report):
            self._draw(block, run_ns)
        if not report.running and not report.held:
            if report.playing >= self._pushed:
                self._drop(report, run_ns)
            trace.rest()
            self._run_ns = None

    def _draw(self, block: Block, run_ns: int) -> None:
        self._trace.play(block, run_ns)
        self._position = [a + b for a, b in zip(self._position, block.steps, strict=True)]

    def _done(self, report: Report) -> Iterator[Block]:
        """Blocks that were played to their end."""
        for _ in range(report.finished - self._finished):
            self._finished += 1
            if self._waiting:
                yield self._waiting.popleft()

    def _drop(self, report: Report, run_ns: int) -> None:
        """Nothing waits any more: of the first block that was dropped there are the steps made."""
        now = list(report.position_steps)
        if self._waiting:
            block = self._waiting[0]
            self._waiting.clear()
            made = [there - here for there, here in zip(now, self._position, strict=True)]
            played = begun(block, made)
            if played is not None:
                self._draw(played, run_ns)
        self._position = now

    @any_thread
    def brake(self) -> None:
        """Pass on."""
        self._driver.brake()

    @any_thread
    def stop(self) -> None:
        """Pass on."""
        self._driver.stop()

    @any_thread
    def set_override(self, factor: float) -> None:
        """Pass on."""
        self._driver.set_override(factor)

    def resume(self) -> None:
        """Pass on."""
        self._driver.resume()

    def flush(self) -> None:
        """Pass on; what waits is dropped."""
        self._driver.flush()
        self._drop(self._report, self._run_ns or self._trace.now_ns())
        self._trace.rest()
        self._run_ns = None

    def idle(self, level: IdleLevel) -> None:
        """Pass on, and have it drawn."""
        at_ns = self._trace.now_ns()
        self._driver.idle(level)
        self._trace.standing(lambda core: core.idle(level), at_ns)

    def set_outputs(self, mask: int, value: int) -> None:
        """Pass on, and have it drawn."""
        self._driver.set_outputs(mask, value)
        self._trace.outputs(mask, value)

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Pass on."""
        self._driver.set_switch_mode(mode)

    def close(self) -> None:
        """Pass on."""
        self._driver.close()


def begun(block: Block, made: list[int]) -> Block | None:
    """The first ticks of a block, as many as the leader's steps show; None: none.

    Args:
        block: as it was pushed.
        made: steps that the motors have made of it.
    """
    leader = leader_of(block.steps)
    done = min(abs(made[leader]), block.ticks()) if block.steps[leader] else 0
    if not done:
        return None
    ticks = block.ticks()
    pieces, left = [], done
    for piece in block.pieces:
        taken = min(left, piece.ticks)
        if taken:
            pieces.append(Piece(taken, piece.interval_q8, piece.add_q8))
        left -= taken
    steps = tuple(
        (1 if total > 0 else -1) * steps_done(abs(total), ticks, done) for total in block.steps
    )
    return block._replace(steps=steps, pieces=tuple(pieces), watch=None)
