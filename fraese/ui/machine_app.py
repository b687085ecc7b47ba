r"""The app without its commands: the machine's thread behind it, pictures in front.

    key ----action----> worker.submit ----> run loop ----offer----> feed ----> screen
         \---stop, hold---> flag (no queue in between)

Rule 1: nothing heavy happens in this thread; the machine's thread posts messages, no more.
Rule 2: stop and hold do not wait in line behind anything.
Rule 3: the latest state wins and is drawn at most every ``_FRAME_S``; alarms and refusals are
        messages of their own, each is shown.
Rule 4: however the app ends, the worker is closed: the motors are off.
"""

import asyncio
import contextlib
import gc
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any, Final

from textual.app import App
from textual.screen import Screen

from fraese.control.controller import Controller
from fraese.control.state import MachineState, Status
from fraese.control.worker import Command, Worker
from fraese.ui.feed import StateFeed
from fraese.ui.machine_screen import MachineScreen
from fraese.ui.messages import Alarmed, Noted, Refused, StateChanged
from fraese.ui.pages import LivePage
from fraese.ui.themes import DARK, LIGHT

#: Between two redraws.
_FRAME_S: Final = 0.04
#: An answer has arrived after this time; the same question then is a new one.
_ANSWER_S: Final = 0.3
#: The step loop of a simulated mill shares the interpreter: let it have its turn soon.
_SWITCH_INTERVAL_S: Final = 0.0005
#: How often it is seen whether the terminal is still there.
_TERMINAL_SEEN_S: Final = 0.25
#: What the app is made of is there by then: modules, widgets, first pictures.
_SETTLED_S: Final = 0.5
BUSY: Final = "The machine runs: stop it (Esc) or wait for the end of the job; nothing was done."


