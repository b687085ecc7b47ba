"""Bytes that are acted on at once, wherever they stand: in the thread that reads the line.

Rule 1: they set flags of the controller and wishes for the machine's thread; nothing waits.
Rule 2: a hold is one of the job in hand, and of all that waits; a jog that is held is over.
        Only what the sender has begun or held he lets go on.
Rule 3: a reset brakes with a ramp, so that the place stays known, and is carried out at rest. It
        locks the machine if that moved, as a grbl does.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from fraese.control.controller import Controller
from fraese.control.state import OVERRIDES, Status
from fraese.program.stream import Stream
from fraese.serve import receiver, settings
from fraese.serve.inbox import GRBL_BYTES, Inbox, Sent
from fraese.serve.kinds import Kind, kind_of
from fraese.serve.modes import Doing, Modes
from fraese.serve.report import Axes, StatusReport, as_message
from fraese.serve.system import System

#: What a grbl has room for, in moves.
_MOVES: Final = 15
#: Bytes that change the feed override, by so many per cent; None: back to 100.
_FEEDS: Final[Mapping[int, int | None]] = {0x90: None, 0x91: 10, 0x92: -10, 0x93: 1, 0x94: -1}
_RAPIDS: Final[Mapping[int, float]] = {0x95: 1.0, 0x96: 0.5, 0x97: 0.25}


#: What a sender may say when somebody has taken the machine from him: nothing that lets it move.
_ALWAYS: Final = frozenset({receiver.STATUS, receiver.HOLD, receiver.DOOR, receiver.RESET})


@dataclass
class Wishes:
    """What the machine's thread is to see to when the job in hand has ended.

    Attributes:
        resets: begin anew.
        was_moving: it moved when that was wanted.
        jog_cancelled: only a jog was to end.
        flushed: jogs that had not begun then.
    """

    resets: bool = False
    was_moving: bool = False
    jog_cancelled: bool = False
    flushed: list[Sent] = field(default_factory=list)


class AtOnce:
    """What they do.

    Args:
        controller: the machine.
        modes: changed by them.
        wishes: likewise.
        inbox: what waits.
        stream: what is planned.
        system: knows what is to be reported.
        say: tells the sender a line.
        wake: lets the machine's thread look.

    Attributes:
        report: remembers what was reported.
    """

    def __init__(
        self,
        controller: Controller,
        modes: Modes,
        wishes: Wishes,
        inbox: Inbox,
        stream: Stream,
        system: System,
        say: Callable[[str], object],
        wake: Callable[[], object],
    ) -> None:
        self._controller = controller
        self._modes = modes
        self._wishes = wishes
        self._inbox = inbox
        self._stream = stream
        self._system = system
        self._say = say
        self._wake = wake
        self._asked = ""
        self.report = StatusReport(Axes(controller.machine))
        rapids = controller.handling.set_rapid
        self._acts: Mapping[int, Callable[[], object]] = {
            receiver.STATUS: self._status,
            receiver.HOLD: self._hold,
            receiver.DOOR: partial(self._hold, door=True),
            receiver.GO_ON: self._go_on,
            receiver.RESET: self._reset,
            receiver.JOG_CANCEL: self._cancel_jog,
            **{byte: partial(self._feed, by) for byte, by in _FEEDS.items()},
            **{byte: partial(rapids, factor) for byte, factor in _RAPIDS.items()},
        }

    def act(self, byte: int) -> None:
        """Do what it asks for; one that means nothing is passed over."""
        act = self._acts.get(byte)
        if act is not None and not (self._modes.out and byte not in _ALWAYS):
            act()

    def stop(self) -> None:
        """Brake, and let the machine begin anew at rest."""
        state, wishes = self._controller.state(), self._wishes
        stands = self._modes.resting or state.held or bool(state.question)
        wishes.was_moving = wishes.was_moving or not stands
        wishes.resets = True
        self._controller.cancel()

    def _status(self) -> None:
        state, value = self._controller.state(), self._system.value
        if state.question != self._asked:
            self._asked = state.question
            if state.question:
                self._say(as_message(state.question))
        left = self._controller.blocks_left()
        moves = self._stream.pending + left if state.status is Status.RUN else 0
        self._say(
            self.report.line(
                state,
                self._modes.word(state, holding=self._controller.holding),
                mask=int(value(settings.REPORT_MASK)),
                inches=bool(value(settings.INCHES)),
                free=(max(0, _MOVES - moves), max(0, GRBL_BYTES - self._inbox.waiting_bytes)),
            )
        )

    def _hold(self, *, door: bool = False) -> None:
        if self._modes.alarm:
            return
        if self._modes.doing is Doing.JOG:
            self._cancel_jog()
            return
        if self._controller.status is Status.RUN:
            self._controller.hold()
        self._modes.held = True
        self._modes.door = self._modes.door or door

    def _go_on(self) -> None:
        if not self._modes.held and self._modes.doing is Doing.NOTHING:
            # Somebody else has held what moves, or is asked something.
            return
        self._modes.held = self._modes.door = False
        self._controller.resume()
        self._controller.answer()
        self._wake()

    def _reset(self) -> None:
        self._inbox.clear()
        self._wishes.resets = True
        if self._controller.status is Status.RUN:
            self.stop()
        self._wake()

    def _cancel_jog(self) -> None:
        if self._modes.doing is not Doing.JOG:
            return
        self._wishes.jog_cancelled = True
        while (line := self._inbox.head()) is not None and kind_of(line.text) is Kind.JOG:
            if self._inbox.take(line):
                self._wishes.flushed.append(line)
        self._controller.cancel()

    def _feed(self, by_percent: int | None) -> None:
        handling = self._controller.handling
        percent = 100 if by_percent is None else round(handling.feed * 100) + by_percent
        low, high = OVERRIDES
        handling.set_feed(min(max(percent / 100, low), high))
