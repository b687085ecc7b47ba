r"""The machine as the app sees it: orders in, states and messages out.

    order ----> worker.submit ----> run loop ----offer----> feed ----> app
     \---stop, hold---> flag (no queue in between)

Rule 1: nothing heavy happens in the app's thread; the machine's thread posts messages, no more.
Rule 2: stop and hold do not wait in line behind anything.
Rule 3: the latest state wins; alarms and refusals are messages of their own, each is shown.
"""

import time
from collections.abc import Callable, Sequence
from typing import Final

from textual.message import Message

from fraese.control.asleft import Left, left_by_crash, take_as_left
from fraese.control.controller import Controller
from fraese.control.heldjog import DEAD_MAN_S, Hold
from fraese.control.state import OVERRIDES, RAPID_OVERRIDES, MachineState, Status, three_decimals
from fraese.control.worker import Command, Worker
from fraese.phrases import spoken
from fraese.ui.feed import StateFeed
from fraese.ui.jogging import Jogger
from fraese.ui.messages import Alarmed, Noted, Refused, StateChanged
from fraese.ui.senders import Senders
from fraese.ui.shape import shape_of

#: What is said when a switch of a run is off, and on.
_SAID_OF_SWITCHES: Final = {
    "single_block": (
        spoken("Single block is off: the program runs on."),
        spoken("Single block is on: the program waits after every line that moves."),
    ),
    "optional_stop": (spoken("M1 is passed."), spoken("M1 stops.")),
    "block_delete": (
        spoken("Lines that begin with a slash are run, from the next start on."),
        spoken("Lines that begin with a slash are left out, from the next start on."),
    ),
}


