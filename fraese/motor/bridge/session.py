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

from fraese.errors import PortError
from fraese.motor.bridge.cards import CardFacts, card_commands
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
from fraese.motor.seams import Clock

#: Who does not answer for so long is gone; the device's own watchdog needs 250 ms.
DEAF_S: Final = 0.6
#: Longest wait for bytes: then it is looked whether something must be said again.
_SLICE_S: Final = 0.005
#: At the end there is nothing to lose but time.
_FAREWELL_S: Final = 0.2
_NS_PER_S: Final = 1_000_000_000

Listener = Callable[[Status], None]


class Session:
    """A device that was greeted.

    Args:
        line: open; closed with the session.
        clock: its time.
        name: of the port, for sentences.
        baud: rate, likewise.
        patience_s: for the greeting.

    Attributes:
        line: as given.
        hello: what the device said of itself.
        link: what is under way.
        listener: told of every STATUS.

    Raises:
        PortError: if nobody answers; the line is closed then.
    """

    def __init__(
        self, line: Line, clock: Clock, name: str, baud: int, patience_s: float = PATIENCE_S
    ) -> None:
        self.line = line
        self._clock = clock
        self._name = name
        self._silent_s = 0.0
        self.listener: Listener | None = None
        session = new_session()
        try:
            self.hello: Hello = Greeting(line, clock, name, baud).greet(session, patience_s)
        except BaseException:
            line.close()
            raise
        self.link = Link(session, self.hello.ring)

    # --- waiting ---------------------------------------------------------------------------------

    def pump(self, timeout_s: float) -> None:
        """Send what may be sent, and take what comes within that time.

        Raises:
            PortError: if the line is gone, the device silent, or not the one that was greeted.
        """
        out = self.link.output(self._clock.now_ns())
        if out:
            self.line.write(out)
        wait_s = max(0.0, min(timeout_s, _SLICE_S))
        data = self.line.read(wait_s)
        expects = self.link.expects
        for status in self.link.feed(data, self._clock.now_ns()):
            if self.listener is not None:
                self.listener(status)
        if self.link.stranger is not None:
            raise PortError(f"The bridge on {self._name} was reset meanwhile")
        self._silent_s = self._silent_s + wait_s if expects and not data else 0.0
        if self._silent_s > DEAF_S:
            raise PortError(f"The bridge on {self._name} does not answer any more")

    def pump_until(self, done: Callable[[], bool]) -> None:
        """Pump until something is so; the device's silence ends it.

        Raises:
            PortError: as ``pump``.
        """
        while not done():
            self.pump(_SLICE_S)

    # --- saying ----------------------------------------------------------------------------------

    def command(self, kind: int, payload: bytes = b"") -> None:
        """Have something carried out, and wait until it is acknowledged.

        Raises:
            PortError: if it is refused, or as ``pump``.
        """
        ticket = self.link.command(kind, payload)
        self.pump_until(lambda: self.link.done >= ticket)
        code = self.link.refusal(ticket)
        if code:
            what = REFUSALS.get(code, f"reason {code}")
            raise PortError(f"The bridge on {self._name} refuses command {kind:02X}: {what}")

    def ask(self) -> Status:
        """A STATUS that knows of everything that was said before.

        Raises:
            PortError: as ``pump``.
        """
        link = self.link
        ticket, heard = link.last_command, link.heard
        while link.status is None or link.heard == heard or link.answered < ticket:
            link.ask()
            self.pump(_SLICE_S)
        return link.status

    def shout(self, byte: int) -> None:
        """Say brake or stop. From any thread.

        Raises:
            PortError: if the line is gone.
        """
        self.line.write(self.link.wish(byte, self._clock.now_ns()))

    def upload(self, facts: CardFacts) -> None:
        """Tell the device which card it has.

        Raises:
            PortError: as ``command``.
        """
        for kind, payload in card_commands(facts):
            self.command(kind, payload)

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
                    raise PortError(f"The bridge on {self._name} does not answer any more.")

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
