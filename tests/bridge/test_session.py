"""One connection and its patience: a model of the device, virtual time, pauses of the host."""

from dataclasses import replace
from typing import Any

import pytest

from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts
from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.connection import Connection
from fraese.motor.bridge.fromcard import card_facts, facts_of
from fraese.motor.bridge.session import DEAF_S, STUCK_S, Session
from fraese.motor.cards.stepdir import StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.switches import SwitchInput
from tests.bridge.model import RING, SESSION, Model

ANSWER_S = 0.001
NS_PER_S = 1_000_000_000
HELLO = Hello(
    version=c.PROTOCOL_VERSION,
    session=SESSION,
    firmware=(1, 0),
    ring=RING,
    payload_max=c.PAYLOAD_MAX,
    motors=4,
    table_max=32,
    window=c.WINDOW,
    phase_cards=True,
    clock_cards=True,
    reset_reason=0,
    boots=1,
    moving=False,
    board="model",
)


class ModelLine:
    """A Line to the model; reading takes its time.

    Attributes:
        mute: the device says nothing any more.
        pauses_s: this program is stopped for so long within its next reads.
    """

    def __init__(self, model: Model, clock: VirtualClock) -> None:
        self._model = model
        self._clock = clock
        self._coming = b""
        self.mute = False
        self.pauses_s: list[float] = []

    def read(self, timeout_s: float) -> bytes:
        data, self._coming = self._coming, b""
        wait_s = ANSWER_S if data else timeout_s
        pause_s = self.pauses_s.pop(0) if self.pauses_s else 0.0
        self._clock.wait_until(self._clock.now_ns() + round((wait_s + pause_s) * NS_PER_S))
        return data

    def write(self, data: bytes) -> None:
        if not self.mute:
            self._coming += self._model.feed(data)

    def set_baud(self, baud: int) -> None:
        """There is only one rate."""

    def close(self) -> None:
        """Nothing to give back."""


class Talk:
    """A session with the model."""

    def __init__(self) -> None:
        self.model = Model()
        self.clock = VirtualClock()
        self.line = ModelLine(self.model, self.clock)
        self.session = Session(self.line, self.clock, "the line", SESSION, HELLO)

    def seconds_in_vain(self) -> float:
        """How long something is waited for that does not come."""
        since_ns = self.clock.now_ns()
        with pytest.raises(PortError, match="answers, but does not follow"):
            self.session.pump_until(self._asked_in_vain)
        return (self.clock.now_ns() - since_ns) / NS_PER_S

    def _asked_in_vain(self) -> bool:
        self.session.link.ask()
        return False


def test_who_answers_but_does_not_follow_is_given_up_after_a_while() -> None:
    assert Talk().seconds_in_vain() == pytest.approx(STUCK_S, abs=0.1)


def test_a_program_that_was_stopped_for_a_while_is_no_fault_of_the_device() -> None:
    """A laptop that slept, a terminal that was stopped: then it listens on as before."""
    talk = Talk()
    talk.line.pauses_s = [0.0, 10.0, 0.0, 10.0]
    assert talk.seconds_in_vain() == pytest.approx(20 + STUCK_S, abs=0.2)


def test_what_came_meanwhile_is_found_after_the_pause() -> None:
    talk = Talk()
    talk.line.pauses_s = [10.0]
    talk.session.command(c.KIND_RESUME)
    assert talk.model.taken == [(c.KIND_RESUME, b"")]


def test_silence_counts_only_while_it_is_listened_to() -> None:
    talk = Talk()
    talk.line.mute = True
    talk.line.pauses_s = [10.0]
    since_ns = talk.clock.now_ns()
    with pytest.raises(PortError, match="does not answer any more"):
        talk.session.ask()
    assert (talk.clock.now_ns() - since_ns) / NS_PER_S == pytest.approx(10 + DEAF_S, abs=0.1)


def test_firmware_that_cannot_swap_motors_is_told_apart() -> None:
    """Before 1.1 a socket of clock and direction is known by its motor only."""
    facts = card_facts(
        facts_of(StepDirCard(sockets=(1, 0))),
        SwitchInput(0x80, 0, 3),
        settle_cycles=0,
        safe_outputs=0,
        silence_ms=0,
    )
    assert facts.motor_bits == (0x0C, 0x03)

    def connection(facts: CardFacts) -> Connection:
        return Connection(nowhere, VirtualClock(), facts, "ttyX", 250_000, 1.0)

    with pytest.raises(PortError, match=r"firmware 1.0, which cannot swap motors: give every"):
        connection(facts)._require_sockets(HELLO)
    connection(facts)._require_sockets(replace(HELLO, firmware=(1, 1)))
    connection(replace(facts, motor_bits=(0x03, 0x0C)))._require_sockets(HELLO)
    several = connection(replace(facts, switch_mask=0xC0))
    with pytest.raises(PortError, match=r"knows one input for end switches: flash firmware 1.4"):
        several._require_inputs(replace(HELLO, firmware=(1, 3)))
    several._require_inputs(replace(HELLO, firmware=(1, 4)))
    connection(facts)._require_inputs(HELLO)


def nowhere(*_: object) -> Any:
    raise AssertionError("nobody opens this line")
