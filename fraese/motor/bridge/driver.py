r"""The driver whose steps are timed by a microcontroller at the end of a serial line.

    push --> Account, Horizon --> record --> Session ---line---> ring --> steps
    brake, stop ----------------- urgent bytes, from any thread ---> within a tick
    poll --> PING, STATUS? -----> Session <--line--- STATUS --> Account --> Report

Rule 1: as ``MotorCore``: a run begins in ``poll``, and a report knows of everything before it.
Rule 2: blocks that were pushed before it was known that the queue had been dropped are dropped.
Rule 3: whoever calls nothing for ``silence_s`` while the motors run, or are energised, is taken for
        hung: the device brakes, drops the queue and switches off.
Rule 4: a line that is lost, or a device that was reset, is told of once, as a PortError with the
        bounds between which the motors must be. The next ``poll`` tries to find the device again,
        once a second. Counts then go on from what was known last, and all motors are torn until
        something moves.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Final

from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.errors import PortError, StateError
from fraese.motor.blockqueue import require_sound
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.account import Account, Counts
from fraese.motor.bridge.cards import CardFacts
from fraese.motor.bridge.codec import Hello, Status
from fraese.motor.bridge.fromcard import card_facts
from fraese.motor.bridge.line import OpenLine
from fraese.motor.bridge.outbox import Outbox
from fraese.motor.bridge.session import PATIENCE_S, Session
from fraese.motor.seams import Card, Clock, Ended, IdleLevel, Report, SwitchMode
from fraese.motor.switches import SwitchInput

#: A poll asks for its last report so long before its time is up: an answer takes 4 ms.
_ANSWER_S: Final = 0.004
#: Between two reports while a run is watched.
_LOOK_S: Final = 0.01
#: Between two attempts to find a lost device again, s.
_REVIVE_S: Final = 1.0
#: What a block costs in the ring, as an estimate for ``Report.free``.
_TYPICAL_BYTES: Final = 24
_NS_PER_S: Final = 1_000_000_000
_MODES: Final = {SwitchMode.STOP: b"\x00", SwitchMode.IGNORE: b"\x01"}
_LEVELS: Final = {IdleLevel.OFF: b"\x00", IdleLevel.HOLD: b"\x01"}


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
        name: of the line, for sentences.
        baud: its rate, likewise.
        patience_s: so long is a greeting repeated.

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
    ) -> None:
        self._open_line = open_line
        self._card = card
        self._clock = clock
        self._facts: CardFacts = card_facts(
            card,
            switch,
            settle_cycles=round(settle_s * CYCLES_PER_S),
            safe_outputs=safe_outputs,
            silence_ms=round(silence_s * 1000),
        )
        self._capacity = capacity
        self._name = name
        self._baud = baud
        self._patience_s = patience_s
        self._mode = SwitchMode.STOP
        self._override_q8 = self._override_sent_q8 = Q8
        self._base_phases = card.phases()
        self._account = Account(card.motors)
        self._was_torn = False
        self._stopping = False
        self._late_ticks = self._dry_queues = 0
        self._status: Status
        self._status_ns = 0
        self._revive_at_ns = 0
        self._closed = False
        self._session: Session | None = None
        self._connect()

    # --- facts -----------------------------------------------------------------------------------

    @property
    def hello(self) -> Hello:
        """What the device says of itself.

        Raises:
            PortError: if it is lost.
        """
        return self._live().hello

    @property
    def session(self) -> Session:
        """The connection, for who tests it.

        Raises:
            PortError: if it is lost.
        """
        return self._live()

    @property
    def status(self) -> Status:
        """The device's last word."""
        return self._status

    # --- the seam --------------------------------------------------------------------------------

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken.

        Raises:
            ValueError: if it cannot be played as it says, or never fits the device.
            PortError: if the device is lost.
        """
        session = self._live()
        require_sound(block, self._card.motors)
        if self._account.queued >= self._capacity or self._outbox.is_full:
            return False
        data = self._outbox.record(block, self._account.pushed + 1)
        self._account.push(block)
        session.link.stream(data)
        return True

    def poll(self, budget_s: float) -> Report:
        """Let it play for at most that long, and say where things stand.

        Raises:
            PortError: if the device was lost since the last call, or is not there yet.
        """
        until_ns = self._clock.now_ns() + round(budget_s * _NS_PER_S)
        if self._session is None:
            self._revive()
        with self._guarded() as session:
            self._look(session)
            self._see_to_start(session)
            while self._runs and (left_s := self._left_s(until_ns) - _ANSWER_S) > 0:
                self._pump_for(session, min(left_s, _LOOK_S))
                self._look(session)
                self._see_to_start(session)
        return self._report()

    def brake(self) -> None:
        """Close the throttle; the queue stays. From any thread."""
        self._wish(c.URGENT_BRAKE)

    def stop(self) -> None:
        """Finish the tick in hand, drop the rest. From any thread."""
        self._stopping = True
        self._wish(c.URGENT_STOP)

    def set_override(self, factor: float) -> None:
        """Play what was planned with a higher feed override no faster. From any thread."""
        self._override_q8 = round(factor * Q8)

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        with self._guarded() as session:
            self._settle_wishes(session)
            session.command(c.KIND_RESUME)

    def flush(self) -> None:
        """Drop the queue at standstill, and open the throttle for what comes next.

        Raises:
            StateError: while steps are being made.
            PortError: if the device is lost.
        """
        with self._guarded() as session:
            self._require_standstill(session, "the queue can only be dropped")
            self._drop(session)
            self._ended = Ended.FLUSH

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
            PortError: if the device is lost.
        """
        with self._guarded() as session:
            self._require_standstill(session, "the motors can only be switched off")
            session.command(c.KIND_IDLE, _LEVELS[level])

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        with self._guarded() as session:
            session.command(c.KIND_OUTPUTS, bytes((mask & 0x0F, value & 0x0F)))

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""
        self._mode = mode
        with self._guarded() as session:
            session.command(c.KIND_MODE, _MODES[mode])

    def close(self) -> None:
        """Motors and outputs off, line given back. Safe to call twice.

        Raises:
            PortError: if the device did not confirm it.
        """
        self._closed = True
        session, self._session = self._session, None
        if session is not None:
            session.close()

    # --- a run -----------------------------------------------------------------------------------

    @property
    def _stands(self) -> bool:
        return not self._status.state & c.State.MOVING

    @property
    def _runs(self) -> bool:
        """Steps are being made, or will be as soon as the device is told to."""
        if self._status.state & c.State.HELD:
            return False
        return self._account.queued > 0 or not self._stands

    def _see_to_start(self, session: Session) -> None:
        """Play what waits, if nothing plays; the ring is filled first, as far as it goes."""
        if not self._stands or not self._runs or self._stopping:
            return
        session.pump_until(lambda: session.link.is_quiet)
        epoch = session.link.epoch
        ticket = session.link.command(c.KIND_START, bytes((epoch,)))
        session.pump_until(lambda: session.link.done >= ticket)
        self._look(session)

    def _look(self, session: Session) -> None:
        """A fresh STATUS, and what must follow from it."""
        if self._override_q8 != self._override_sent_q8:
            self._send_override(session)
        session.ask()
        self._settle_wishes(session)
        if self._stopping and self._stands:
            self._end_stop(session)

    def _settle_wishes(self, session: Session) -> None:
        """Wait until the device has counted what was shouted."""
        link = session.link
        while link.wants(c.URGENT_BRAKE) or link.wants(c.URGENT_STOP):
            link.ask()
            session.pump(_ANSWER_S)

    def _end_stop(self, session: Session) -> None:
        """The device has stopped. What was still on its way, or here, must not be played."""
        self._stopping = False
        if self._account.queued:
            self._drop(session)
            self._ended = Ended.STOP

    def _drop(self, session: Session) -> None:
        """Drop the queue of a device that stands, and what never got there."""
        session.link.drop_stream()
        session.command(c.KIND_FLUSH)
        session.ask()
        self._account.settle(self._status)
        self._outbox.restart()

    def _pump_for(self, session: Session, seconds: float) -> None:
        until_ns = self._clock.now_ns() + round(seconds * _NS_PER_S)
        while (left_s := self._left_s(until_ns)) > 0 and self._runs:
            session.pump(left_s)

    def _left_s(self, until_ns: int) -> float:
        return (until_ns - self._clock.now_ns()) / _NS_PER_S

    def _require_standstill(self, session: Session, what: str) -> None:
        self._look(session)
        if not self._stands:
            raise StateError(f"The motors run: {what} at standstill; brake or stop first.")

    def _wish(self, byte: int) -> None:
        session = self._session
        if session is not None:
            # If the line is lost, the next poll says so.
            with suppress(PortError):
                session.wish(byte)

    def _send_override(self, session: Session) -> None:
        self._override_sent_q8 = self._override_q8
        session.command(c.KIND_OVERRIDE, self._override_sent_q8.to_bytes(2, "little"))

    # --- what the device says --------------------------------------------------------------------

    def _hear(self, status: Status) -> None:
        """Every STATUS comes by here."""
        session = self._session
        assert session is not None
        before, self._status = self._status, status
        self._status_ns = self._clock.now_ns()
        self._late_ticks += (status.late_ticks - before.late_ticks) & 0xFFFF
        self._dry_queues += (status.dry_queues - before.dry_queues) & 0xFF
        dropped = status.ack.epoch != session.link.epoch
        if dropped:
            session.link.epoch = status.ack.epoch
            session.link.drop_stream()
            self._outbox.restart()
        self._account.see(status, dropped=dropped)
        if status.ended != before.ended:
            self._ended = c.ended_of(status.ended)
        if status.state & c.State.MOVING:
            self._was_torn = False
        elif not self._account.queued:
            self._outbox.forget_horizon()

    def _report(self) -> Report:
        account, status = self._account, self._status
        every = frozenset(range(self._card.motors))
        queued = account.queued
        moving = not self._stands and status.interval_cycles > 0
        interval_ns = status.interval_cycles * _NS_PER_S // CYCLES_PER_S
        return Report(
            position_steps=account.counts.position,
            travelled_steps=account.counts.travelled,
            playing=account.playing,
            tag=account.tag,
            tick=account.tick,
            free=max(0, min(self._capacity - queued, self._outbox.room // _TYPICAL_BYTES)),
            queued=queued,
            due_ns=self._status_ns + interval_ns if moving else 0,
            rate_hz=CYCLES_PER_S / status.interval_cycles if moving and account.moves else 0.0,
            running=self._runs,
            held=bool(status.state & c.State.HELD),
            energised=bool(status.state & c.State.ENERGISED),
            inputs=status.inputs,
            switch_closed=bool(status.state & c.State.SWITCH),
            candidates=account.candidates,
            latched_steps=account.latched_steps,
            ended=self._ended,
            torn=every if self._was_torn else account.torn,
            late_ticks=self._late_ticks,
            dry_queues=self._dry_queues,
            phases=self._phases(),
        )

    def _phases(self) -> tuple[int, ...]:
        if self._facts.table:
            return self._status.phases[: self._card.motors]
        counts = self._account.counts.position
        return tuple(a + b for a, b in zip(self._base_phases, counts, strict=True))

    # --- lives -----------------------------------------------------------------------------------

    def _live(self) -> Session:
        if self._closed:
            raise PortError("The port is closed.")
        if self._session is None:
            raise PortError(f"The bridge on {self._name} is lost.")
        return self._session

    @contextmanager
    def _guarded(self) -> Iterator[Session]:
        """Whatever goes wrong with the line within this ends the session."""
        session = self._live()
        try:
            yield session
        except PortError as error:
            raise self._lost(session, error) from error

    def _lost(self, session: Session, error: PortError) -> PortError:
        session.hang_up()
        self._session = None
        return PortError(f"{str(error).rstrip('.')}; {self._whereabouts()}")

    def _whereabouts(self) -> str:
        bounds = self._account.bounds()
        if not self._runs or all(low == high for low, high in bounds):
            return "the motors stood; reference them before relying on their position."
        ranges = ", ".join(
            f"motor {motor + 1} between {low} and {high} steps" if low != high else
            f"motor {motor + 1} at {low}"
            for motor, (low, high) in enumerate(bounds)
        )
        return f"{ranges} since the start: the bridge brakes and switches off by itself."

    def _revive(self) -> None:
        """Find the device again; counts go on, but nobody knows what they are worth."""
        self._live_or_lost()
        now_ns = self._clock.now_ns()
        if now_ns < self._revive_at_ns:
            raise PortError(f"The bridge on {self._name} is lost; it is tried again in a moment.")
        self._revive_at_ns = now_ns + round(_REVIVE_S * _NS_PER_S)
        self._card.set_phases(self._phases())
        self._base_phases = self._card.phases()
        last = self._account
        self._account = Account(self._card.motors, last.pushed, last.counts)
        self._was_torn = True
        self._connect()

    def _live_or_lost(self) -> None:
        if self._closed:
            raise PortError("The port is closed.")

    def _connect(self) -> None:
        """Greet the device and tell it everything.

        Raises:
            PortError: if it is not there, or cannot play this card.
        """
        session = Session(self._open_line(), self._clock, self._name, self._baud, self._patience_s)
        self._require_able(session)
        self._session = session
        self._outbox = Outbox(session.link, session.hello.ring)
        try:
            session.upload(self._facts)
            phases = [phase & 0xFF for phase in self._card.phases()] + [0] * c.MOTORS_MAX
            session.command(c.KIND_PHASES, bytes(phases[: c.MOTORS_MAX]))
            session.command(c.KIND_MODE, _MODES[self._mode])
            self._send_override(session)
            self._status = session.ask()
            self._ended = c.ended_of(self._status.ended)
            session.listener = self._hear
            session.ask()
        except PortError:
            session.hang_up()
            self._session = None
            raise
        self._stopping = False

    def _require_able(self, session: Session) -> None:
        hello, facts = session.hello, self._facts
        able = hello.phase_cards if facts.kind == c.CARD_PHASES else hello.clock_cards
        fits = facts.motors <= hello.motors and len(facts.table) <= hello.table_max
        if not able or not fits:
            session.hang_up()
            raise PortError(
                f"The bridge on {self._name} ({hello.board}, firmware"
                f" {hello.firmware[0]}.{hello.firmware[1]}) cannot play this card: it drives"
                f" {hello.motors} motors with tables of {hello.table_max} entries."
            )
