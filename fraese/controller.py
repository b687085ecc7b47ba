"""The controller (FRAESE): UI-free. Commands in, callbacks out.

Rule 1: everything runs in one thread, the one that calls ``run``. Only ``cancel``, ``stop``,
        ``hold``, ``resume`` and ``answer`` may be called from another: they set flags.
Rule 2: callbacks are called from that thread. They may read ``state()`` and set those flags, no
        more.
Rule 3: the driver counts motor steps; the machine's position is derived from them here, and only
        here.
Rule 4: a refused command leaves everything as it was.

The run loop is the original's:

    full display
    while status is RUN:   poll the driver, feed its queue  ->  status
                           break-key callback
                           show-position callback
    full display, motors idle
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Final

from fraese.blocks import Block, Watch, WatchAction
from fraese.calibration import Homing
from fraese.config import Config
from fraese.context import ProgramContext
from fraese.errors import FraeseError, LimitError, StateError, SwitchAlarm
from fraese.jobs import Job
from fraese.journal import Kept
from fraese.log import LogFile, logged
from fraese.log import write as log_line
from fraese.machine import Axis, Machine, Millimetres, Steps
from fraese.motor.seams import Clock, End, IdleLevel, Report, StepDriver, SwitchMode
from fraese.offsets import WorkOffsets
from fraese.planner.backlash import Carriages, take_up
from fraese.planner.lines import plan_line
from fraese.runner import Detour, Runner
from fraese.state import JobProgress, MachineState, Status

#: DB25 pins of the inputs: status register bit, and whether pin and bit are inverted.
INPUT_PINS: Final = {
    11: (0x80, True),
    10: (0x40, False),
    12: (0x20, False),
    13: (0x10, False),
    15: (0x08, False),
}
_NS_PER_S: Final = 1_000_000_000


def _nothing() -> None:
    """No callback registered."""


def _made(block: Block | None) -> Iterator[Block]:
    """A block, if there is one to make."""
    if block is not None:
        yield block


def _unheard(message: str) -> None:
    """Nobody to tell."""


class Controller:
    """Machine state, work offsets, limits and the run loop.

    Args:
        machine: axes and conversions.
        driver: what plays the blocks; closed with the controller.
        clock: the driver's clock.
        config: limits, feeds, standstill.
        log: the log file that can be switched, if there is one.
        slice_s: how long one poll of the driver may take, s.
    """

    def __init__(
        self,
        machine: Machine,
        driver: StepDriver,
        clock: Clock,
        config: Config,
        log: LogFile | None = None,
        slice_s: float = 0.02,
    ) -> None:
        self.machine = machine
        self.config = config
        self.log = log
        self._driver = driver
        self._clock = clock
        self._display: Callable[[], None] = _nothing
        self._show_pos: Callable[[], None] = _nothing
        self._break_key: Callable[[], None] = _nothing
        self._tell: Callable[[str], None] = _unheard
        axes = len(machine.axes)
        self._carriages = Carriages(machine, (0,) * axes)
        self.offsets = WorkOffsets(axes)
        self._referenced = [False] * axes
        self._status = Status.OK
        self._message = ""
        self._progress: JobProgress | None = None
        self._job_from_ns = 0
        self._idle_at_ns: int | None = None
        self.error: FraeseError | None = None
        self.override = 1.0
        self._switch_mode = SwitchMode(config.switches.mode)
        driver.set_switch_mode(self._switch_mode)
        braking_s = max(axis.max_rate_hz / axis.acceleration_hz_s for axis in machine.axes)
        lead_s = max(config.run.lead_s, braking_s + 2 * slice_s)
        self._slice_ns = round(slice_s * _NS_PER_S)
        self._runner = Runner(driver, self._carriages, lead_s, slice_s)
        self._runner.look_around(config.switches.readings)

    # --- callbacks -----------------------------------------------------------------------------

    def set_display(self, procedure: Callable[[], None]) -> None:
        """Register the full display; called in the run loop's thread."""
        self._display = procedure

    def set_show_pos(self, procedure: Callable[[], None]) -> None:
        """Register the position display; called in the run loop's thread after every slice."""
        self._show_pos = procedure

    def set_break_key(self, procedure: Callable[[], None]) -> None:
        """Register the query for a break key; called in the run loop's thread after every slice.

        It calls ``cancel`` or ``stop`` when the operator wants that.
        """
        self._break_key = procedure

    def set_tell(self, procedure: Callable[[str], None]) -> None:
        """Register who is told every message; called in the run loop's thread."""
        self._tell = procedure

    # --- from any thread -----------------------------------------------------------------------

    def cancel(self) -> None:
        """Brake with ramp, then drop the rest."""
        self._runner.cancel()

    def stop(self) -> None:
        """Stop without ramp; above the start/stop rate the position is uncertain afterwards."""
        self._runner.stop()

    def hold(self) -> None:
        """Feed hold: brake with ramp and wait."""
        self._runner.hold()

    def resume(self) -> None:
        """Go on after a hold."""
        self._runner.resume()

    def answer(self) -> None:
        """The operator has done what was asked."""
        self._runner.answer()

    @property
    def cancelling(self) -> bool:
        """The running job has been told to end; it may still be braking."""
        return self._status is Status.RUN and self._runner.cancelling

    @property
    def holding(self) -> bool:
        """The running job has been told to wait; it may still be braking."""
        return self._status is Status.RUN and self._runner.holding

    # --- the run loop --------------------------------------------------------------------------

    @property
    def status(self) -> Status:
        """OK, RUN, CANCEL or ERROR."""
        return self._status

    @property
    def question(self) -> str:
        """What the operator is asked now; empty if nothing."""
        return self._runner.question

    def run(self) -> Status:
        """Work off what was commanded; returns the status in which it ended."""
        if self._status is not Status.RUN:
            return self._status
        log_line("controller", "run", "entry", self._progress.name if self._progress else "")
        self._display()
        try:
            while self._status is Status.RUN:
                self._status = self._activate()
                self._break_key()
                self._show_pos()
        except BaseException as error:
            self._give_up(error)
            raise
        self._conclude()
        self._display()
        self._halt_motors()
        log_line("controller", "run", "exit", f"{self._status.value} {self.where()}")
        return self._status

    def idle(self, elapsed_s: float = 0.0) -> None:
        """Between jobs: look at the inputs, and switch the current off when its time has come.

        Args:
            elapsed_s: how long the caller has waited since the last call; a clock that only moves
                when somebody waits is moved on by it.
        """
        self._clock.wait_until(self._clock.now_ns() + round(elapsed_s * _NS_PER_S))
        self._runner.look()
        if self._idle_at_ns is not None and self._clock.now_ns() >= self._idle_at_ns:
            self._idle_at_ns = None
            self._driver.idle(IdleLevel(self.config.standstill.current))
            self._runner.look()

    def close(self) -> None:
        """Motors off, port given back, log off (FraesEnd)."""
        self._driver.close()
        self.switch_log(False)

    def start(
        self,
        name: str,
        job: Job,
        lines: int = 0,
        expected_s: float = 0.0,
        detour: Detour | None = None,
    ) -> None:
        """Take up a job; ``run`` works it off.

        Args:
            name: for people.
            job: what to do.
            lines: how many lines it has, for the progress.
            expected_s: planned duration, likewise.
            detour: where to go while it is held; None: stay.

        Raises:
            StateError: if another one runs, or an error has not been acknowledged.
        """
        self._require_ready()
        self._message = ""
        self.error = None
        self._idle_at_ns = None
        self._progress = JobProgress(name, lines=lines, expected_s=expected_s)
        self._job_from_ns = self._clock.now_ns()
        self._runner.start(job, detour)
        self._status = Status.RUN

    def acknowledge(self) -> None:
        """Take note of an error or cancel; back to OK."""
        if self._status in (Status.ERROR, Status.CANCEL):
            self._status = Status.OK

    def _activate(self) -> Status:
        status = self._runner.activate()
        for motor in self._runner.report.torn:
            self._referenced[motor] = False
        if status is Status.RUN and self._runner.waits:
            # Nothing passes the time for us: the driver has nothing to play.
            self._clock.wait_until(self._clock.now_ns() + self._slice_ns)
        return status

    def _give_up(self, error: BaseException) -> None:
        """Something was raised that no job raises: the job is over, the motors stop."""
        self._runner.abandon()
        self._status = Status.ERROR
        self._message = f"Stopped by an error: {error!r}."

    def _conclude(self) -> None:
        """Say how the job ended."""
        if self._status is Status.CANCEL:
            self._message = f"Cancelled at {self.where()}."
            if self._runner.report.torn:
                self._message += " Stopped without ramp: reference the axes before relying on it."
        elif self._status is Status.ERROR:
            self.error = self._runner.failure or SwitchAlarm(
                f"End switch {self._ends_named()} closed: stopped at {self.where()}."
            )
            self._message = str(self.error)
        # Cutting ends with the job; what was cancelled or failed also leaves no spindle running.
        ended = ("laser",) if self._status is Status.OK else ("laser", "spindle", "coolant")
        mask = self.config.outputs.mask(*ended)
        if mask:
            self._driver.set_outputs(mask, 0)
        elapsed_s = (self._clock.now_ns() - self._job_from_ns) / _NS_PER_S
        self._progress = self._job_progress(elapsed_s)

    def _halt_motors(self) -> None:
        """HaltMotoren: current off or down, now or later."""
        delay_s = self.config.standstill.delay_s
        self._idle_at_ns = self._clock.now_ns() + round(delay_s * _NS_PER_S)
        if not delay_s:
            self.idle()

    # --- commands ------------------------------------------------------------------------------

    @logged
    def jog(self, axis: str, distance_mm: float, *, clamp: bool = False) -> None:
        """One bounded move of one axis; ``run`` makes it.

        Args:
            axis: name.
            distance_mm: signed; not 0, at most ``jog.max_mm``.
            clamp: stop at the soft limit instead of refusing.

        Raises:
            LimitError: if it would leave the travel, or is too long or nothing.
            StateError: if the machine is not ready, or stands on the switch it would move into.
        """
        index = self.machine.index(axis)
        if not 0 < abs(distance_mm) <= self.config.jog.max_mm:
            raise self._too_long(distance_mm)
        here_mm = self.machine.axes[index].to_mm(self.position_steps()[index])
        target = self.machine.axes[index].to_steps(here_mm + distance_mm)
        self.jog_steps(axis, target - self.position_steps()[index], clamp=clamp)

    @logged
    def jog_steps(self, axis: str, distance_steps: int, *, clamp: bool = False) -> None:
        """The same in steps.

        Raises:
            LimitError: if it would leave the travel, or is too long or nothing.
            StateError: if the machine is not ready, or stands on the switch it would move into.
        """
        self._require_ready()
        if not distance_steps:
            raise LimitError(f"A jog must be at least one step of {self._axis(axis).step_mm:g} mm.")
        index = self.machine.index(axis)
        if abs(distance_steps) > self._axis(axis).to_steps(self.config.jog.max_mm):
            raise self._too_long(self._axis(axis).to_mm(distance_steps))
        here = self.position_steps()
        target = list(here)
        target[index] += distance_steps
        if clamp and self._referenced[index]:
            low, high = self._limits_steps(index)
            target[index] = min(max(target[index], low), high)
            if target[index] == here[index]:
                raise LimitError(f"{axis.upper()} stands at its soft limit.")
        self._check_target(tuple(target))
        watch = self._watch_for_jog(index, distance_steps)
        delta = tuple(to - at for to, at in zip(target, here, strict=True))
        self.start(f"jog {axis.upper()}", self.line(delta, self.config.jog.feed_mm_min, watch))

    @logged
    def move_to(
        self,
        targets_mm: Mapping[str, float],
        *,
        relative: bool = False,
        machine_coordinates: bool = False,
        feed_mm_min: float | None = None,
    ) -> None:
        """A straight line of one or several axes; ``run`` makes it.

        Args:
            targets_mm: by axis name, in work coordinates.
            relative: as distances from here instead.
            machine_coordinates: from machine zero instead.
            feed_mm_min: along the line; None: as fast as the axes can.

        Raises:
            LimitError: if the target is outside the travel.
            StateError: if the machine is not ready.
        """
        here = self.position_steps()
        target = list(here)
        for name, value_mm in targets_mm.items():
            index = self.machine.index(name)
            axis = self.machine.axes[index]
            self._require_finite(axis, value_mm)
            if relative:
                value_mm += axis.to_mm(here[index])
            elif not machine_coordinates:
                value_mm += self.offset_mm[index]
            target[index] = axis.to_steps(value_mm)
        self._require_feed(feed_mm_min)
        self.check_moves([tuple(target)])
        delta = tuple(to - at for to, at in zip(target, here, strict=True))
        self.start("move", self.line(delta, feed_mm_min))

    @logged
    def run_curve(
        self, points_mm: Sequence[Sequence[float]], feed_mm_min: float | None = None
    ) -> None:
        """Work through a list of points in work coordinates, straight lines in between.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        targets = [
            self._targets(tuple(mm + by for mm, by in zip(point, self.offset_mm, strict=True)))
            for point in points_mm
        ]
        self._require_feed(feed_mm_min)
        self.check_moves(targets)
        self.start("curve", self._curve(targets, feed_mm_min), lines=len(targets))

    @logged
    def home(self, axes: Sequence[str] = (), *, measure: bool | None = None) -> None:
        """Reference axes, all configured ones by default; ``run`` does it.

        Raises:
            StateError: if the machine is not ready.
        """
        homing = self.config.homing
        order: list[str] = [name for name in homing.order if not axes or name in axes]
        order += [name for name in axes if name not in order]
        job = Homing(self, homing, homing.measure if measure is None else measure).job(order)
        self.start("reference " + " ".join(name.upper() for name in order), job)

    @logged
    def set_zero(self, axes: Iterable[str], value_mm: float = 0.0) -> None:
        """Let the present position have this work coordinate.

        Raises:
            StateError: while the machine runs.
        """
        self._require_not_running()
        for name in axes:
            index = self.machine.index(name)
            at_mm = self.machine.axes[index].to_mm(self.position_steps()[index])
            self.offsets.set_zero(index, at_mm, value_mm)

    @logged
    def ignore_switches(self, ignore: bool) -> None:
        """Let contacts stop the motors, or not (for trying things out).

        Raises:
            StateError: while the machine runs.
        """
        self._require_not_running()
        self._switch_mode = SwitchMode.IGNORE if ignore else SwitchMode.STOP
        self._driver.set_switch_mode(self._switch_mode)

    def switch_log(self, on: bool) -> None:
        """Log on or off; from any thread.

        Raises:
            ConfigError: if the file cannot be written.
        """
        if self.log is not None:
            self.log.switch(on)

    def set_override(self, factor: float) -> None:
        """Feed override, 0.1 to 2; acts on what is not in the driver's queue yet. Any thread.

        Raises:
            LimitError: if it is outside.
        """
        if not 0.1 <= factor <= 2:
            raise LimitError(f"A feed override is 10 to 200 %, not {factor * 100:g} %.")
        self.override = factor

    def say(self, message: str) -> None:
        """Show a message."""
        self._message = message
        self._tell(message)

    def drive_points(self, name: str, points_mm: Sequence[Sequence[float]]) -> None:
        """Straight rapids through points in machine coordinates; ``run`` makes them.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        targets = [self._targets(tuple(point)) for point in points_mm]
        self.check_moves(targets)
        self.start(name, self._curve(targets, None), lines=len(targets))

    # --- position ------------------------------------------------------------------------------

    def position_steps(self) -> Steps:
        """Machine position of every axis."""
        return self._runner.position_steps()

    @property
    def slack_steps(self) -> Steps:
        """How much of each axis' backlash lies between motor and carriage; at standstill."""
        return self._carriages.slack_steps

    def latched_steps(self, report: Report) -> Steps:
        """Machine position at the contact that fulfilled a watch.

        The motors have not turned round since, so what they did since then their axes did too.
        """
        since = zip(
            report.position_steps, report.latched_steps or report.position_steps, strict=True
        )
        return tuple(
            here - axis.motor_sign * (now - then)
            for here, axis, (now, then) in zip(
                self.position_steps(), self.machine.axes, since, strict=True
            )
        )

    def set_reference(self, axis: str, position_steps: int) -> None:
        """Let the present position of an axis be this one, and count it as referenced."""
        index = self.machine.index(axis)
        position = list(self.position_steps())
        position[index] = position_steps
        self._carriages.position_steps = tuple(position)
        self._referenced[index] = True

    def lose_reference(self, axis: str) -> None:
        """An axis is not to be relied on."""
        self._referenced[self.machine.index(axis)] = False

    def travelled_steps(self) -> Steps:
        """Steps made since the start, both directions added, per axis."""
        return self._runner.report.travelled_steps

    def blocks_pushed(self) -> int:
        """Blocks of the present job given to the driver so far."""
        return self._runner.blocks

    def blocks_finished(self) -> int:
        """Blocks of the present job that were played to their end, the one in hand left out."""
        return self._runner.finished

    def is_referenced(self, axis: str) -> bool:
        """Whether an axis was referenced and nothing has shaken that since."""
        return self._referenced[self.machine.index(axis)]

    @property
    def offset_mm(self) -> tuple[float, ...]:
        """Where the work zero lies, in machine coordinates."""
        return self.offsets.offset_mm()

    def where(self) -> str:
        """The machine position in words."""
        position_mm = self.machine.to_mm(self.position_steps())
        return " ".join(
            f"{axis.name.upper()} {mm:.3f}"
            for axis, mm in zip(self.machine.axes, position_mm, strict=True)
        ) + " mm (machine)"  # fmt: skip

    def program_context(self) -> ProgramContext:
        """The machine as a program finds it now."""
        return ProgramContext(
            config=self.config,
            machine=self.machine,
            start_steps=self.position_steps(),
            slack_steps=self.slack_steps,
            referenced=tuple(self._referenced),
            parameters=dict(self.offsets.parameters),
        )

    def keep(self) -> Kept:
        """What must survive a restart."""
        return Kept(
            position_steps=self.position_steps(),
            slack_steps=self.slack_steps,
            parameters=self.offsets.parameters,
            referenced=tuple(self._referenced),
            phases=self._runner.report.phases,
        )

    def take_up(self, kept: Kept) -> None:
        """Go on where another run ended; the phases are the driver maker's business."""
        self._carriages.position_steps = kept.position_steps
        self._carriages.slack_steps = kept.slack_steps
        self.offsets.replace(kept.parameters)
        self._referenced = list(kept.referenced)
        self._runner.look()

    # --- limits --------------------------------------------------------------------------------

    def check_moves(self, targets: Sequence[Steps]) -> None:
        """See that every target can be reached, before anything moves.

        Raises:
            LimitError: naming axis, target and travel.
            StateError: if the machine is not ready, or stands on a switch.
        """
        self._require_ready()
        self._require_open_switch()
        for target in targets:
            self._check_target(target)

    def _check_target(self, target: Steps) -> None:
        here = self.position_steps()
        for index, axis in enumerate(self.machine.axes):
            if target[index] == here[index]:
                continue
            low, high = self._limits_steps(index)
            if self._referenced[index]:
                if not low <= target[index] <= high:
                    raise LimitError(self._outside(axis, target[index]))
            elif abs(target[index] - here[index]) > axis.travel_mm * axis.steps_per_mm:
                raise LimitError(
                    f"{axis.name.upper()} would move"
                    f" {abs(axis.to_mm(target[index] - here[index])):.3f} mm, further than its"
                    f" whole travel of {axis.travel_mm:g} mm."
                )

    def _outside(self, axis: Axis, target_steps: int) -> str:
        offset_mm = self.offset_mm[self.machine.index(axis.name)]
        work = (
            f" (work {axis.low_mm - offset_mm:.3f} to {axis.high_mm - offset_mm:.3f})"
            if offset_mm
            else ""
        )
        return (
            f"{axis.name.upper()} {axis.to_mm(target_steps):.3f} mm is outside the travel,"
            f" {axis.low_mm:g} to {axis.high_mm:g} mm in machine coordinates{work}."
        )

    def _limits_steps(self, index: int) -> tuple[int, int]:
        """Soft limits; an axis that stands beyond one may come back, but not go further."""
        axis, here = self.machine.axes[index], self.position_steps()[index]
        return min(axis.to_steps(axis.low_mm), here), max(axis.to_steps(axis.high_mm), here)

    # --- end switches --------------------------------------------------------------------------

    def switch_watch(self, *, closed: bool, action: WatchAction) -> Watch:
        """A watch on the end-switch input."""
        switches = self.config.switches
        mask = INPUT_PINS[switches.pin][0]
        bit_set = bool(switches.closed_reads) == closed
        return Watch(mask, mask if bit_set else 0, action)

    def probe_watch(self, *, closed: bool, action: WatchAction) -> Watch:
        """A watch on the probe input; without a pin of its own that is the end switches'."""
        probe = self.config.probe
        if probe.pin is None:
            return self.switch_watch(closed=closed, action=action)
        mask = INPUT_PINS[probe.pin][0]
        return Watch(mask, mask if bool(probe.closed_reads) == closed else 0, action)

    def probe_closed(self) -> bool:
        """Whether the probe touches, as last read."""
        watch = self.probe_watch(closed=True, action=WatchAction.IGNORE)
        return self._runner.report.inputs & watch.mask == watch.value

    def ends(self) -> frozenset[End]:
        """Ends that the present contact may be, in axis directions.

        What a referenced position excludes is left out. If that leaves nothing, nobody moved into
        an end, and it is any of those that the position allows.
        """
        axes = self.machine.axes
        candidates = frozenset(
            End(end.motor, end.sign * axes[end.motor].motor_sign)
            for end in self._runner.report.candidates
        )
        if not candidates:
            return candidates
        near = frozenset(
            end
            for motor in range(len(axes))
            for end in (End(motor, -1), End(motor, 1))
            if self._is_near(end)
        )
        return candidates & near or near or candidates

    def _is_near(self, end: End) -> bool:
        if not self._referenced[end.motor]:
            return True
        axis = self.machine.axes[end.motor]
        limit_mm = axis.high_mm if end.sign > 0 else axis.low_mm
        reach_mm = 2 * self.config.homing.pull_off_mm
        # As last reported: this is asked from other threads too.
        at_mm = axis.to_mm(self._runner.seen_steps[end.motor])
        return (limit_mm - at_mm) * end.sign < reach_mm

    def end_name(self, end: End) -> str:
        """As in the original: xmin, xmax, ..."""
        return self.machine.axes[end.motor].name + ("max" if end.sign > 0 else "min")

    def motor_end(self, name: str) -> End:
        """The end of that name as the driver counts it, in motor direction.

        Raises:
            ValueError: if there is no such end.
        """
        index = self.machine.index(name.removesuffix("min").removesuffix("max"))
        sign = 1 if name.endswith("max") else -1
        return End(index, sign * self.machine.axes[index].motor_sign)

    def _ends_named(self) -> str:
        return " or ".join(self.end_name(end) for end in sorted(self.ends())) or "unknown"

    def _watch_for_jog(self, index: int, distance_steps: int) -> Watch | None:
        """On a closed switch only a move away from it is let through."""
        if not self._runner.report.switch_closed or self._switch_mode is SwitchMode.IGNORE:
            return None
        towards = End(index, 1 if distance_steps > 0 else -1)
        away_from = End(index, -towards.sign)
        ends = self.ends()
        if towards in ends or away_from not in ends:
            self._require_open_switch()
        return self.switch_watch(closed=False, action=WatchAction.IGNORE)

    def _require_open_switch(self) -> None:
        if self._runner.report.switch_closed and self._switch_mode is SwitchMode.STOP:
            raise StateError(
                f"End switch {self._ends_named()} is closed: jog away from it, reference the"
                " machine, or let switches be ignored; nothing has moved."
            )

    # --- helpers -------------------------------------------------------------------------------

    def _axis(self, name: str) -> Axis:
        return self.machine.axes[self.machine.index(name)]

    def line_blocks(
        self, delta: Steps, feed_mm_min: float | None, watch: Watch | None = None
    ) -> Iterator[Block]:
        """A straight line from rest to rest, by signed axis steps; backlash is taken up first.

        A watched line moves one axis only.
        """
        slack = tuple(
            take_up(slack, axis.backlash_steps, n)
            for slack, axis, n in zip(self.slack_steps, self.machine.axes, delta, strict=True)
        )
        if watch is not None:
            # One block: its watch must see the contact wherever it comes.
            whole = tuple(n + extra for n, extra in zip(delta, slack, strict=True))
            yield from _made(plan_line(self.machine, whole, feed_mm_min, watch=watch))
            return
        yield from _made(plan_line(self.machine, slack))
        yield from _made(plan_line(self.machine, delta, feed_mm_min))

    def slack_after(self, delta: Steps) -> Steps:
        """Backlash between motor and carriage after such a line."""
        return tuple(
            slack - take_up(slack, axis.backlash_steps, n)
            for slack, axis, n in zip(self.slack_steps, self.machine.axes, delta, strict=True)
        )

    def line(self, delta: Steps, feed_mm_min: float | None, watch: Watch | None = None) -> Job:
        """The same as a job."""
        for block in self.line_blocks(delta, feed_mm_min, watch):
            yield block

    def _too_long(self, distance_mm: float) -> LimitError:
        return LimitError(
            f"A jog must be longer than 0 and at most {self.config.jog.max_mm:g} mm,"
            f" not {distance_mm:g} mm."
        )

    def _targets(self, point_mm: Millimetres) -> Steps:
        for axis, mm in zip(self.machine.axes, point_mm, strict=True):
            self._require_finite(axis, mm)
        return self.machine.to_steps(point_mm)

    @staticmethod
    def _require_finite(axis: Axis, value_mm: float) -> None:
        if not math.isfinite(value_mm):
            raise LimitError(f"{axis.name.upper()} needs a number in mm, not {value_mm}.")

    @staticmethod
    def _require_feed(feed_mm_min: float | None) -> None:
        if feed_mm_min is not None and not feed_mm_min > 0:
            raise LimitError(f"A feed is above 0 mm/min, not {feed_mm_min:g}.")

    def _curve(self, targets: Sequence[Steps], feed_mm_min: float | None) -> Job:
        here = self.position_steps()
        for number, target in enumerate(targets, start=1):
            delta = tuple(to - at for to, at in zip(target, here, strict=True))
            here = target
            block = plan_line(self.machine, delta, feed_mm_min, tag=number)
            if block is not None:
                yield block

    def _require_not_running(self) -> None:
        if self._status is Status.RUN:
            raise StateError("The machine runs: cancel or wait for the end of the job first.")

    def _require_ready(self) -> None:
        self._require_not_running()
        if self._status is Status.ERROR:
            raise StateError(f"Acknowledge the error first: {self._message}")
        # Somebody may have moved a carriage, or pressed a switch, since the last look.
        self._runner.look_around(self.config.switches.readings)

    # --- facts ---------------------------------------------------------------------------------

    def _job_progress(self, elapsed_s: float) -> JobProgress | None:
        progress = self._progress
        if progress is None:
            return None
        return JobProgress(
            name=progress.name,
            line=self._runner.report.tag,
            lines=progress.lines,
            blocks=self._runner.blocks,
            elapsed_s=elapsed_s,
            expected_s=progress.expected_s,
        )

    def state(self) -> MachineState:
        """Everything that can be shown, as it is now. From any thread."""
        report = self._runner.report
        machine = self.machine
        position_steps = self._runner.seen_steps
        offset_mm = self.offset_mm
        position_mm = machine.to_mm(position_steps)
        progress = self._progress
        if self._status is Status.RUN:
            progress = self._job_progress((self._clock.now_ns() - self._job_from_ns) / _NS_PER_S)
        return MachineState(
            status=self._status,
            message=self._message,
            axes=tuple(axis.name for axis in machine.axes),
            position_steps=position_steps,
            position_mm=position_mm,
            work_mm=tuple(mm - offset for mm, offset in zip(position_mm, offset_mm, strict=True)),
            offset_mm=offset_mm,
            referenced=tuple(self._referenced),
            low_mm=tuple(axis.low_mm for axis in machine.axes),
            high_mm=tuple(axis.high_mm for axis in machine.axes),
            speed_mm_min=report.rate_hz * self._runner.mm_per_tick() * 60,
            running=report.running,
            held=self._runner.held and self._status is Status.RUN,
            energised=report.energised,
            switch_closed=report.switch_closed,
            ends=tuple(self.end_name(end) for end in sorted(self.ends())),
            switch_ignored=self._switch_mode is SwitchMode.IGNORE,
            inputs={
                pin: bool(report.inputs & bit) != inverted
                for pin, (bit, inverted) in INPUT_PINS.items()
            },
            job=progress,
            log_on=self.log is not None and self.log.is_on,
            late_ticks=report.late_ticks,
            dry_queues=report.dry_queues,
            question=self._runner.question,
            override=self.override,
        )