class MachineApp(App[None]):
    """Owns the worker, draws what it reports.

    Args:
        controller: see ``FraeseApp``, as for the others.
        notes: sentences to show at the start.
        before_motion: called before every command that moves.
        machine_name: shown in the title.
    """

    def __init__(
        self,
        controller: Controller,
        notes: Sequence[str],
        before_motion: Callable[[], object] | None,
        machine_name: str,
    ) -> None:
        super().__init__()
        self._controller = controller
        self._axes = tuple(axis.name for axis in controller.machine.axes)
        self._notes = tuple(notes)
        self._before_motion = before_motion
        self._worker = Worker(controller, on_refusal=self._tell_refusal, on_idle=self._offer)
        self._feed = StateFeed(lambda: self.post_message(StateChanged()))
        self._machine = MachineScreen(self._axes, machine_name)
        self._state = controller.state()
        self._drawn_at_s = 0.0
        self._draw_planned = False
        self._answer_is_new = False
        controller.set_display(self._full_display)
        controller.set_show_pos(self._offer)

    # --- coming and going ----------------------------------------------------------------------

    def get_default_screen(self) -> Screen[Any]:
        """The machine."""
        return self._machine

    def on_mount(self) -> None:
        """First picture, then the machine's thread."""
        self.register_theme(DARK)
        self.register_theme(LIGHT)
        self.theme = DARK.name
        self._draw(self._state)
        sys.setswitchinterval(_SWITCH_INTERVAL_S)
        if not self.is_headless:
            self.set_interval(_TERMINAL_SEEN_S, self._see_terminal)
            self.set_timer(_SETTLED_S, _freeze)
        self._worker.start()
        for note in self._notes:
            self._note(note, warning=True)

    def on_unmount(self) -> None:
        """Motors off."""
        self._worker.close()

    async def run_async(self, **options: Any) -> None:
        """As Textual's; on every way out the motors are off."""
        loop = asyncio.get_running_loop()
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            # Where there are no such signals, closing the window ends the process otherwise.
            with contextlib.suppress(NotImplementedError):
                if number is not None:
                    loop.add_signal_handler(number, self._leave_by_signal, number)
        try:
            await super().run_async(**options)
        finally:
            self._worker.close()

    def _see_terminal(self) -> None:
        """A terminal that went away without a signal: nobody can press the stop key any more."""
        if not os.isatty(sys.__stdin__.fileno() if sys.__stdin__ else 0):
            self._leave_by_signal(signal.SIGTERM)

    def _leave_by_signal(self, number: int) -> None:
        """The terminal may be gone already: first the machine, then the picture."""
        self._worker.cancel()
        self.exit(return_code=128 + number)

    @property
    def machine_state(self) -> MachineState:
        """The state last drawn."""
        return self._state

    @property
    def busy(self) -> bool:
        """The machine's thread has something to do, or there is something left to draw."""
        return self._worker.busy or self._draw_planned

    # --- from the machine's thread -------------------------------------------------------------

    def _offer(self) -> None:
        self._feed.offer(self._controller.state())

    def _tell_refusal(self, sentence: str) -> None:
        self.post_message(Refused(sentence))

    def _full_display(self) -> None:
        state = self._controller.state()
        self._feed.offer(state)
        if state.status is Status.ERROR:
            self.post_message(Alarmed(state.message))

    # --- to the screen -------------------------------------------------------------------------

    def on_state_changed(self) -> None:
        """Draw now, or when the frame is over."""
        if self._draw_planned:
            return
        wait_s = self._drawn_at_s + _FRAME_S - time.monotonic()
        if wait_s > 0:
            self._draw_planned = True
            self.set_timer(wait_s, self._draw_latest)
        else:
            self._draw_latest()

    def _draw_latest(self) -> None:
        self._draw_planned = False
        self._drawn_at_s = time.monotonic()
        state = self._feed.take()
        if state is not None:
            self._draw(state)

    def _draw(self, state: MachineState) -> None:
        before, self._state = self._state, state
        if state.message != before.message or state.status is not before.status:
            self._show_message(state)
        self._machine.show(state, self._controller.cancelling)
        self._show_on_top(state)

    def _show_message(self, state: MachineState) -> None:
        self._machine.say(state.message, "-alarm" if state.status is Status.ERROR else "")

    def _show_on_top(self, state: MachineState) -> None:
        """Pages above the main screen that show the machine, and the job's question."""
        if not self.screen_stack:
            return  # on the way out the machine still reports
        top = self.screen
        if isinstance(top, LivePage):
            top.show(state)
        elif state.question and not self._answer_is_new:
            from fraese.ui.dialogs import AskDialog

            question = state.question
            self.push_screen(AskDialog(question), lambda done: self._answered(question, done))

    def on_alarmed(self, message: Alarmed) -> None:
        """The job ended with an error."""
        self.bell()
        self.notify(message.sentence, title="Error", severity="error", timeout=10, markup=False)

    def on_refused(self, message: Refused) -> None:
        """A command was refused."""
        self._refuse(message.sentence)

    def on_noted(self, message: Noted) -> None:
        """Something to know."""
        self._note(message.sentence, message.warning)

    def _refuse(self, sentence: str) -> None:
        self._machine.say(sentence, "-warn")
        self.notify(sentence, severity="warning", timeout=5, markup=False)

    def _note(self, sentence: str, warning: bool = False) -> None:
        self._machine.say(sentence, "-warn" if warning else "")
        if warning:
            self.notify(sentence, severity="warning", timeout=8, markup=False)

    # --- orders and answers --------------------------------------------------------------------

    def order(self, command: Command, *, moves: bool = True) -> None:
        """Hand a command to the machine's thread."""
        before = self._before_motion if moves else None

        def ordered() -> None:
            if before is not None:
                before()
            command()

        if not self._worker.submit(ordered):
            self._refuse(BUSY)

    @property
    def _moving(self) -> bool:
        return self._controller.status is Status.RUN

    def _answered(self, question: str, done: object) -> None:
        """The job's question: done, or the job is to be stopped."""
        if self._state.question != question:
            return
        self._answer_is_new = True
        self.set_timer(_ANSWER_S, self._ask_again)
        if done:
            self._controller.answer()
        else:
            self._worker.cancel()

    def _ask_again(self) -> None:
        """The answer has arrived by now: what is asked still, or again, is a new question."""
        self._answer_is_new = False
        self._show_on_top(self._state)


def _freeze() -> None:
    """What will never be garbage is not looked at again.

    A full collection stops all threads meanwhile, the one that hears the stop key too: 170 ms with
    all objects of the app.
    """
    gc.collect()
    gc.freeze()
