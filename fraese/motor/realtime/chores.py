"""What the child does between two ticks: take wishes, blocks and commands, report, look around.

    one round:  blocks - command - host - pump - report - (nothing more to do)
                every dash: back to the clock, which may have a tick to play

Rule 1: between two dashes a few microseconds, no more: the clock begins a chore only with room. One
        that takes longer says so before it, in ``room_ns``.
Rule 2: a question is answered when all that was asked for before it has been taken up. A stop must
        have been acted on, so a report after it says so.
Rule 3: a block whose maker did not know that the run had ended is dropped, as the rest of its queue
        was. Nothing is taken from the ring while a run is ending.
Rule 4: a host that is dead or silent while the motors run: brake. The player does the rest. Silent
        while they stand under full current, in the middle of a job: off, too.
Rule 5: a lease that is over is another reason to brake: where the motors are would not be on the
        disk. When it is put off they go on, unless the host wants them to be braked.
"""

from collections.abc import Callable, Iterator
from typing import Final

from fraese.errors import StateError
from fraese.motor.core import MotorCore
from fraese.motor.realtime import mailbox
from fraese.motor.realtime.clock import ROOM_NS, RealtimeClock
from fraese.motor.realtime.hostline import HostLine
from fraese.motor.realtime.memory import (
    ANSWER,
    ASKED,
    BRAKES,
    COMMAND,
    COMMAND_A,
    COMMAND_B,
    COMMAND_KIND,
    HEARTBEAT,
    LEASE,
    OVERRIDE,
    PLACE,
    RESULT,
    RING_HEAD,
    RING_TAIL,
    STOPS,
    WISHES,
    Memory,
)
from fraese.motor.realtime.place import DONE_BITS
from fraese.motor.realtime.records import Decoder
from fraese.motor.realtime.report import Reporter
from fraese.motor.realtime.ring import RingReader
from fraese.motor.realtime.setup import RealtimeOptions
from fraese.motor.seams import only_at_standstill

#: Room for a change of outputs, ns: a phase card may have to write a table of movements for it.
_OUTPUTS_NS: Final = 100_000
#: A report is written at least so often where there is time, ns.
_REPORT_NS: Final = 2_000_000
#: The host is looked for so often, ns.
_HOST_NS: Final = 10_000_000
#: Braking for a lost host takes no longer, ns: then it is stopped.
_BRAKE_LIMIT_NS: Final = 5_000_000_000
_NS_PER_S: Final = 1_000_000_000
ALL_OUTPUTS: Final = 0xFFFF_FFFF
_NEVER: Final = -1


