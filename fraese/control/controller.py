"""The controller (FRAESE): UI-free. Commands in, callbacks out.

Rule 1: everything runs in one thread, the one that calls ``run``. Only what is marked
        ``any_thread`` may be called from another.
Rule 2: callbacks are called from that thread. They may call what is marked so, no more; the break
        key's also commands, while a job waits for an answer (``commands.py``, rule 2).
Rule 3: a refused command leaves everything as it was.
Rule 4: what is known is known in one place: positions in ``position``, contacts in ``switches``,
        the queue in ``MotionQueue``, the status in ``RunLoop``. Here are only orders and facts; the
        commands are in ``commands.py``.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from fraese.anythread import any_thread
from fraese.config import Config
from fraese.control.about import PLAIN, About
from fraese.control.aims import Aims
from fraese.control.commands import Commands
from fraese.control.cutting import CuttingHistory
from fraese.control.endswitches import EndSwitches
from fraese.control.handling import Handling
from fraese.control.jobs import Job, move_of
from fraese.control.motionqueue import MotionQueue
from fraese.control.onlooker import Nobody, Onlooker
from fraese.control.position import Position
from fraese.control.recorder import Recorder
from fraese.control.runloop import RunLoop
from fraese.control.savedstate import SavedState
from fraese.control.snapshot import snapshot
from fraese.control.state import NO_SENDER, MachineState, Status
from fraese.errors import FraeseError
from fraese.log import LogFile
from fraese.machine import Machine, Steps
from fraese.motor.seams import Clock, StepDriver


class Controller(Commands):
    """Commands and facts of one machine.

    Args:
        machine: axes and conversions.
        driver: what plays the blocks; closed with the controller.
        clock: the driver's clock.
        config: limits, feeds, standstill.
        log: the log file that can be switched, if there is one.
        slice_s: how long one poll of the driver may take, s.
        step_word: what the card calls one step.
        onlooker: who sees what no driver can know; None: there is metal, and nobody does.
        recorder: who keeps where the machine is; None: nobody does.

    Attributes:
        position: positions, references, work offsets.
        switches: the end switches and the probe.
        handling: overrides, and how programs are run.
        cutting: feed and spindle of the program in hand, or of the last one.
        aims: where the moves of the program in hand end.
        sender: another program that is connected, for whoever shows it; replaced whole.
    """

    def __init__(
        self,
        machine: Machine,
        driver: StepDriver,
        clock: Clock,
        config: Config,
        log: LogFile | None = None,
        slice_s: float = 0.02,
        step_word: str = "step",
        onlooker: Onlooker | None = None,
        recorder: Recorder | None = None,
    ) -> None:
        self.machine = machine
        self.config = config
        self.step_word = step_word
        self.log = log
        self._driver = driver
        self._onlooker = seen = onlooker or Nobody()
        self.handling = handling = Handling(
            driver, optional_stop=config.run.optional_stop, block_delete=config.run.block_delete
        )
        self.position = Position(machine)
        self.cutting = CuttingHistory()
        self.sender = NO_SENDER
        self.switches = EndSwitches(config, self.position, driver)
        keeper = recorder or Recorder()
        self._queue = MotionQueue(driver, self.position, self.switches, keeper, handling)
        self.aims = Aims(self._queue, self.position)
        # The first words with the driver; until here nobody has spoken to it.
        self._queue.open()
        self.switches.open()
        self._queue.look_around(config.switches.readings, clock)
        self._loop = RunLoop(
            config, driver, clock, self._queue, self.position, self.switches, slice_s, seen
        )

    # --- the run loop --------------------------------------------------------------------------

    @property
    @any_thread
    def status(self) -> Status:
        """OK, RUN, CANCEL or ERROR."""
        return self._loop.status

    @property
    @any_thread
    def error(self) -> FraeseError | None:
        """What the last job failed with, if it did."""
        return self._loop.error

    @property
    @any_thread
    def question(self) -> str:
        """What the operator is asked now; empty if nothing."""
        return self._loop.runner.question

    @property
    @any_thread
    def cancelling(self) -> bool:
        """The running job has been told to end; it may still be braking."""
        return self.status is Status.RUN and self._loop.runner.cancelling

    @property
    @any_thread
    def holding(self) -> bool:
        """The running job has been told to wait; it may still be braking."""
        return self.status is Status.RUN and self._loop.runner.holding

    def set_display(self, procedure: Callable[[], None]) -> None:
        """Register the full display; called in the run loop's thread."""
        self._loop.set_display(procedure)

    def set_show_pos(self, procedure: Callable[[], None]) -> None:
        """Register the position display; called in the run loop's thread after every slice."""
        self._loop.set_show_pos(procedure)

    def set_break_key(self, procedure: Callable[[], None]) -> None:
        """Register the query for a break key; called in the run loop's thread after every slice."""
        self._loop.set_break_key(procedure)

    def set_tell(self, procedure: Callable[[str], None]) -> None:
        """Register who is told what a person should know; called in the run loop's thread."""
        self._loop.set_tell(procedure)

    def start(self, name: str, job: Job, about: About = PLAIN) -> None:
        """Take up a job; ``run`` works it off. See ``RunLoop.start``, also for what it raises."""
        self._loop.start(name, job, about)

    def run(self) -> Status:
        """Work off what was started, to motors at rest; how it ended."""
        return self._loop.run()

    def idle(self, elapsed_s: float = 0.0) -> None:
        """Between jobs: look at the inputs, and switch the current off when its time has come."""
        self._loop.idle(elapsed_s)

    def acknowledge(self) -> None:
        """Take note of an error or cancel; back to OK."""
        self._loop.acknowledge()

    def say(self, message: str) -> None:
        """Show a message."""
        self._loop.say(message)

    def close(self) -> None:
        """Motors off, port given back, log off (FraesEnd)."""
        self._driver.close()
        self.switch_log(False)

    # --- orders: straight to the flags, from any thread ----------------------------------------

    @any_thread
    def cancel(self) -> None:
        """Brake, then drop the rest of the job."""
        self._loop.runner.cancel()

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest of the job: no ramp."""
        self._loop.runner.stop()

    @any_thread
    def hold(self) -> None:
        """Brake and wait."""
        self._loop.runner.hold()

    @any_thread
    def resume(self) -> None:
        """Go on after a hold."""
        self._loop.runner.resume()

    @any_thread
    def answer(self) -> None:
        """The operator has done what was asked; nothing without a question."""
        self._loop.runner.answer()

    @any_thread
    def switch_log(self, on: bool) -> None:
        """Log on or off.

        Raises:
            ConfigError: if the file cannot be written.
        """
        if self.log is not None:
            self.log.switch(on)

    # --- facts ---------------------------------------------------------------------------------

    def travelled_steps(self) -> Steps:
        """Steps made since the start, both directions added, per axis."""
        return self._queue.report.travelled_steps

    def move_played(self) -> int:
        """Number of the move of the program that is being played; 0: none yet."""
        return move_of(self._queue.tag)

    def blocks_pushed(self) -> int:
        """Blocks of the present job given to the driver so far."""
        return self._queue.blocks

    def blocks_finished(self) -> int:
        """Blocks of the present job that were played to their end."""
        return self._queue.finished

    @any_thread
    def blocks_left(self) -> int:
        """Blocks given to the driver that are not through yet."""
        return self._queue.left

    def spare_s(self) -> float:
        """How long the motors may go on before they must brake, if nothing more is pushed, s."""
        return max(0.0, self._queue.duration_s() - self._queue.braking_s())

    def cut_short(self) -> Mapping[str, Any] | None:
        """What is kept of the program in hand, or of the last one that was cut short."""
        return self._loop.unfinished.known()

    def keep(self) -> SavedState:
        """What must survive a restart."""
        report = self._queue.report
        state = SavedState.of(self.position, report.phases, self.switches.names())
        # Also in the middle of a block.
        slack_steps = self.position.slack_seen_steps(report.position_steps)
        return state.model_copy(update={"slack_steps": slack_steps, "job": self.cut_short()})

    def take_up(self, kept: SavedState) -> None:
        """Go on where another run ended; the phases are the driver maker's business."""
        kept.give_back(self.position)
        self.switches.take_up(kept.ends)
        self._loop.unfinished.left = kept.job
        self._queue.poll()

    @any_thread
    def state(self) -> MachineState:
        """Everything that can be shown, as it is now."""
        seen = snapshot(
            self._loop,
            self._queue,
            self.position,
            self.switches,
            log_on=self.log is not None and self.log.is_on,
            step_word=self.step_word,
            seen=self._onlooker.look(),
            cutting=self.cutting,
            aims=self.aims,
            tools=self.config.tools,
        )
        return replace(seen, sender=self.sender) if self.sender != NO_SENDER else seen
