"""The app: puts link, keys and views together, hears the stop key, shows what the machine tells.

Rule 1: the latest state wins and is drawn at most every ``_FRAME_S``; alarms and refusals are
        messages of their own, each is shown.
Rule 2: stop and quit are the app's own actions; every other command is the action of a screen.
Rule 3: however the app ends, the link is closed: the motors are off.
"""

import asyncio
import contextlib
import contextvars
import math
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from rich.console import RenderableType
from textual import events
from textual.actions import SkipAction
from textual.driver import Driver
from textual.screen import ModalScreen

from fraese.control.benchfacts import Bench
from fraese.control.controller import Controller
from fraese.control.state import MachineState, Status
from fraese.phrases import shown, spoken
from fraese.plaintext import plain
from fraese.signalwatch import watched
from fraese.ui.bindings import bind
from fraese.ui.calibrating import Writer
from fraese.ui.dialogs.page import LivePage, Page
from fraese.ui.dialogs.switches import Hand
from fraese.ui.eventlog import EventLog, Kind
from fraese.ui.filememory import Recent
from fraese.ui.fingers import Fingers
from fraese.ui.handtools import HandTools, NoTools
from fraese.ui.heardapp import HeardApp
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.keyrows.everywhere import PALETTE, STOP_BYTE_KEY, STOP_KEYS
from fraese.ui.linehistory import LineHistory
from fraese.ui.machinelink import MachineLink
from fraese.ui.macros import Macro
from fraese.ui.messages import Alarmed, Noted, Refused
from fraese.ui.programs import OpenProgram, ProgramDesk, Resume, nothing_is_kept
from fraese.ui.questions import Questions
from fraese.ui.remembering import RememberingApp
from fraese.ui.session import SessionFile
from fraese.ui.settings import SettingsDesk
from fraese.ui.settled import freeze
from fraese.ui.stopkey import EarlyStop, Heard
from fraese.ui.themes import THEMES
from fraese.ui.views import VIEWS
from fraese.ui.views.view import Desk, View
from fraese.ui.widths import RepeatRule

#: Between two redraws.
_FRAME_S: Final = 0.04
#: The step loop of a simulated mill shares the interpreter: let it have its turn soon.
_SWITCH_INTERVAL_S: Final = 0.0005
#: They end what a key or a button of the jog pad is held for.
_NO_HANDS: Final = (events.AppBlur, events.Resize, events.MouseDown)
#: What the app is made of is there by then: modules, widgets, first pictures.
_SETTLED_S: Final = 0.5


