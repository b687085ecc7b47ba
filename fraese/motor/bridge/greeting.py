"""Who is there? The first words on a line, and what to say if nobody answers them.

    open (an Arduino resets, its boot loader listens for a second)
      -> HELLO, again and again -> reply with our session: greeted
                                -> reply "moving":        brake, and again
                                -> bytes, but no reply:   a wrong rate, or something else
                                -> silence:               other rates are tried, to say which

Rule 1: a session is a random number, so that old replies are not ours.
Rule 2: nothing is believed of a device with another version of the protocol.
"""

import random
from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.bridge.codec import Decoder, Frame, Hello, hello
from fraese.motor.bridge.constants import (
    KIND_HELLO_REPLY,
    PROTOCOL_VERSION,
    URGENT_BRAKE,
)
from fraese.motor.bridge.line import Line
from fraese.motor.bridge.stepwise import Steps
from fraese.motor.seams import Clock
from fraese.phrases import phrase

#: The boot loader of an Uno listens for 1 s, that of old ones for 2 s.
PATIENCE_S: Final = 3.5
#: Between two HELLOs.
_AGAIN_S: Final = 0.1
#: Longest wait for bytes at a time.
_LOOK_S: Final = 0.005
#: Motors that are found moving have so long to come to rest.
_REST_S: Final = 5.0
#: Rates at which a bridge may have been built, and how long each is tried.
_RATES: Final = (250_000, 115_200, 500_000, 1_000_000, 57_600)
_TRY_S: Final = 0.25
_NS_PER_S: Final = 1_000_000_000


def new_session() -> int:
    """A number for a session, 1 to 65535."""
    return random.randrange(1, 0x10000)


class Greeting:
    """One attempt to find out who is there.

    Args:
        line: already open.
        clock: for the patience.
        name: of the port, for sentences.
        baud: its rate, likewise.
    """

    def __init__(self, line: Line, clock: Clock, name: str, baud: int) -> None:
        self._line = line
        self._clock = clock
        self._name = name
        self._baud = baud
        self._heard = False

    def greeting(self, session: int, patience_s: float, *, finds_rate: bool) -> Steps[Hello]:
        """Say HELLO until it is accepted.

        Args:
            session: to be opened.
            patience_s: so long is it repeated.
            finds_rate: if nobody answers, try at which rate somebody does.

        Raises:
            PortError: if nobody answers, or somebody else than a bridge of this version.
        """
        reply = yield from self._answer(session, patience_s)
        if reply is None:
            other = (yield from self._other_rate(session)) if finds_rate else None
            raise PortError(self._unanswered(other), alarms.BRIDGE_MISSING)
        if reply.version != PROTOCOL_VERSION:
            raise PortError(
                phrase(
                    "The bridge on {name} speaks version {version} of the protocol, this"
                    " program version {protocol_version}: flash the firmware that belongs to"
                    " it (fraese bridge flash).",
                    name=self._name,
                    version=reply.version,
                    protocol_version=PROTOCOL_VERSION,
                ),
                alarms.BRIDGE_UNFIT,
            )
        if reply.moving:
            reply = yield from self._calmed(session)
        return reply

    def _answer(self, session: int, patience_s: float) -> Steps[Hello | None]:
        """The reply to this session, or that motors are moving; None: there was none."""
        decoder = Decoder()
        now_ns = self._clock.now_ns
        until_ns, again_ns = now_ns() + round(patience_s * _NS_PER_S), now_ns()
        while now_ns() < until_ns:
            if now_ns() >= again_ns:
                self._line.write(hello(session))
                again_ns = now_ns() + round(_AGAIN_S * _NS_PER_S)
            data = self._line.read(_LOOK_S)
            self._heard |= bool(data)
            for item in decoder.feed(data):
                reply = _hello_in(item)
                if reply and (reply.session == session or reply.moving):
                    return reply
                if reply and reply.version != PROTOCOL_VERSION:
                    return reply
            yield
        return None

    def _calmed(self, session: int) -> Steps[Hello]:
        """Motors are moving, left so by another program: brake, then HELLO again."""
        until_ns = self._clock.now_ns() + round(_REST_S * _NS_PER_S)
        while self._clock.now_ns() < until_ns:
            self._line.write(bytes((URGENT_BRAKE, URGENT_BRAKE)))
            reply = yield from self._answer(session, _AGAIN_S)
            if reply and not reply.moving:
                return reply
        raise PortError(
            phrase(
                "The motors behind {name} move and do not brake: switch them off.", name=self._name
            ),
            alarms.BRIDGE_STUCK,
        )

    def _other_rate(self, session: int) -> Steps[int | None]:
        """The rate at which somebody answers."""
        for baud in _RATES:
            if baud == self._baud:
                continue
            self._line.set_baud(baud)
            if (yield from self._answer(session, _TRY_S)):
                return baud
        return None

    def _unanswered(self, other: int | None) -> str:
        if other:
            return phrase(
                "The bridge on {name} speaks {other} baud, not {baud}: write baud ="
                " {other} under [port].",
                name=self._name,
                other=other,
                baud=self._baud,
            )
        if self._heard:
            return phrase(
                "What comes from {name} makes no sense at {baud} baud: either port.baud"
                " is not the firmware's rate, or this is no fraese bridge.",
                name=self._name,
                baud=self._baud,
            )
        return phrase(
            "Nobody answers on {name} at {baud} baud: is this the board with the fraese"
            " firmware (see fraese ports; fraese bridge flash puts it on), and port.baud the"
            " rate that it was built for?",
            name=self._name,
            baud=self._baud,
        )


def _hello_in(item: object) -> Hello | None:
    if not isinstance(item, Frame) or item.kind != KIND_HELLO_REPLY:
        return None
    try:
        return Hello.parse(item.payload)
    except ValueError:
        return None
