"""What a reading of the inputs leads to: the reactions to a watch and to an end switch.

    status --> InputWatcher --> fulfilled watch --> stop, or brake and drop, or brake and hold
                            '-> contact         --> stop

Rule 1: a reading never acts at once. It asks for a stop or a brake, and the tick in hand is
        finished first.
Rule 2: a watch that ends the run brakes above the start/stop rate and stops dead at or below it.
        While the motors brake for it, the end switches do not act: the watch has seen it already.
Rule 3: an end switch acts in stop mode, and unless the block in hand watches that input itself.
"""

from fraese.blocks import Block, WatchAction
from fraese.motor.requests import Requests
from fraese.motor.seams import Clock, Ended, SwitchMode
from fraese.motor.switches import InputWatcher
from fraese.motor.track import Track


class Reactions:
    """Turns readings into requests.

    Attributes:
        mode: what an end switch does to blocks that do not watch it.
    """

    def __init__(
        self, inputs: InputWatcher, track: Track, requests: Requests, clock: Clock
    ) -> None:
        self._inputs = inputs
        self._track = track
        self._requests = requests
        self._clock = clock
        self.mode = SwitchMode.STOP

    def begin(self, block: Block) -> None:
        """A block starts; a contact that is there already acts on it too."""
        self._inputs.begin(block)
        self._act_on_switch()

    def end(self) -> None:
        """The block ended, and its watch with it."""
        self._inputs.end(self._clock.now_ns())

    def examine(self, status: int, motor: int) -> None:
        """Take a reading that is not quiet, made after ``motor`` had made its step."""
        fulfilled = self._inputs.take(
            status, lambda: self._track.position_steps(motor), self._clock.now_ns()
        )
        if fulfilled:
            self._act_on_watch()
        self._act_on_switch()

    def _act_on_watch(self) -> None:
        cursor = self._track.cursor
        if cursor is None or cursor.block.watch is None:
            return
        action = cursor.block.watch.action
        if action is WatchAction.IGNORE:
            return
        if action is WatchAction.STOP:
            self._requests.drop_when_still = True
            if not self._track.is_above_jump(cursor):
                self._requests.stop_for(Ended.WATCH)
                return
        self._requests.brake()

    def _act_on_switch(self) -> None:
        acts = self._inputs.switch_acts and self.mode is SwitchMode.STOP
        if acts and self._track.cursor and not self._requests.drop_when_still:
            self._requests.stop_for(Ended.SWITCH)
