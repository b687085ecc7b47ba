"""The controller (FRAESE): UI-free. Commands in, callbacks out.

Rule 1: everything runs in one thread, the one that calls ``run``. Only ``cancel``, ``stop``,
        ``hold``, ``resume``, ``answer``, ``set_override`` and ``state`` may be called from another.
Rule 2: callbacks are called from that thread. They may read ``state()`` and set those flags, no
        more.
Rule 3: a refused command leaves everything as it was.
Rule 4: what is known is known in one place: positions in ``whereabouts``, contacts in ``switches``,
        the queue in ``Ahead``. Here is only the status.

The run loop is the original's:

    full display
    while status is RUN:   poll the driver, feed its queue  ->  status
                           break-key callback
                           show-position callback
    full display, motors idle
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from fraese import limits, straight
from fraese.ahead import Ahead
from fraese.aside import Detour
from fraese.calibration import Homing
from fraese.config import Config
from fraese.context import ProgramContext
from fraese.endswitches import EndSwitches, pin_levels
from fraese.errors import FraeseError, LimitError, StateError
from fraese.jobs import Job
from fraese.journal import Kept
from fraese.log import LogFile, logged
from fraese.log import write as log_line
from fraese.machine import Machine, Steps
from fraese.motor.seams import Clock, IdleLevel, StepDriver
from fraese.runner import Runner
from fraese.state import JobProgress, MachineState, Status
from fraese.whereabouts import Whereabouts

_NS_PER_S: Final = 1_000_000_000


def _nothing() -> None:
    """No callback registered."""


def _unheard(message: str) -> None:
    """Nobody to tell."""


class Controller:
    """Status, run loop and commands.

    Args:
        machine: axes and conversions.
        driver: what plays the blocks; closed with the controller.
        clock: the driver's clock.
        config: limits, feeds, standstill.
        log: the log file that can be switched, if there is one.
        slice_s: how long one poll of the driver may take, s.

    Attributes:
        whereabouts: positions, references, work offsets.
        switches: the end switches and the probe.
        error: what the last job failed with, if it did.
        override: feed override, a factor.
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
        self._status = Status.OK
        self._message = ""
        self._progress: JobProgress | None = None
        self._job_from_ns = 0
        self._idle_at_ns: int | None = None
        self.error: FraeseError | None = None
        self.override = 1.0
        self.whereabouts = Whereabouts(machine)
        self._ahead = Ahead(driver, self.whereabouts)
        self.switches = EndSwitches(config, self.whereabouts, self._ahead, driver)
        braking_s = max(axis.max_rate_hz / axis.acceleration_hz_s for axis in machine.axes)
        lead_s = max(config.run.lead_s, braking_s + 2 * slice_s)
        self._slice_ns = round(slice_s * _NS_PER_S)
        self._runner = Runner(driver, self._ahead, lead_s, slice_s)
        self._ahead.look_around(config.switches.readings)

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
        log_line("controller", "run", "exit", f"{self._status.value} {self.whereabouts.in_words()}")
        return self._status

    def idle(self, elapsed_s: float = 0.0) -> None:
        """Between jobs: look at the inputs, and switch the current off when its time has come.

        Args:
            elapsed_s: how long the caller has waited since the last call; a clock that only moves
                when somebody waits is moved on by it.
        """
        self._clock.wait_until(self._clock.now_ns() + round(elapsed_s * _NS_PER_S))
        self._ahead.poll()
        if self._idle_at_ns is not None and self._clock.now_ns() >= self._idle_at_ns:
            self._idle_at_ns = None
            self._driver.idle(IdleLevel(self.config.standstill.current))
            self._ahead.poll()

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

    def _require_ready(self) -> None:
        self._require_not_running()
        if self._status is Status.ERROR:
            raise StateError(f"Acknowledge the error first: {self._message}")
        # Somebody may have moved a carriage, or pressed a switch, since the last look.
        self._ahead.look_around(self.config.switches.readings)

    def _require_not_running(self) -> None:
        if self._status is Status.RUN:
            raise StateError("The machine runs: cancel or wait for the end of the job first.")

    def _activate(self) -> Status:
        status = self._runner.activate()
        self.whereabouts.lose_reference(self._ahead.report.torn)
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
            self._message = f"Cancelled at {self.whereabouts.in_words()}."
            if self._ahead.report.torn:
                self._message += " Stopped without ramp: reference the axes before relying on it."
        elif self._status is Status.ERROR:
            self.error = self._runner.failure or self.switches.alarm()
            self._message = str(self.error)
        # Cutting ends with the job; what was cancelled or failed also leaves no spindle running.
        ended = ("laser",) if self._status is Status.OK else ("laser", "spindle", "coolant")
        mask = self.config.outputs.mask(*ended)
        if mask:
            self._driver.set_outputs(mask, 0)
        self._progress = self._job_progress()

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
        limits.require_jog(distance_mm, self.config.jog.max_mm)
        motor = self.machine.index(axis)
        moved, here = self.machine.axes[motor], self.whereabouts.position_steps[motor]
        target = moved.to_steps(moved.to_mm(here) + distance_mm)
        self.jog_steps(axis, target - here, clamp=clamp)

    @logged
    def jog_steps(self, axis: str, distance_steps: int, *, clamp: bool = False) -> None:
        """The same in steps.

        Raises:
            LimitError: if it would leave the travel, or is nothing.
            StateError: if the machine is not ready, or stands on the switch it would move into.
        """
        self._require_ready()
        motor = self.machine.index(axis)
        if not distance_steps:
            step_mm = self.machine.axes[motor].step_mm
            raise LimitError(f"A jog must be at least one step of {step_mm:g} mm.")
        target = list(self.whereabouts.position_steps)
        target[motor] += distance_steps
        if clamp:
            target[motor] = limits.within(self.whereabouts, motor, target[motor])
        limits.require_reachable(self.whereabouts, [tuple(target)])
        watch = self.switches.watch_for_jog(motor, distance_steps)
        feed_mm_min = self.config.jog.feed_mm_min
        line = straight.line_to(self.whereabouts, tuple(target), feed_mm_min, watch)
        self.start(f"jog {axis.upper()}", line)

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
        where = self.whereabouts
        target = list(where.position_steps)
        for name, value_mm in targets_mm.items():
            motor = self.machine.index(name)
            axis = self.machine.axes[motor]
            limits.require_finite(axis, value_mm)
            if relative:
                value_mm += axis.to_mm(where.position_steps[motor])
            elif not machine_coordinates:
                value_mm += where.offset_mm[motor]
            target[motor] = axis.to_steps(value_mm)
        limits.require_feed(feed_mm_min)
        self.check_moves([tuple(target)])
        self.start("move", straight.line_to(where, tuple(target), feed_mm_min))

    @logged
    def run_curve(
        self, points_mm: Sequence[Sequence[float]], feed_mm_min: float | None = None
    ) -> None:
        """Work through a list of points in work coordinates, straight lines in between.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        offset_mm = self.whereabouts.offset_mm
        machine_mm = [
            [mm + by for mm, by in zip(point_mm, offset_mm, strict=True)] for point_mm in points_mm
        ]
        self.drive_points("curve", machine_mm, feed_mm_min)

    @logged
    def home(self, axes: Sequence[str] = (), *, measure: bool | None = None) -> None:
        """Reference axes, all configured ones by default; ``run`` does it.

        Raises:
            StateError: if the machine is not ready.
        """
        homing = self.config.homing
        order: list[str] = [name for name in homing.order if not axes or name in axes]
        order += [name for name in axes if name not in order]
        measure = homing.measure if measure is None else measure
        job = Homing(homing, self.whereabouts, self.switches, self.say, measure).job(order)
        self.start("reference " + " ".join(name.upper() for name in order), job)

    @logged
    def set_zero(self, axes: Iterable[str], value_mm: float = 0.0) -> None:
        """Let the present position have this work coordinate.

        Raises:
            StateError: while the machine runs.
        """
        self._require_not_running()
        for name in axes:
            self.whereabouts.set_zero(name, value_mm)

    @logged
    def ignore_switches(self, ignore: bool) -> None:
        """Let contacts stop the motors, or not (for trying things out).

        Raises:
            StateError: while the machine runs.
        """
        self._require_not_running()
        self.switches.ignore(ignore)

    def switch_log(self, on: bool) -> None:
        """Log on or off.

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
        limits.require_override(factor)
        self.override = factor

    def say(self, message: str) -> None:
        """Show a message."""
        self._message = message
        self._tell(message)

    def drive_points(
        self,
        name: str,
        points_mm: Sequence[Sequence[float]],
        feed_mm_min: float | None = None,
    ) -> None:
        """Straight lines through points in machine coordinates; ``run`` makes them.

        Raises:
            LimitError: if a point is outside the travel; nothing has moved then.
            StateError: if the machine is not ready.
        """
        targets = [limits.to_steps(self.machine, point_mm) for point_mm in points_mm]
        limits.require_feed(feed_mm_min)
        self.check_moves(targets)
        curve = straight.curve(self.whereabouts, targets, feed_mm_min)
        self.start(name, curve, lines=len(targets))

    def check_moves(self, targets: Sequence[Steps]) -> None:
        """See that every target can be reached, before anything moves.

        Raises:
            LimitError: naming axis, target and travel.
            StateError: if the machine is not ready, or stands on a switch.
        """
        self._require_ready()
        self.switches.require_open()
        limits.require_reachable(self.whereabouts, targets)

    # --- facts ---------------------------------------------------------------------------------

    def travelled_steps(self) -> Steps:
        """Steps made since the start, both directions added, per axis."""
        return self._ahead.report.travelled_steps

    def blocks_pushed(self) -> int:
        """Blocks of the present job given to the driver so far."""
        return self._ahead.blocks

    def blocks_finished(self) -> int:
        """Blocks of the present job that were played to their end, the one in hand left out."""
        return self._ahead.finished

    def program_context(self) -> ProgramContext:
        """The machine as a program finds it now."""
        return ProgramContext(
            config=self.config,
            machine=self.machine,
            start_steps=self.whereabouts.position_steps,
            slack_steps=self.whereabouts.slack_steps,
            referenced=self.whereabouts.referenced,
            parameters=dict(self.whereabouts.offsets.parameters),
        )

    def keep(self) -> Kept:
        """What must survive a restart."""
        return Kept(
            position_steps=self.whereabouts.position_steps,
            slack_steps=self.whereabouts.slack_steps,
            parameters=self.whereabouts.offsets.parameters,
            referenced=self.whereabouts.referenced,
            phases=self._ahead.report.phases,
        )

    def take_up(self, kept: Kept) -> None:
        """Go on where another run ended; the phases are the driver maker's business."""
        self.whereabouts.take_up(
            kept.position_steps, kept.slack_steps, kept.referenced, kept.parameters
        )
        self._ahead.poll()

    def _job_progress(self) -> JobProgress | None:
        if self._progress is None:
            return None
        return replace(
            self._progress,
            line=self._ahead.report.tag,
            blocks=self._ahead.blocks,
            elapsed_s=(self._clock.now_ns() - self._job_from_ns) / _NS_PER_S,
        )

    def state(self) -> MachineState:
        """Everything that can be shown, as it is now. From any thread."""
        report, where, axes = self._ahead.report, self.whereabouts, self.machine.axes
        runs = self._status is Status.RUN
        position_steps, offset_mm = where.position_steps, where.offset_mm
        position_mm = self.machine.to_mm(position_steps)
        return MachineState(
            status=self._status,
            message=self._message,
            axes=tuple(axis.name for axis in axes),
            position_steps=position_steps,
            position_mm=position_mm,
            work_mm=tuple(mm - offset for mm, offset in zip(position_mm, offset_mm, strict=True)),
            offset_mm=offset_mm,
            referenced=where.referenced,
            low_mm=tuple(axis.low_mm for axis in axes),
            high_mm=tuple(axis.high_mm for axis in axes),
            speed_mm_min=self._ahead.mm_s() * 60,
            running=report.running,
            held=self._runner.held and runs,
            energised=report.energised,
            switch_closed=report.switch_closed,
            ends=self.switches.names(),
            switch_ignored=self.switches.ignored,
            inputs=pin_levels(report.inputs),
            job=self._job_progress() if runs else self._progress,
            log_on=self.log is not None and self.log.is_on,
            late_ticks=report.late_ticks,
            dry_queues=report.dry_queues,
            question=self._runner.question,
            override=self.override,
        )
