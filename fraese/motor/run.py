"""The life of a run: start, block after block, hold, finish, standstill.

        push           last block played, stop, watch, switch
    still ---> running ------------------------------------> still
                 |  ^                                          ^
           brake |  | resume                                   |
                 v  |                stop, flush               |
                 held -----------------------------------------'

Rule 1: a run begins with current in the coils, the inputs known, and then time.
Rule 2: it ends in one place, whatever for: the queue is dropped, the block in hand counted as far
        as it came, the lines put to rest, and the reason kept.
Rule 3: held is standing with a queue: lines at rest, the block in hand kept with its Bresenham
        state, so that the steps after it are the same as without it.
"""

from typing import Final

from fraese.motor.blockqueue import BlockQueue
from fraese.motor.cursor import Cursor
from fraese.motor.governor import Governor
from fraese.motor.pulses import Pulses
from fraese.motor.reactions import Reactions
from fraese.motor.requests import Requests
from fraese.motor.seams import Card, Clock, Ended, Port, only_at_standstill
from fraese.motor.switches import InputWatcher, SwitchInput
from fraese.motor.ticks import Ticks
from fraese.motor.track import Track
from fraese.motor.wires import Wires

_NS_PER_S: Final = 1_000_000_000


class Run:
    """Plays a queue from standstill to standstill.

    The arguments are those of ``MotorCore``.

    Attributes:
        requests: what is wanted.
        queue: what waits.
        track: what was done.
        inputs: what the status register says.
        reactions: what that leads to.
        wires: the card on its port.
        governor: how fast.
        ticks: when.
        standing: no time runs.
        ended: why.
    """

    def __init__(
        self,
        port: Port,
        card: Card,
        clock: Clock,
        switch: SwitchInput,
        settle_s: float,
        capacity: int,
        safe_outputs: int,
    ) -> None:
        self._clock = clock
        self._settle_ns = round(settle_s * _NS_PER_S)
        self._readings = switch.readings
        self.requests = Requests()
        self.queue = BlockQueue(card.motors, capacity)
        self.track = Track(card.motors)
        self.inputs = InputWatcher(card.motors, switch)
        self.reactions = Reactions(self.inputs, self.track, self.requests, clock)
        self.wires = Wires(port, card, self.inputs, self.reactions, safe_outputs)
        self.governor = Governor(self.requests, self.queue, self.track, self.wires)
        ticks = Pulses if card.fall else Ticks
        self.ticks = ticks(clock, card, self.wires, self.track, self.governor, self.requests)
        self.standing = True
        self.ended = Ended.NOT

    @property
    def may_play(self) -> bool:
        """There is something to play, and nothing holds it."""
        return not self.governor.held and (self.track.cursor is not None or bool(self.queue))

    def poll(self, budget_s: float) -> None:
        """Act on what is wanted, then play for at most that long."""
        if self.standing:
            self.governor.hold_if_wanted()
        if self.requests.stop_wanted and not self.ticks.in_mid_tick:
            self.finish(self.requests.stop_reason)
        elif self.may_play:
            self._play(self._clock.now_ns() + round(budget_s * _NS_PER_S))
        else:
            self.wires.sample()

    def require_standstill(self, what: str) -> None:
        """Refuse while steps are being made.

        Raises:
            StateError: with what can only be done at standstill.
        """
        if not self.standing:
            raise only_at_standstill(what)

    def finish(self, ended: Ended) -> None:
        """The run is over: drop what is left, tell the card, say why."""
        self.queue.drop()
        if self.track.cursor is not None:
            self._end_block(self.track.cursor)
        if ended is not Ended.TARGET:
            self.wires.forget_safe_outputs()
        self._rest()
        self.governor.finish(ended)
        self.requests.acted(ended)
        self.ended = ended

    def _play(self, end_ns: int) -> None:
        if self.standing:
            self._start()
        while (cursor := self.track.cursor or self._next_block()) is not None:
            if not self.ticks.play(cursor, end_ns):
                self._act()
                return
            self._end_block(cursor)

    def _start(self) -> None:
        """From standstill: current on, the input known, and time starts now."""
        if not self.wires.energised:
            self.wires.energise()
            self._clock.wait_until(self._clock.now_ns() + self._settle_ns)
        for _ in range(self._readings):
            self.wires.sample()
        self.wires.signal_run()
        self.standing = False
        self.ticks.start()
        self.track.start()
        self.ended = Ended.NOT

    def _next_block(self) -> Cursor | None:
        block = self.queue.take()
        if block is None:
            self.finish(Ended.WATCH if self.requests.drop_when_still else Ended.TARGET)
            return None
        cursor = self.track.begin(block)
        self.governor.enter(cursor)
        self.reactions.begin(block)
        return cursor

    def _act(self) -> None:
        """The block is not done: was that for a reason, or is only the time up?"""
        if self.ticks.in_mid_tick:
            return
        if self.requests.stop_wanted:
            self.finish(self.requests.stop_reason)
        elif self.governor.held and self.requests.drop_when_still:
            self.finish(Ended.WATCH)
        elif self.governor.held:
            self._rest()

    def _end_block(self, cursor: Cursor) -> None:
        if cursor.outputs and cursor.done == cursor.ticks:
            # A block without any tick.
            self.wires.set_outputs(*cursor.outputs)
        self.track.end(nothing_follows=not self.queue)
        self.reactions.end()
        self.governor.leave(cursor)

    def _rest(self) -> None:
        """Clock lines low, ACTIVE and BOOST low, outputs that must be safe off; no time runs."""
        self.ticks.rest()
        self.wires.signal_rest()
        self.governor.rest()
        self.track.rest()
        self.standing = True
