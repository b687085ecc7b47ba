"""One connection from HELLO to CLOSE: bytes are pumped only while somebody waits here.

    command, ask --> Link --bytes--> Line
                      ^                |
                      '---- pump <-----'   every STATUS is told to its listener

Rule 1: nothing runs by itself. Who waits for an answer pumps; a program that hangs pumps nothing,
        and the device, hearing nothing, brakes and switches off.
Rule 2: an answer is fresh if it came after the question and knows of every command before it; one
        that was on the line already may be as old as its own way, 2.4 ms at 250,000 baud.
Rule 3: the silence of a device counts only while it is listened to: a program that was stopped for
        a while finds what came meanwhile, and hears no silence.
"""

from collections.abc import Callable
from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.bridge.codec import Hello, Status
from fraese.motor.bridge.constants import (
    KIND_CLOSE,
    REFUSALS,
    URGENT_STOP,
    State,
)
from fraese.motor.bridge.greeting import PATIENCE_S, Greeting, new_session
from fraese.motor.bridge.line import Line
from fraese.motor.bridge.link import Link
from fraese.motor.bridge.stepwise import Steps, finish
from fraese.motor.seams import Clock
from fraese.phrases import phrase

#: Who does not answer for so long is gone; the device's own watchdog needs 250 ms.
DEAF_S: Final = 0.6
#: Who answers, but does not come to what is waited for in this time, never will.
STUCK_S: Final = 3.0
#: A longer gap between two looks at the line was a pause of this program, and is not counted.
_PAUSE_NS: Final = 50_000_000
#: Longest wait for bytes: then it is looked whether something must be said again.
_SLICE_S: Final = 0.005
#: At the end there is nothing to lose but time.
_FAREWELL_S: Final = 0.2
_NS_PER_S: Final = 1_000_000_000

Listener = Callable[[Status], None]


def greeting(
    line: Line,
    clock: Clock,
    name: str,
    baud: int,
    patience_s: float = PATIENCE_S,
    *,
    finds_rate: bool = True,
) -> "Steps[Session]":
    """Greet whoever is at the end of a line, step by step.

    Args:
        line: open; closed with the session, or if there is none.
        clock: its time.
        name: of the port, for sentences.
        baud: rate, likewise.
        patience_s: for the greeting.
        finds_rate: if nobody answers, find out whether it is the rate.

    Raises:
        PortError: if nobody answers.
    """
    number = new_session()
    try:
        hello = yield from Greeting(line, clock, name, baud).greeting(
            number, patience_s, finds_rate=finds_rate
        )
    except BaseException:
        line.close()
        raise
    return Session(line, clock, name, number, hello)


