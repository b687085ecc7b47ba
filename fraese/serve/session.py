"""One machine and its sender: who says what, in whose thread.

    line's thread      bytes --> lines --> inbox     at once: ? ! ~ reset, overrides, jog cancel
    machine's thread   turn: inbox --> commands, jobs --> answers, alarms

Rule 1: what is acted on at once sets flags of the controller, and nothing else; everything that is
        answered is so from the machine's thread, but for status reports.
Rule 2: a job that ends otherwise than well locks the machine, as a grbl does, until ``$X`` or
        ``$H``. Somebody else who stops it takes it from the sender: for him that is a reset.
Rule 3: a sender that goes away while his job moves stops it, with a ramp: nobody is left who could.
Rule 4: whatever a sender reads is English and ASCII.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Final

from fraese.anythread import any_thread
from fraese.control.controller import Controller
from fraese.control.state import SenderFacts, Status
from fraese.control.workcommands import select_system
from fraese.errors import FraeseError, LimitError
from fraese.phrases import phrase
from fraese.program.stream import Stream
from fraese.serve.answers import Answers
from fraese.serve.atonce import AtOnce, Wishes
from fraese.serve.codes import CRITICAL, Alarmed, Code, alarm_of, code_of
from fraese.serve.feeder import Feeder
from fraese.serve.inbox import Inbox, Sent
from fraese.serve.jogline import jogs
from fraese.serve.kinds import Kind, kind_of
from fraese.serve.modes import Doing, Modes
from fraese.serve.receiver import Receiver
from fraese.serve.report import as_message, parser_state
from fraese.serve.store import Store
from fraese.serve.system import System, Write

WELCOME: Final = "\r\nGrbl 1.1h ['$' for help]"
_OUT: Final = phrase("Somebody at the machine has taken over.")
LOCKED: Final = "[MSG:'$H'|'$X' to unlock]"


def _nobody(text: str) -> None:
    """Nobody listens."""


class Session:
    """A machine as a sender sees it.

    Args:
        controller: the machine.
        store: what is kept for senders.
        write: changes the configuration; see ``system.Write``.
        now_s: a clock of people's time.
        wake: called from any thread when there is something to do: ``turn`` is to be called.
        is_cancelled: an order to stop was given since ``turn`` was asked for.
        waits: lines may be waited for in the machine's thread; a test with a clock of its own does
            not.

    Attributes:
        modes: in which of grbl's states it is.
        name: who is connected; empty: nobody.
    """

    def __init__(
        self,
        controller: Controller,
        store: Store,
        write: Write,
        now_s: Callable[[], float],
        *,
        wake: Callable[[], object] = lambda: None,
        is_cancelled: Callable[[], bool] = lambda: False,
        waits: bool = True,
    ) -> None:
        self._controller = controller
        self._store = store
        self._wake = wake
        self._is_cancelled = is_cancelled
        self._inbox = Inbox(waits=waits)
        self.modes = modes = Modes()
        self.name = ""
        self._send: Callable[[str], object] = _nobody
        self._system = System(
            controller, modes, store, write, self.say,
            lambda: parser_state(self._stream.modal, self._stream.system),
            lambda axes: controller.home(axes), self._turn_check,
        )  # fmt: skip
        answers = Answers(controller.machine, self._inbox, self._system, self.say)
        self._answer, self._inline = answers.answer, answers.inline
        self._feeder = Feeder(
            self._inbox, modes, answers.answer, answers.inline, lambda: self._stream.at_rest,
            now_s, **({} if waits else {"linger_s": 0.0}),
        )  # fmt: skip
        self._feeder.report = answers.saw
        self._stream = Stream(controller, self._feeder, phrase("lines of a sender"))
        self._wishes = Wishes()
        self._at_once = AtOnce(
            controller, modes, self._wishes, self._inbox, self._stream, self._system, self.say, wake
        )
        self._receiver = Receiver(self._line, self._at_once.act)
        self._homes: Sent | None = None
        axes = zip(controller.machine.axes, controller.position.referenced, strict=True)
        if any(axis.has_switches and not known for axis, known in axes):
            modes.alarm = Alarmed.ABORT

    # --- the line's thread -----------------------------------------------------------------------

    @any_thread
    def connected(self, name: str, send: Callable[[str], object]) -> None:
        """Somebody has come: greet him as a grbl does that was reset.

        Args:
            name: of him, for people.
            send: takes text for him; never waits, from any thread.
        """
        self._inbox.clear()
        self._receiver = Receiver(self._line, self._at_once.act)
        self._at_once.report.anew()
        self._is_called(name)
        self._send = send
        if self._controller.status is Status.RUN:
            # Somebody else's job: it goes on.
            self._greet()
            return
        self._wishes.resets = True
        self._wake()

    @any_thread
    def lost(self) -> None:
        """He has gone; what moves for him stops."""
        self._is_called("")
        self._send = _nobody
        self._inbox.clear()
        self.modes.held = self.modes.door = False
        if self.modes.doing is not Doing.NOTHING:
            self._at_once.stop()

    @any_thread
    def take(self, *, out: bool) -> None:
        """Somebody at the machine takes over, or gives it back; what moves for the sender stops."""
        self.modes.out = out
        self._is_called(self.name)
        if out and self.modes.doing is not Doing.NOTHING:
            self._controller.cancel()
        self._wake()

    def _is_called(self, name: str) -> None:
        self.name = name
        self._controller.sender = SenderFacts(name, is_out=self.modes.out)

    @any_thread
    def feed(self, data: bytes) -> None:
        """Bytes have come."""
        self._receiver.feed(data)

    @property
    @any_thread
    def is_full(self) -> bool:
        """The line is not to be read for now."""
        return self._inbox.is_full

    def _line(self, text: str) -> None:
        self._inbox.put(Sent(text))
        self._wake()

    @any_thread
    def say(self, text: str) -> None:
        """A line to the sender."""
        self._send(text.encode("ascii", "replace").decode() + "\r\n")

    @any_thread
    def tell(self, message: str) -> None:
        """What a person should know, too."""
        self.say(as_message(message))

    # --- the machine's thread --------------------------------------------------------------------

    @property
    @any_thread
    def has_work(self) -> bool:
        """``turn`` has something to do."""
        if self._wishes.resets or self._failed_by_others or self._is_out_anew:
            return True
        waits = self.modes.critical or self.modes.held
        return not waits and bool(self._inbox.waiting_bytes)

    @property
    def _failed_by_others(self) -> bool:
        return self._controller.status is Status.ERROR and not self.modes.alarm

    @property
    def _is_out_anew(self) -> bool:
        return self.modes.out and not self.modes.alarm

    def turn(self) -> None:
        """Do what waits, up to the end of one job."""
        if self._is_out_anew:
            self._lock(Alarmed.ABORT, _OUT)
        if self._failed_by_others:
            self._lock(alarm_of(self._controller.error))
        self._settle()
        modes = self.modes
        while not (modes.critical or modes.held or self._wishes.resets):
            line = self._inbox.head()
            if line is None:
                return
            if self._begins(line):
                self._run()
                return

    def between(self) -> None:
        """Between two rounds of the run loop, while a job runs."""
        if self.modes.held and not self._controller.holding:
            # Somebody else has let it go on.
            self.modes.held = self.modes.door = False
        if self.modes.doing in (Doing.PROGRAM, Doing.JOG):
            self._feeder.between()

    def _begins(self, line: Sent) -> bool:
        """Do a line; True: a job was started, and has it still before it."""
        kind = kind_of(line.text)
        if self.modes.out and kind is not Kind.EMPTY:
            if kind is not Kind.SYSTEM or not self._inline(line):
                self._say_of(line, Code.LOCKED, _OUT)
            return False
        if kind is Kind.SYSTEM:
            return self._system_line(line)
        code = Code.OK
        if kind is not Kind.EMPTY and self.modes.alarm:
            code = Code.LOCKED if kind is Kind.CODE else Code.NOT_IDLE
        elif kind is Kind.JOG and self.modes.check:
            code = Code.NOT_IDLE
        elif kind is not Kind.EMPTY:
            return self._look() if self.modes.check else self._start(kind, line)
        self._say_of(line, code, "")
        return False

    def _say_of(self, line: Sent, code: Code, said: str) -> None:
        """Answer a line that waits."""
        if self._inbox.take(line):
            self._answer(line, code, said)

    def _system_line(self, line: Sent) -> bool:
        if not self._inbox.take(line):
            return False
        code, said = self._system.do(line)
        if self._controller.status is Status.RUN:
            self._homes, self.modes.doing = line, Doing.HOMING
            return True
        self._answer(line, code, said)
        return False

    def _start(self, kind: Kind, line: Sent) -> bool:
        self._feeder.begin(kind)
        try:
            if kind is Kind.JOG:
                self._stream.start_moves(
                    phrase("jog of a sender"),
                    lambda context: jogs(context, self._controller, self._stream, self._feeder),
                )
            else:
                self._stream.start()
        except FraeseError as error:
            self._say_of(line, code_of(error), str(error))
            return False
        self.modes.doing = Doing.JOG if kind is Kind.JOG else Doing.PROGRAM
        return True

    def _look(self) -> bool:
        """A line in check mode."""
        self._feeder.begin(Kind.CODE)
        try:
            self._stream.look()
        except LimitError as error:
            self._feeder.drop()
            self._stream.forget()
            self._lock(alarm_of(error), str(error))
        return False

    def _turn_check(self) -> None:
        self._stream.forget()
        self.modes.check = not self.modes.check
        self.say("[MSG:Enabled]" if self.modes.check else "[MSG:Disabled]")
        self._wishes.resets = self._wishes.resets or not self.modes.check

    def _run(self) -> None:
        controller = self._controller
        if self._is_cancelled():
            controller.cancel()
        try:
            status = controller.run()
        except FraeseError as error:
            # Nothing has moved.
            self.modes.doing = Doing.NOTHING
            self._feeder.close(code_of(error), str(error))
            self._stream.forget()
            return
        except BaseException:
            self._feeder.drop()
            self._stream.forget()
            self.modes.doing, self.modes.alarm = Doing.NOTHING, Alarmed.ABORT
            raise
        self._over(status)

    def _over(self, status: Status) -> None:
        """A job of the sender's has ended."""
        doing, self.modes.doing, self.modes.resting = self.modes.doing, Doing.NOTHING, False
        if status is Status.OK:
            self._is_homed(doing)
        elif status is Status.CANCEL:
            self._controller.acknowledge()
            self._is_cut(doing)
        else:
            self._feeder.drop()
            self._stream.forget()
            error = self._controller.error
            self._lock(alarm_of(error), "" if error is None else str(error))
        self._answer_flushed()
        self._wishes.was_moving = self._wishes.jog_cancelled = False
        self._settle()

    def _is_homed(self, doing: Doing) -> None:
        line, self._homes = self._homes, None
        if doing is Doing.HOMING and line is not None:
            self._answer(line, Code.OK, "")
            self._begin_lines()

    def _is_cut(self, doing: Doing) -> None:
        """It was told to end: by the sender, or by somebody who takes the machine from him."""
        if doing is Doing.JOG and self._wishes.jog_cancelled and not self._wishes.resets:
            self._feeder.close()
            return
        self._feeder.drop()
        self._stream.forget()
        self._wishes.flushed.clear()
        if not self._wishes.resets:
            self._inbox.clear()
            self._wishes.resets = self._wishes.was_moving = True
        if self._wishes.was_moving:
            self._lock(Alarmed.HOMING_RESET if doing is Doing.HOMING else Alarmed.ABORT)

    def _answer_flushed(self) -> None:
        lines, self._wishes.flushed = self._wishes.flushed, []
        for line in lines:
            self._answer(line, Code.OK, "")

    def _lock(self, alarm: Alarmed, said: str = "") -> None:
        self._homes = None
        self.modes.alarm, self.modes.critical = alarm, alarm in CRITICAL
        self.say(f"ALARM:{alarm:d}")
        if said:
            self.tell(said)
        if self.modes.critical:
            self.say("[MSG:Reset to continue]")

    def _settle(self) -> None:
        """A reset that was wanted, once nothing moves any more."""
        if not self._wishes.resets or self._controller.status is Status.RUN:
            return
        self._wishes.resets = False
        self.modes.let_go()
        self._stream.forget()
        self._at_once.report.anew()
        handling = self._controller.handling
        handling.set_feed(1.0)
        handling.set_rapid(1.0)
        # A machine that is not there says so when it is to move.
        with suppress(FraeseError):
            select_system(self._controller, "G54")
        self._greet()
        if not self.modes.alarm:
            self._begin_lines()

    def _greet(self) -> None:
        self.say(WELCOME)
        if self.modes.alarm:
            self.say(LOCKED)

    def _begin_lines(self) -> None:
        self._inbox.put_first(Sent(line, is_own=True) for line in self._store.start_lines if line)