class Chores:
    """The attendant of the child's clock.

    Attributes:
        reporter: writes the reports.
        playing: the core is being polled, and may be making steps.
        leaving: the child is to end when the motors stand.
        silent: the host was silent while the motors ran.
        room_ns: time that the next chore may need.
        chore: does the next small piece of work; False: there is nothing to do just now.
    """

    def __init__(
        self,
        core: MotorCore,
        clock: RealtimeClock,
        memory: Memory,
        host: HostLine,
        options: RealtimeOptions,
    ) -> None:
        self._core = core
        self._run = core.run
        self._requests = core.run.requests
        self._clock = clock
        self._now_ns = clock.now_ns
        self._memory = memory
        self._words = memory.words
        self._host = host
        self._silent_ns = round(options.silent_s * _NS_PER_S)
        self._pump = options.pump
        self._ring = RingReader(memory.words, memory.ring)
        self._decoder = Decoder()
        self.reporter = Reporter(core, memory)
        self.playing = False
        self.leaving = False
        self.silent = False
        self._braking_since_ns = 0
        # The host has braked, or there is no lease any more.
        self._host_brakes = self._lapsed = False
        self._urgent = False
        self._wishes = self._stops = self._brakes = self._override = 0
        self._command = 0
        self._report_at_ns = self._host_at_ns = self._pump_at_ns = 0
        self._pump_is_high = False
        self.room_ns = ROOM_NS
        self.chore: Callable[[], bool] = self._rounds().__next__

    # --- wishes --------------------------------------------------------------------------------

    def has_wish(self) -> bool:
        """Something is wished for that was not taken up yet; where the motors are is noted."""
        cursor = self._run.track.cursor
        if cursor is not None:
            self._words[PLACE] = self._run.queue.serial << DONE_BITS | cursor.done
        return bool(self._words[WISHES] != self._wishes)

    def take_wishes(self) -> bool:
        """Pass them on to the core; True: a long wait may be broken off for it."""
        words = self._words
        self._wishes = words[WISHES]
        urgent, self._urgent = self._urgent, False
        if words[STOPS] != self._stops:
            self._stops = words[STOPS]
            self._core.stop()
            urgent = True
        if words[BRAKES] != self._brakes:
            self._brakes = words[BRAKES]
            self._host_brakes, self._lapsed = True, False
            self._core.brake()
            urgent = True
        if words[OVERRIDE] != self._override:
            self._override = words[OVERRIDE]
            self._requests.override(self._override)
        return urgent and self._is_within_a_block()

    def _is_within_a_block(self) -> bool:
        """Only there the core may be interrupted: at its edges it is half in, half out."""
        run = self._run
        return not run.standing and run.track.cursor is not None and not run.governor.held

    def brake(self) -> None:
        """Brake, for a reason of the child's own."""
        self._braking_since_ns = self._braking_since_ns or self._now_ns()
        self._core.brake()
        self._be_urgent()

    def _stop(self) -> None:
        self._core.stop()
        self._be_urgent()

    def _be_urgent(self) -> None:
        self._urgent = True
        self._wishes = _NEVER

    def leave(self) -> None:
        """Brake, and end when the motors stand."""
        if not self.leaving:
            self.leaving = True
            self.brake()

    # --- rounds --------------------------------------------------------------------------------

    def round(self) -> None:
        """Everything there is to do, at once: the motors stand."""
        while self.chore():
            pass

    def _rounds(self) -> Iterator[bool]:
        words, reporter = self._words, self.reporter
        while True:
            # A wish that was there before the question is taken up before its answer.
            asked = words[ASKED]
            busy = False
            while words[RING_HEAD] != words[RING_TAIL] and not self._is_dropping():
                busy = True
                for _ in self._take_block():
                    yield True
                yield True
            if words[COMMAND] != self._command:
                yield self._needs(_OUTPUTS_NS if words[COMMAND_KIND] == mailbox.OUTPUTS else 0)
                busy |= self._obey()
                yield self._needs(0)
            now_ns = self._now_ns()
            if now_ns >= self._host_at_ns:
                self._look_for_host(now_ns)
                yield True
            if self._pump and now_ns >= self._pump_at_ns:
                yield self._needs(_OUTPUTS_NS)
                self._toggle(now_ns)
                yield self._needs(0)
            if self.playing:
                echo = max(asked, reporter.echo) if self._may_answer() else reporter.echo
                if echo != reporter.echo or now_ns >= self._report_at_ns:
                    busy = True
                    self._report_at_ns = now_ns + _REPORT_NS
                    for _ in reporter.steps(echo, self._clock.deadline_ns):
                        yield True
            yield busy

    def _needs(self, ns: int) -> bool:
        """The next chore may need so much time; True: there is more to do."""
        self.room_ns = max(ROOM_NS, ns)
        return True

    def _is_dropping(self) -> bool:
        """A run is ending: what waits is not taken, since it could be dropped or not."""
        requests = self._requests
        return self.playing and (requests.stop_wanted or requests.drop_when_still)

    def _may_answer(self) -> bool:
        """All that came before the question was taken up."""
        if self._is_dropping() or self.has_wish():
            return False
        return bool(self._words[RING_HEAD] == self._words[RING_TAIL])

    # --- blocks --------------------------------------------------------------------------------

    def _take_block(self) -> Iterator[None]:
        decoder, ring = self._decoder, self._ring
        yield from decoder.steps(self._memory.ring, ring.first())
        block = decoder.block
        assert block is not None
        yield
        if self._is_dropping():
            return
        if decoder.generation == self.reporter.generation:
            self._core.accept(block, decoder.dry_point)
        else:
            self._run.queue.serial += 1
        ring.drop_first()

    # --- commands ------------------------------------------------------------------------------

    def _obey(self) -> bool:
        """Do what the mailbox says; False: not now, but soon."""
        words = self._words
        number, kind = words[COMMAND], words[COMMAND_KIND]
        result = mailbox.DONE
        try:
            if kind in mailbox.AT_STANDSTILL and self.playing:
                if not self._run.may_play or self._requests.stop_wanted:
                    return False
                raise only_at_standstill(mailbox.AT_STANDSTILL[kind])
            self._do(kind, words[COMMAND_A], words[COMMAND_B])
        except StateError as error:
            self._memory.say(str(error))
            result = mailbox.REFUSED
        self._command = number
        words[RESULT] = result
        words[ANSWER] = number
        return True

    def _do(self, kind: int, a: int, b: int) -> None:
        core = self._core
        match kind:
            case mailbox.RESUME:
                self._host_brakes = self._lapsed = False
                core.resume()
            case mailbox.OUTPUTS:
                core.set_outputs(a & ALL_OUTPUTS, b & ALL_OUTPUTS)
            case mailbox.SWITCH_MODE:
                core.set_switch_mode(mailbox.SWITCH_MODES[a])
            case mailbox.FLUSH:
                self._host_brakes = self._lapsed = False
                core.flush()
            case mailbox.IDLE:
                core.idle(mailbox.IDLE_LEVELS[a])
            case mailbox.CLOSE:
                self.leaving = True
                self._stop()

    # --- the host, and who watches the child -----------------------------------------------------

    def _look_for_host(self, now_ns: int) -> None:
        self._host_at_ns = now_ns + _HOST_NS
        if self._host.look():
            self.leave()
        moves = not self._run.standing
        self._mind_the_lease(now_ns, moves=moves)
        live = moves or self._run.wires.energised
        if live and not self.silent and now_ns > self._words[HEARTBEAT] + self._silent_ns:
            self.silent = True
            if moves:
                self.brake()
        if moves and self._braking_since_ns:
            if now_ns > self._braking_since_ns + _BRAKE_LIMIT_NS:
                self._stop()
        else:
            self._braking_since_ns = 0

    def _mind_the_lease(self, now_ns: int, *, moves: bool) -> None:
        """See rule 5."""
        lease_ns = self._words[LEASE]
        is_over = 0 < lease_ns < now_ns
        if is_over and moves and not (self._lapsed or self._host_brakes or self.leaving):
            self._lapsed = True
            self._core.brake()
            self._be_urgent()
        elif self._lapsed and not is_over and not (self.leaving or self.silent):
            self._lapsed = False
            self._core.resume()

    def _toggle(self, now_ns: int) -> None:
        pump = self._pump
        assert pump is not None
        self._pump_at_ns = now_ns + round(_NS_PER_S / pump.rate_hz / 2)
        self._pump_is_high = not self._pump_is_high
        bit = 1 << pump.output
        self._core.set_outputs(bit, bit if self._pump_is_high else 0)