class FraeseApp(HeardApp, RememberingApp):
    """The terminal app.

    Args:
        controller: owned by the app's worker thread until the app has ended, and closed then.
        open_program: reads a program file; called in a thread of its own.
        resume: how the program that was cut short is gone on with; called in the machine's thread.
        recent: which programs were opened last; None: nobody keeps that.
        notes: sentences to show at the start.
        program: file to open at the start.
        machine_name: which machine is driven, such as "simulated mill"; shown in the title.
        hand: presses (True) or lets go of (False) an end switch of a simulated machine, by name.
        leaving: told, from any thread, that the app begins to leave, and with which exit code.
        writer: writes the configuration file; None: there is none to write.
        bench: the machine as it lies open; None: nobody has opened it.
        views: the table of views; the first is there at the start.
        tools: who knows the language.
        history: where typed lines are kept; None: nowhere.
        keys: the table, if keys were changed; None: as they are.
        settings: the configuration file; None: there is none.
        macros: buttons of one's own; ``keys`` has their rows.
        session: where it is kept what is remembered; None: nowhere.

    Attributes:
        link: to the machine.
    """

    TITLE = "fraese"
    CSS_PATH = ["fraese.tcss", "program.tcss"]  # noqa: RUF012
    COMMAND_PALETTE_BINDING = PALETTE.keys
    DEFAULT_MODE = next(iter(VIEWS))

    def __init__(
        self,
        controller: Controller,
        *,
        open_program: OpenProgram,
        resume: Resume = nothing_is_kept,
        recent: Recent | None = None,
        notes: Sequence[str] = (),
        program: Path | None = None,
        machine_name: str = "",
        hand: Hand | None = None,
        leaving: Callable[[int], object] | None = None,
        writer: Writer | None = None,
        bench: Bench | None = None,
        views: Mapping[str, type[View]] = VIEWS,
        tools: HandTools | None = None,
        history: Path | None = None,
        keys: KeyTable | None = None,
        settings: SettingsDesk | None = None,
        session: Path | None = None,
        macros: Sequence[Macro] = (),
    ) -> None:
        self.link = MachineLink(controller, self.post_message)
        self._early_stop = EarlyStop(STOP_KEYS, self.link.brake_or_stop)
        self._heard: Heard | None = None
        self._leaving = leaving or (lambda code: None)
        self._has_crashed = False
        self._toast, self._toast_until_s = "", -math.inf
        super().__init__()
        self._keys = keys or KeyTable(self.link.shape, views)
        self._repeats = RepeatRule()
        self._questions = Questions(self, self._keys, self.link, lambda said: self.view.say(said))
        self._fingers = Fingers(
            self._repeats, self._strokes, self.set_timer, self.link.let_go,
            lambda: self.view.keys_unsure(), lambda: self.view.keys_rest(),
        )  # fmt: skip
        self._notes = tuple(notes)
        self._state = self.link.state()
        self._stopped_s, self._stop_key = -math.inf, ""
        self._drawn_at_s = 0.0
        self._draw_planned = False
        bind(self, self._keys.of(Area.EVERYWHERE))
        self._session = SessionFile(session)
        self._programs = ProgramDesk(open_program, program, resume, recent)
        self._events = EventLog()
        self._inputs = dict(self._session.found.inputs)
        self.remember_files()
        self.make_views(
            views,
            Desk(
                self.link, self._keys, self._repeats, self._strokes, self._programs, machine_name,
                hand, self._events, tools or NoTools(), LineHistory(history), writer, bench,
                settings, self._inputs,
                macros,
            ),
        )  # fmt: skip

    # --- coming and going ------------------------------------------------------------------------

    def on_mount(self) -> None:
        """First picture, then the machine's thread."""
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = THEMES[0].name
        self.remember_picture()
        self._draw(self._state)
        sys.setswitchinterval(_SWITCH_INTERVAL_S)
        if not self.is_headless:
            self.set_timer(_SETTLED_S, freeze)
        self.link.start()
        for note in self._notes:
            self.view.note(note, warning=True)

    def on_unmount(self) -> None:
        """Motors off; what is remembered is written."""
        self._programs.close()
        self.link.close()
        self._session.keep(self.session())

    async def run_async(self, **options: Any) -> None:
        """As Textual's; on every way out the motors are off."""
        loop, context = asyncio.get_running_loop(), contextvars.copy_context()

        def in_app(action: Callable[[], object]) -> None:
            # Once the app has ended there is nobody to tell.
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(action, context=context)

        self._in_app = in_app
        with watched(self._leave_by_signal):
            try:
                await super().run_async(**options)
            finally:
                self.link.close()
                self._programs.close()

    def terminal_is_gone(self) -> None:
        """Without a signal: nobody can press the stop key any more. From any thread."""
        self._leave_by_signal(signal.SIGTERM)

    def _leave_by_signal(self, number: int) -> None:
        """First the machine, then the picture; from any thread, whatever the app's waits for."""
        self.link.brake()
        self._leaving(128 + number)
        # In the app's turn, then in the view's: what Textual is still making it cannot end.
        in_turn = next(iter(self._views.values())).call_later
        self._in_app(partial(self.call_later, in_turn, self.exit, return_code=128 + number))

    def exit(
        self, result: None = None, return_code: int = 0, message: RenderableType | None = None
    ) -> None:
        """Leave; whoever ends the process is told."""
        self._leaving(return_code)
        super().exit(result, return_code, message)

    def panic(self, *renderables: RenderableType) -> None:
        """Something in the app itself failed: first the machine."""
        self._has_crashed = True
        self.link.brake()
        self._leaving(1)
        super().panic(*renderables)

    @property
    def exit_code(self) -> int:
        """Of the process, when the app has ended: never 0 after a crash."""
        return 1 if self._has_crashed else self.return_code or 0

    @property
    def busy(self) -> bool:
        """The machine's thread has something to do, or there is something left to draw."""
        return self.link.busy or self._draw_planned

    # --- keys ------------------------------------------------------------------------------------

    def get_driver_class(self) -> type[Driver]:
        """The terminal's, which tells of stop keys first."""
        driver = super().get_driver_class()
        if driver.__name__ == "LinuxDriver":
            # Only there: it takes what only Unix has.
            from fraese.ui.terminal import Terminal

            driver = Terminal
        elif driver.__name__ == "WebDriver":
            from fraese.ui.webterminal import WebTerminal

            driver = WebTerminal
        return self._early_stop.driver(driver)

    def draw_all(self) -> None:
        """The terminal is read again, and has not seen all; from any thread."""
        self._in_app(self.refresh)

    def notify(self, message: str, *, title: str = "", **options: Any) -> None:
        """As Textual's, made plain; what is still to be read is not said again.

        There is one at a time: more are not read, and hide the machine. All are in the log. A key
        that is held and refused would fill the memory with one sentence.
        """
        now_s, said = time.monotonic(), plain(shown(message))
        if said == self._toast and now_s < self._toast_until_s:
            return
        self.clear_notifications()
        self._toast = said
        self._toast_until_s = now_s + (options.get("timeout") or self.NOTIFICATION_TIMEOUT)
        super().notify(said, title=plain(shown(title)), **options)

    async def on_event(self, event: events.Event) -> None:
        """Let the repeat rule see every key before anything happens.

        A stop key overtakes what was pressed before it: what comes back from there is not done.
        """
        if isinstance(event, events.Key):
            if event.is_forwarded:
                # It has been to the screen and comes back to be done: too late after a stop.
                if event.time < self._stopped_s:
                    return
                self._fingers.does(event)
            else:
                self.let_go_of_pad()
                self._fingers.press(event)
                self._heard = self._early_stop.of(event)
                if event.key in STOP_KEYS:
                    self._stopped_s, self._stop_key = event.time, event.key
        elif isinstance(event, _NO_HANDS):
            self.let_go_of_pad()
            self._fingers.off(all_up=isinstance(event, events.AppBlur))
        await super().on_event(event)
        self._heard = None
        self._strokes.is_done()

    def action_stop_machine(self) -> None:
        """Brake; the second time while it moves, stop; end a look-through. Else the key is free."""
        if self._heard is None:
            moving = self.link.brake_or_stop()
        else:
            # Also what was pressed before it and has begun only now.
            moving = self._heard.moving or self.link.moving
            # What was done by hand while a job asks is over; the job was not meant.
            if not (self._heard.moving and self.link.question):
                self.link.brake()
        if self._programs.give_up():
            self.view.say(
                spoken("Given up: the program is not looked through, and nothing was started.")
            )
        elif not moving and not self._closed_by_stop():
            raise SkipAction
        if moving:
            self.view.draw(self._state, True)

    def _closed_by_stop(self) -> bool:
        """At standstill Ctrl+C closes what Escape closes: a dialog, the palette."""
        top = self.screen
        if self._stop_key != STOP_BYTE_KEY or not isinstance(top, ModalScreen):
            return False
        if isinstance(top, Page):
            top.action_back()
        else:
            top.dismiss(None)
        return True

    async def action_quit(self) -> None:
        """Brake and leave."""
        self.link.brake()
        self.exit()

    # --- to the screen ---------------------------------------------------------------------------

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
        state = self.link.take()
        if state is not None:
            self._draw(state)

    def _draw_what_was_before(self) -> None:
        """A state that waits for its frame would wipe a sentence that is newer than it."""
        if self._draw_planned:
            self._draw_latest()

    def _draw(self, state: MachineState) -> None:
        before, self._state = self._state, state
        # A job that begins wipes what was said before; one that ends without a word does not.
        has_turned = state.status is not before.status and (
            state.message or state.status is Status.RUN
        )
        if state.message != before.message or has_turned:
            failed = state.status is Status.ERROR
            if state.message and not failed:
                self._events.add(state.message)
            self.view.say(state.message, "-alarm" if failed else "")
        self.view.draw(state, self.link.cancelling)
        self._show_on_top()

    def _show_on_top(self) -> None:
        """Pages above the view that show the machine, and the job's question."""
        if not self.screen_stack:
            return  # on the way out the machine still reports
        top = self.screen
        if isinstance(top, LivePage):
            top.show(self._state)
        else:
            self._questions.show(self._state)

    def action_answer(self) -> None:
        """The job's question is to be seen again."""
        self._questions.again()

    def on_alarmed(self, message: Alarmed) -> None:
        """The job ended with an error."""
        self.bell()
        title = (
            spoken("Alarm {number}", number=message.number) if message.number else spoken("Error")
        )
        self._events.add(message.sentence, Kind.ALARM, message.number, message.advice)
        said = f"{shown(message.sentence)}\n{shown(message.advice)}".rstrip()
        self.notify(said, title=title, severity="error", timeout=10, markup=False)

    def on_refused(self, message: Refused) -> None:
        """A command was refused."""
        self._draw_what_was_before()
        self.view.refuse(message.sentence)

    def on_noted(self, message: Noted) -> None:
        """Something to know."""
        self._draw_what_was_before()
        self.view.note(message.sentence, message.warning)