class MachineLink:
    """Owns the worker, and through it the controller.

    Orders return whether they were taken; one that is not has not been done.

    Args:
        controller: owned by the worker's thread until ``close``, and closed then.
        post: tells the app something; called from any thread.

    Attributes:
        shape: what the machine has.
        jog_rate: how fast jogs go.
        left_at_start: what a crash before this start has left; None: there was none.
        switches_tried: end switches that were pressed by hand and seen since the start.
    """

    def __init__(
        self,
        controller: Controller,
        post: Callable[[Message], object],
    ) -> None:
        self._controller = controller
        self._post = post
        self._worker = Worker(controller, on_refusal=self._refused, on_idle=self._idle)
        self._feed = StateFeed(lambda: post(StateChanged()))
        self._jogger = Jogger(
            controller, self._worker, lambda said: post(Noted(said)), self._refused
        )
        self.jog_rate = self._jogger.rate
        self._held: Hold | None = None
        self.shape = shape_of(controller)
        self.switches_tried: frozenset[str] = frozenset()
        self.left_at_start = left_by_crash(controller)
        controller.set_display(self._full_display)
        controller.set_show_pos(self._between)
        self._senders: Senders | None = None

    def let_in(self, senders: Senders) -> None:
        """Other programs may drive the machine, too; before ``start``."""
        self._senders = senders

    def start(self) -> None:
        """Begin to work."""
        self._worker.start()
        if self._senders is not None:
            self._senders.start()

    def close(self) -> None:
        """Wait for standstill, motors off. Safe to call twice."""
        if self._senders is not None:
            self._senders.close()
        self._worker.close()

    # --- facts -----------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Something runs or waits."""
        return self._worker.busy

    @property
    def moving(self) -> bool:
        """A job runs; it may be held."""
        return self._controller.status is Status.RUN

    @property
    def cancelling(self) -> bool:
        """The operator has pressed stop and it still moves."""
        return self._controller.cancelling

    @property
    def question(self) -> str:
        """What the job asks now; empty: nothing."""
        return self._controller.question

    @property
    def lifts(self) -> bool:
        """An axis lifts the tool."""
        return self._controller.machine.vertical is not None

    def state(self) -> MachineState:
        """How it stands now."""
        return self._controller.state()

    def take(self) -> MachineState | None:
        """The latest state that was told of, for the app's thread."""
        return self._feed.take()

    def offer(self) -> None:
        """Tell of the state, if it is a new one. From any thread."""
        self._feed.offer(self._controller.state())

    def _idle(self) -> None:
        self.offer()
        if self._senders is not None:
            self._senders.look()

    def _between(self) -> None:
        self.offer()
        if self._senders is not None:
            self._senders.between()

    @property
    def was_stopped(self) -> bool:
        """Since the command in hand was taken, somebody has told it to end."""
        return self._worker.cancelled

    def note(self, sentence: str) -> None:
        """Let the app say this; from any thread."""
        self._post(Noted(sentence))

    def take_over(self) -> str:
        """Take the machine from a sender, or give it back to him; what to say about it."""
        sender = self._controller.sender
        if self._senders is None or not (sender.name or sender.is_out):
            return ""
        self._senders.take(out=not sender.is_out)
        self.offer()
        return (
            spoken("The sender may drive the machine again.")
            if sender.is_out
            else spoken("Taken over: nothing that the sender sends is done.")
        )

    def _refused(self, sentence: str) -> None:
        self._post(Refused(sentence))

    def _full_display(self) -> None:
        self.offer()
        state = self._controller.state()
        if state.status is Status.ERROR:
            alarm = state.alarm
            said = (alarm.number, alarm.advice()) if alarm else ()
            self._post(Alarmed(state.message, *said))

    # --- at once, from any thread ----------------------------------------------------------------

    def brake_or_stop(self) -> bool:
        """Brake; what is braking already stops without ramp. Whether the machine moved."""
        moving = self.moving
        if self._controller.cancelling:
            self._worker.stop()
        else:
            self._worker.cancel()
        self._jogger.forget()
        return moving

    def brake(self) -> None:
        """Brake, and drop what waits; never harder than with ramp."""
        self._worker.cancel()
        self._jogger.forget()

    def hold_or_go_on(self) -> None:
        """Feed hold, or go on where it stands."""
        if self._controller.holding:
            self._controller.resume()
        elif self.moving:
            self._controller.hold()

    def override(self, by_percent: int) -> None:
        """Feed override up or down, or (0) as programmed."""
        handling = self._controller.handling
        percent = round(handling.feed * 100) + by_percent if by_percent else 100
        if not by_percent:
            handling.set_rapid(1.0)
        low, high = OVERRIDES
        handling.set_feed(min(max(percent / 100, low), high))
        self.offer()

    def override_rapids(self, by_percent: int) -> None:
        """Override of rapids up or down."""
        handling = self._controller.handling
        low, high = RAPID_OVERRIDES
        percent = round(handling.rapid * 100) + by_percent
        handling.set_rapid(min(max(percent / 100, low), high))
        self.offer()

    def switch_run(self, name: str) -> str:
        """Turn a switch of a run; what to say about it."""
        handling = self._controller.handling
        handling.switch(name)
        self.offer()
        return _SAID_OF_SWITCHES[name][getattr(handling, name)]

    def answer(self) -> None:
        """What the job asks for has been done."""
        self._controller.answer()

    def switch_log(self) -> str:
        """Log on or off; what to say about it, empty where there is none.

        Raises:
            ConfigError: if the file cannot be written.
        """
        self._controller.switch_log(not self._controller.state().log_on)
        self.offer()
        log = self._controller.log
        return (
            spoken(
                "The log is {word}: {path}",
                word=spoken("on") if log.is_on else spoken("off"),
                path=log.path,
            )
            if log is not None
            else ""
        )

    # --- in line ---------------------------------------------------------------------------------

    def order(self, command: Command) -> bool:
        """Hand a command to the machine's thread."""
        return self._worker.submit(command)

    def order_of(self, command: Callable[[Controller], object]) -> bool:
        """The same for what wants the controller."""
        return self.order(lambda: command(self._controller))

    def jog(self, axis: str, *, steps: int = 0, mm: float = 0.0, held: bool = False) -> bool:
        """One press of a jog key: so many steps, or mm; ``held``: the key is held down."""
        return self._jogger.press(axis, steps=steps, mm=mm, held=held)

    def hold_jog(
        self, axis: str, sign: int, silence_s: float = DEAD_MAN_S, since_s: float | None = None
    ) -> bool:
        """A jog that runs while it is held; see ``Hold``."""
        self._held = Hold(time.monotonic, silence_s, since_s)
        return self._jogger.hold(axis, sign, self._held)

    def still_held(self, at_s: float | None = None) -> None:
        """So it is."""
        if self._held is not None:
            self._held.hold(at_s)

    @property
    def is_held(self) -> bool:
        """Something is held, and may go on."""
        return self._held is not None and self._held.is_held

    def let_go_held(self) -> None:
        """It is not held any more; from any thread."""
        held = self._held
        if held is not None:
            held.let_go()

    def let_go(self) -> None:
        """A jog key that was held was let go."""
        self.let_go_held()
        self._jogger.let_go()

    @property
    def jogs_waiting(self) -> tuple[tuple[str, int], ...]:
        """Names of axes, and how many presses of their jog keys wait, signed."""
        return self._jogger.waiting

    def reference(self, axes: Sequence[str], *, measure: bool) -> bool:
        """Run to the end switches."""
        return self.order(lambda: self._controller.home(axes, measure=measure))

    def zero(self, axes: Sequence[str], undo_key: str) -> bool:
        """Work zero here; tells where this point was before, and which key undoes it."""

        def zero() -> None:
            before = self._controller.state()
            self._controller.set_zero(axes)
            was = self._position_words(before, axes)
            self._post(
                Noted(
                    spoken(
                        "Work zero set here; this point was {was} before; {undo_key} undoes it.",
                        was=was,
                        undo_key=undo_key,
                    )
                )
            )

        return self.order(zero)

    def undo_zero(self) -> bool:
        """Work zero as it was before the last time it was set."""

        def undo() -> None:
            self._controller.undo_zero()
            self._post(Noted(spoken("The work zero is where it was before.")))

        return self.order(undo)

    def lift(self) -> bool:
        """Raise the tool."""
        return self.order(self._controller.lift)

    def _position_words(self, state: MachineState, names: Sequence[str]) -> str:
        """In work coordinates; the unit once where it is the same for all."""
        chosen = [(axis, i) for i, axis in enumerate(self.shape.axes) if axis.name in names]
        numbers = [f"{axis.letter} {three_decimals(state.work_mm[i])}" for axis, i in chosen]
        if not any(axis.turns for axis, _ in chosen):
            return " ".join(numbers) + " mm"
        return " ".join(
            axis.with_unit(number) for (axis, _), number in zip(chosen, numbers, strict=True)
        )

    def tick_off(self, name: str) -> None:
        """This end switch was pressed by hand, and seen."""
        self.switches_tried |= {name}

    def ask_what_was_left(self, tell: Callable[[Left | None], object]) -> bool:
        """What a crash has left and is not settled yet; told in the machine's thread."""
        return self.order(lambda: tell(left_by_crash(self._controller)))

    def take_as_left(self) -> bool:
        """The position is as a crash left it."""

        def take() -> None:
            take_as_left(self._controller)
            self._post(Noted(spoken("The position is as it was left.")))

        return self.order(take)

    def ignore_switches(self, ignore: bool) -> bool:
        """Contacts stop the motors, or do not."""
        return self.order(lambda: self._controller.ignore_switches(ignore))

    def acknowledge(self) -> bool:
        """Take note of an error."""
        return self.order(self._controller.acknowledge)
