"""What is known of the device: its last STATUS, all blocks, and the report that follows from them.

Rule 1: counts of the device that wrap round are added up here, over all sessions.
Rule 2: why the motors stand is the device's word, until the host knows better.
Rule 3: where a device was lost, all motors are torn until something moves again.
Rule 4: the device's interrupt closes the throttle; its main loop sees a moment later that the
        motors stand. A word from between says both HELD and MOVING, and is not the last one.
"""

from typing import Final

from fraese.blocks import CYCLES_PER_S
from fraese.motor.bridge.account import Account
from fraese.motor.bridge.codec import Status
from fraese.motor.bridge.constants import State, ended_of
from fraese.motor.bridge.ledger import Ledger
from fraese.motor.bridge.link import Link
from fraese.motor.seams import Card, Ended, Report
from fraese.phrases import joined, phrase

_NS_PER_S: Final = 1_000_000_000


class Picture:
    """The device as seen from here.

    Args:
        card: for its motors and phases.
        has_table: phases are the device's; else they are net pulses.
        ledger: is told of every block before it is sent.

    Attributes:
        account: blocks and counts of this session.
        status: the device's last word.
        ended: why the motors stand.
    """

    def __init__(self, card: Card, *, has_table: bool, ledger: Ledger) -> None:
        self._card = card
        self._has_table = has_table
        self._ledger = ledger
        self._base_phases = card.phases()
        self._is_torn = False
        self._late_ticks = self._dry_queues = 0
        self._edge_ns = 0
        self.account = Account(card.motors, ledger=ledger)
        self.status: Status
        self.ended = Ended.NOT

    # --- sessions --------------------------------------------------------------------------------

    def begin(self, status: Status, link: Link) -> None:
        """The first word of a session."""
        self.status = status
        self._link = link
        self.ended = ended_of(status.ended)

    def lose(self) -> None:
        """The device was lost: counts go on from the last ones, but nobody believes them."""
        self._card.set_phases(self.phases())
        self._base_phases = self._card.phases()
        last = self.account
        self.account = Account(
            self._card.motors, last.pushed, last.counts, last.finished, self._ledger
        )
        if not self._has_table:
            self._base_phases = tuple(
                a - b for a, b in zip(self._base_phases, last.counts.position, strict=True)
            )
        self._is_torn = True

    def hear(self, status: Status, now_ns: int, *, dropped: bool) -> None:
        """A STATUS.

        Args:
            status: the device's word.
            now_ns: when it came.
            dropped: its epoch is a new one.
        """
        before, self.status = self.status, status
        if status.place != before.place or bool(before.state & State.MOVING) == self.stands:
            self._edge_ns = now_ns
        self._late_ticks += (status.late_ticks - before.late_ticks) & 0xFFFF
        self._dry_queues += (status.dry_queues - before.dry_queues) & 0xFF
        self.account.see(status, dropped=dropped)
        if status.ended != before.ended:
            self.ended = ended_of(status.ended)
        if not self.stands:
            self._is_torn = False

    # --- facts -----------------------------------------------------------------------------------

    @property
    def stands(self) -> bool:
        """No time runs in the device."""
        return not self.status.state & State.MOVING

    @property
    def held(self) -> bool:
        """The throttle is closed, the motors stand, and no block that is on its way opens it."""
        dry = self.status.state & State.DRY and self._link.streams
        return bool(self.status.state & State.HELD) and self.stands and not dry

    @property
    def runs(self) -> bool:
        """Steps are being made, or will be as soon as the device is told to."""
        if self.held:
            return False
        return self.account.queued > 0 or not self.stands

    def phases(self) -> tuple[int, ...]:
        """Phase index of every motor; net pulses where drives keep their own."""
        if self._has_table:
            return self.status.phases[: self._card.motors]
        counts = self.account.counts.position
        return tuple(a + b for a, b in zip(self._base_phases, counts, strict=True))

    def report(self, capacity: int, room: int) -> Report:
        """All of it.

        Args:
            capacity: blocks that are taken at once,
            room: and an estimate for how many more there is room.
        """
        account, status, state = self.account, self.status, self.status.state
        every = frozenset(range(self._card.motors))
        cycles = 0 if self.stands else status.interval_cycles
        due_ns = self._edge_ns + min(cycles, account.longest_cycles) * _NS_PER_S // CYCLES_PER_S
        return Report(
            position_steps=account.counts.position,
            travelled_steps=account.counts.travelled,
            playing=account.playing,
            finished=account.finished,
            tag=account.tag,
            tick=account.tick,
            free=max(0, min(capacity - account.queued, room)),
            queued=account.queued,
            due_ns=due_ns if cycles else 0,
            rate_hz=CYCLES_PER_S / cycles if cycles and account.moves else 0.0,
            running=self.runs,
            held=self.held,
            energised=bool(state & State.ENERGISED),
            inputs=status.inputs,
            switch_closed=bool(state & State.SWITCH),
            candidates=account.candidates,
            latched_steps=account.latched_steps,
            ended=self.ended,
            torn=every if self._is_torn else account.torn,
            late_ticks=self._late_ticks,
            dry_queues=self._dry_queues,
            phases=self.phases(),
        )

    def position(self) -> str:
        """Where the motors must be, now that nobody tells any more; a part of a sentence."""
        bounds = self.account.bounds()
        if not self.runs or all(low == high for low, high in bounds):
            return phrase("the motors stood, but may lose their position without current")
        ranges = joined(
            ", ",
            (
                phrase("motor {motor} {low} to {high}", motor=motor, low=low, high=high)
                if low != high
                else phrase("motor {motor} {low}", motor=motor, low=low)
                for motor, (low, high) in enumerate(bounds, start=1)
            ),
        )
        return phrase(
            "the bridge brakes and switches off by itself, at steps {ranges}", ranges=ranges
        )