class Session:
    """A device that was greeted.

    Args:
        line: open; closed with the session.
        clock: its time.
        name: of the port, for sentences.
        number: of the session.
        hello: the device's answer.

    Attributes:
        line: as given.
        number: likewise.
        hello: what the device said of itself.
        link: what is under way.
        listener: told of every STATUS.
        looked_ns: when somebody last looked at the line.
    """

    def __init__(self, line: Line, clock: Clock, name: str, number: int, hello: Hello) -> None:
        self.line = line
        self.number = number
        self.hello = hello
        self._clock = clock
        self._name = name
        self._silent_s = 0.0
        self.looked_ns = clock.now_ns()
        self.listener: Listener | None = None
        self.link = Link(number, hello.ring)

    # --- waiting ---------------------------------------------------------------------------------

    def pump(self, timeout_s: float) -> None:
        """Send what may be sent, and take what comes within that time.

        Raises:
            PortError: if the line is gone, the device silent, or not the one that was greeted.
        """
        self.looked_ns = self._clock.now_ns()
        out = self.link.output(self.looked_ns)
        if out:
            self.line.write(out)
        wait_s = max(0.0, min(timeout_s, _SLICE_S))
        data = self.line.read(wait_s)
        expects = self.link.expects
        for status in self.link.feed(data, self._clock.now_ns()):
            if self.listener is not None:
                self.listener(status)
        if self.link.stranger is not None:
            raise PortError(
                phrase("The bridge on {name} was reset meanwhile", name=self._name),
                alarms.BRIDGE_LOST,
            )
        self._silent_s = self._silent_s + wait_s if expects and not data else 0.0
        if self._silent_s > DEAF_S:
            raise PortError(
                phrase("The bridge on {name} does not answer any more", name=self._name),
                alarms.BRIDGE_LOST,
            )

    def pumping(self, done: Callable[[], bool]) -> Steps[None]:
        """Pump until something is so; the device's silence ends it, and so does waiting in vain.

        Raises:
            PortError: as ``pump``.
        """
        waited_ns, since_ns = 0, self._clock.now_ns()
        while not done():
            self.pump(_SLICE_S)
            now_ns = self._clock.now_ns()
            waited_ns, since_ns = waited_ns + min(now_ns - since_ns, _PAUSE_NS), now_ns
            if waited_ns > STUCK_S * _NS_PER_S:
                raise PortError(
                    phrase("The bridge on {name} answers, but does not follow", name=self._name),
                    alarms.BRIDGE_STUCK,
                )
            yield

    def pump_until(self, done: Callable[[], bool]) -> None:
        """The same at a stretch."""
        finish(self.pumping(done))

    # --- saying ----------------------------------------------------------------------------------

    def commanding(self, kind: int, payload: bytes = b"") -> Steps[None]:
        """Have something carried out, and wait until it is acknowledged.

        Raises:
            PortError: if it is refused, or as ``pump``.
        """
        ticket = self.link.command(kind, payload)
        yield from self.pumping(lambda: self.link.done >= ticket)
        code = self.link.refusal(ticket)
        if code:
            what = REFUSALS.get(code, f"reason {code}")
            raise PortError(
                phrase(
                    "The bridge on {name} refuses command {kind:02X}: {what}",
                    name=self._name,
                    kind=kind,
                    what=what,
                ),
                alarms.BRIDGE_STUCK,
            )

    def command(self, kind: int, payload: bytes = b"") -> None:
        """The same at a stretch."""
        finish(self.commanding(kind, payload))

    def asking(self) -> Steps[Status]:
        """A STATUS that knows of everything that was said before.

        Raises:
            PortError: as ``pump``.
        """
        link = self.link
        ticket, heard = link.last_command, link.heard

        def answered() -> bool:
            if link.heard != heard and link.answered >= ticket:
                return True
            link.ask()
            return False

        yield from self.pumping(answered)
        assert link.status is not None
        return link.status

    def ask(self) -> Status:
        """The same at a stretch."""
        return finish(self.asking())

    def ask_until(self, done: Callable[[], bool]) -> None:
        """Ask, and again, until something is so.

        Raises:
            PortError: as ``pumping``.
        """

        def is_done() -> bool:
            if done():
                return True
            self.link.ask()
            return False

        self.pump_until(is_done)

    def shout(self, byte: int) -> None:
        """Say brake or stop. From any thread.

        Raises:
            PortError: if the line is gone.
        """
        self.line.write(self.link.wish(byte, self._clock.now_ns()))

    def sign_of_life(self) -> None:
        """Something good that is thrown away. From any thread.

        Raises:
            PortError: if the line is gone.
        """
        self.line.write(self.link.out_of_sequence())

    # --- the end ---------------------------------------------------------------------------------

    def close(self) -> None:
        """STOP, CLOSE: motors and outputs off; then the line. Never waits for long.

        Raises:
            PortError: if the device did not confirm it.
        """
        until_ns = self._clock.now_ns() + round(_FAREWELL_S * _NS_PER_S)

        def within_time(done: Callable[[], bool]) -> None:
            while not done():
                self.pump(_SLICE_S)
                if self._clock.now_ns() > until_ns:
                    raise PortError(
                        phrase("The bridge on {name} does not answer any more.", name=self._name),
                        alarms.BRIDGE_LOST,
                    )

        try:
            if self._moves():
                self.shout(URGENT_STOP)
                within_time(lambda: not self._moves())
            ticket = self.link.command(KIND_CLOSE)
            within_time(lambda: self.link.done >= ticket)
        finally:
            self.line.close()

    def _moves(self) -> bool:
        """As far as is known; asks again."""
        self.link.ask()
        status = self.link.status
        return status is None or bool(status.state & State.MOVING)

    def hang_up(self) -> None:
        """The line is of no use any more."""
        self.line.close()
