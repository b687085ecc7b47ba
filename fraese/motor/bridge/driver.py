r"""The driver whose steps are timed by a microcontroller at the end of a serial line.

    push --> Outbox --> record --> Session ---line---> ring --> steps
    brake, stop ------- urgent bytes, from any thread ---> within a tick
    poll --> STATUS? ------------> Session <--line--- STATUS --> Picture --> Report

Rule 1: as ``MotorCore``: a run begins in ``poll``, and a report knows of everything before it.
Rule 2: blocks that were pushed before it was known that the queue had been dropped are dropped.
Rule 3: whoever calls nothing for ``silence_s`` while the motors run, or are energised, is taken for
        hung: the device brakes, drops the queue and switches off.
Rule 4: a line that is lost, or a device that was reset, is told of once, as a PortError with the
        bounds between which the motors must be. Every later ``poll`` looks for the device, for some
        milliseconds, and says so; an attempt that fails is followed by another one a second later.
        Counts then go on from what was known last, and all motors are torn until something moves.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import Final

from fraese import alarms
from fraese.anythread import any_thread
from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.errors import PortError
from fraese.motor.blockqueue import require_sound
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts
from fraese.motor.bridge.codec import Status
from fraese.motor.bridge.connection import LEVELS, MODES, Connection
from fraese.motor.bridge.fromcard import card_facts, facts_of
from fraese.motor.bridge.greeting import PATIENCE_S
from fraese.motor.bridge.ledger import Ledger
from fraese.motor.bridge.line import OpenLine
from fraese.motor.bridge.outbox import Outbox
from fraese.motor.bridge.picture import Picture
from fraese.motor.bridge.search import Search
from fraese.motor.bridge.session import Session
from fraese.motor.bridge.stepwise import Steps, finish
from fraese.motor.seams import Card, Clock, Ended, IdleLevel, Report, SwitchMode, only_at_standstill
from fraese.motor.switches import SwitchInput
from fraese.phrases import joined, phrase

#: A poll asks for its last report so long before its time is up: an answer takes 4 ms.
_ANSWER_S: Final = 0.004
#: Between two reports while a run is watched: often enough to keep the ring filled, and seldom, for
#: a report costs the device as much time as forty steps.
_LOOK_S: Final = 0.02
_MOST_OVERRIDE_Q8: Final = 0xFFFF
_NS_PER_S: Final = 1_000_000_000


class BridgeDriver:
    """The peer behind the StepDriver seam that has a microcontroller make the steps.

    Args:
        open_line: opens the line; also used to find a lost device again.
        card: what the registers mean; only asked for facts and phases.
        clock: for waiting; the steps have their own.
        switch: the shared end-switch input.
        settle_s: wait after energising, before the first step.
        capacity: blocks that are taken before they are played, 250 at most.
        safe_outputs: free outputs that are off whenever the motors stand (a laser).
        silence_s: so long may the host call nothing while motors run or have current.
        name, baud: of the line, for sentences.
        patience_s: so long is the first greeting repeated.
        ledger: is told what the next program must know of a device that lives on; closed with this.
        facts: of the card, for the device; None: as they are known of its class.

    Raises:
        PortError: if the device is not there, or not one.
    """

    def __init__(
        self,
        open_line: OpenLine,
        card: Card,
        clock: Clock,
        switch: SwitchInput = SwitchInput(),  # noqa: B008 (immutable)
        settle_s: float = 0.02,
        capacity: int = 250,
        safe_outputs: int = 0,
        silence_s: float = 1.0,
        name: str = "the line",
        baud: int = c.DEFAULT_BAUD,
        patience_s: float = PATIENCE_S,
        ledger: Ledger = Ledger(),  # noqa: B008 (writes nothing)
        facts: CardFacts | None = None,
    ) -> None:
        facts = card_facts(
            facts or facts_of(card),
            switch,
            settle_cycles=round(settle_s * CYCLES_PER_S),
            safe_outputs=safe_outputs,
            silence_ms=round(silence_s * 1000),
        )
        self._connection = Connection(open_line, clock, facts, name, baud, patience_s)
        self._card, self._clock, self._name = card, clock, name
        self._capacity = capacity
        self._mode = SwitchMode.STOP
        self._override_q8 = self._override_sent_q8 = Q8
        self._stopping = self._closed = False
        self._ledger = ledger
        self._picture = Picture(card, has_table=bool(facts.table), ledger=ledger)
        self._session: Session | None = None
        self._search = Search(self._connecting_again, clock, name)
        try:
            finish(self._connecting(again=False))
        except BaseException:
            ledger.close()
            raise

    # --- the seam --------------------------------------------------------------------------------

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken.

        Raises:
            ValueError: if it cannot be played as it says, or never fits the device.
            PortError: if the device is lost.
        """
        session = self.session
        require_sound(block, self._card.motors)
        account = self._picture.account
        if account.queued >= self._capacity or self._outbox.is_full:
            return False
        data = self._outbox.record(block, account.pushed + 1)
        account.push(block)
        session.link.stream(data)
        return True

    def poll(self, budget_s: float) -> Report:
        """Let it play for at most that long, and say where things stand.

        Raises:
            PortError: if the device was lost since the last call, or is not there yet.
        """
        until_ns = self._clock.now_ns() + round(budget_s * _NS_PER_S)
        if self._session is None:
            self._require_open()
            self._search.look()
        picture = self._picture
        with self._guarded() as session:
            if picture.stands or budget_s < 2 * _ANSWER_S:
                self._look(session)
                self._see_to_start(session)
            while picture.runs and (left_s := self._left_s(until_ns) - _ANSWER_S) > 0:
                self._watch(session, min(left_s, _LOOK_S))
                self._look(session)
                self._see_to_start(session)
        return picture.report(self._capacity, self._outbox.room_blocks)

    @any_thread
    def brake(self) -> None:
        """Close the throttle; the queue stays."""
        self._shout(c.URGENT_BRAKE)

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest."""
        self._stopping = True
        self._shout(c.URGENT_STOP)

    @any_thread
    def set_override(self, factor: float) -> None:
        """Play what was planned with a higher feed override no faster."""
        self._override_q8 = min(_MOST_OVERRIDE_Q8, round(factor * Q8))

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        with self._guarded() as session:
            self._confirm_shouts(session)
            session.command(c.KIND_RESUME)

    def flush(self) -> None:
        """Drop the queue at standstill, and open the throttle for what comes next.

        Raises:
            StateError: while steps are being made.
            PortError: if the device is lost.
        """
        with self._guarded() as session:
            self._require_standstill(session, phrase("the queue can only be dropped"))
            self._drop(session, Ended.FLUSH)

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
            PortError: if the device is lost.
        """
        with self._guarded() as session:
            self._require_standstill(session, phrase("the motors can only be switched off"))
            session.command(c.KIND_IDLE, LEVELS[level])

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        with self._guarded() as session:
            session.command(c.KIND_OUTPUTS, bytes((mask & 0x0F, value & 0x0F)))

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""
        self._mode = mode
        with self._guarded() as session:
            session.command(c.KIND_MODE, MODES[mode])

    def close(self) -> None:
        """Motors and outputs off, line given back. Safe to call twice.

        Raises:
            PortError: if the device did not confirm it.
        """
        self._closed = True
        self._search.close()
        session, self._session = self._session, None
        self._ledger.close()
        if session is not None:
            session.close()

    # --- for who wants to know more --------------------------------------------------------------

    @property
    def session(self) -> Session:
        """The connection.

        Raises:
            PortError: if there is none.
        """
        self._require_open()
        if self._session is None:
            lost = phrase("The bridge on {name} is lost.", name=self._name)
            raise PortError(lost, alarms.BRIDGE_LOST)
        return self._session

    def _require_open(self) -> None:
        if self._closed:
            raise PortError(phrase("The port is closed."))

    @property
    def status(self) -> Status:
        """The device's last word."""
        return self._picture.status

    @any_thread
    def unattended_s(self) -> float | None:
        """So long nobody has looked at the line; None: it is closed."""
        session = self._session
        if self._closed:
            return None
        return 0.0 if session is None else (self._clock.now_ns() - session.looked_ns) / _NS_PER_S

    @any_thread
    def sign_of_life(self) -> None:
        """Tell a device that would switch off that this program is not dead.

        Raises:
            PortError: if the line is gone.
        """
        session = self._session
        if session is not None and self._picture.status.state & (
            c.State.MOVING | c.State.ENERGISED
        ):
            session.sign_of_life()

    # --- a run -----------------------------------------------------------------------------------

    def _see_to_start(self, session: Session) -> None:
        """Play what waits, if nothing plays; the ring is filled first, as far as it goes."""
        picture, link = self._picture, session.link
        is_held = picture.status.state & c.State.HELD
        if not picture.stands or not picture.runs or is_held or self._stopping:
            return
        session.pump_until(lambda: link.is_quiet)
        # Refused only if the queue was dropped meanwhile, which the look shows.
        ticket = link.command(c.KIND_START, bytes((link.epoch,)))
        session.pump_until(lambda: link.done >= ticket)
        self._look(session)

    def _look(self, session: Session) -> None:
        """A fresh STATUS, and what must follow from it."""
        if self._override_q8 != self._override_sent_q8:
            self._override_sent_q8 = self._override_q8
            session.command(c.KIND_OVERRIDE, self._override_sent_q8.to_bytes(2, "little"))
        session.ask()
        self._confirm_shouts(session)
        if self._stopping and self._picture.stands:
            self._stopping = False
            if self._picture.account.queued:
                # It was still on its way, or here, when the device stopped.
                self._drop(session, Ended.STOP)

    def _confirm_shouts(self, session: Session) -> None:
        """Wait until the device has counted what was shouted."""
        wants = session.link.wants
        session.ask_until(lambda: not (wants(c.URGENT_BRAKE) or wants(c.URGENT_STOP)))

    def _drop(self, session: Session, ended: Ended) -> None:
        """Drop the queue of a device that stands, and what never got there."""
        session.link.drop_stream()
        session.command(c.KIND_FLUSH)
        session.ask()
        self._picture.account.settle(self._picture.status)
        self._outbox.restart()
        self._picture.ended = ended

    def _watch(self, session: Session, seconds: float) -> None:
        """Feed the device and listen, until the time is up or the motors stand."""
        until_ns = self._clock.now_ns() + round(seconds * _NS_PER_S)
        while self._picture.runs and (left_s := self._left_s(until_ns)) > 0:
            session.pump(left_s)

    def _left_s(self, until_ns: int) -> float:
        return (until_ns - self._clock.now_ns()) / _NS_PER_S

    def _require_standstill(self, session: Session, what: str) -> None:
        self._look(session)
        if not self._picture.stands:
            raise only_at_standstill(what)

    def _shout(self, byte: int) -> None:
        session = self._session
        if session is not None:
            # If the line is lost, the next poll says so.
            with suppress(PortError):
                session.shout(byte)

    def _hear(self, session: Session, status: Status) -> None:
        """Every STATUS comes by here.

        Raises:
            PortError: if it says what cannot be: whoever does so is not believed the rest either.
        """
        if what := self._picture.account.contradiction(status):
            said = phrase(
                "The bridge on {name} says what cannot be ({what})", name=self._name, what=what
            )
            raise PortError(said, alarms.BRIDGE_STUCK)
        dropped = status.ack.epoch != session.link.epoch
        if dropped:
            session.link.epoch = status.ack.epoch
            session.link.drop_stream()
            self._outbox.restart()
        self._picture.hear(status, self._clock.now_ns(), dropped=dropped)
        if self._picture.stands and not self._picture.account.queued:
            self._outbox.forget_horizon()

    # --- lives -----------------------------------------------------------------------------------

    @contextmanager
    def _guarded(self) -> Iterator[Session]:
        """Whatever goes wrong with the line within this ends the session."""
        session = self.session
        try:
            yield session
        except PortError as error:
            session.hang_up()
            self._session = None
            where = self._picture.position()
            low_steps, high_steps = zip(*self._picture.account.bounds(), strict=True)
            bounds = {"low_steps": low_steps, "high_steps": high_steps}
            raise PortError(
                joined("", (str(error).rstrip("."), "; ", where, ".")),
                error.kind,
                **error.facts,
                **bounds,
            ) from error

    def _connecting_again(self) -> Steps[None]:
        self._picture.lose()
        return self._connecting(again=True)

    def _connecting(self, *, again: bool) -> Steps[None]:
        """A session, with all that it needs here.

        Raises:
            PortError: if the device is not there, or cannot play this card.
        """
        override_q8 = self._override_q8
        session = yield from self._connection.opening(
            self._card.phases(), self._mode, override_q8, again=again
        )
        try:
            self._override_sent_q8 = override_q8
            self._open_ledger(session)
            lamp = self._connection.facts.lamp
            self._outbox = Outbox(session.link, session.hello.ring, has_lamp=lamp is not None)
            self._picture.begin((yield from session.asking()), session.link)
            session.listener = partial(self._hear, session)
            yield from session.asking()
        except BaseException:
            session.hang_up()
            raise
        self._stopping = False
        self._session = session

    def _open_ledger(self, session: Session) -> None:
        table, counts = self._connection.facts.table, self._picture.account.counts.position
        self._ledger.begin(session.number, len(table), counts, self._card.phases())
