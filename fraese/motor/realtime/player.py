"""The child's loop: from standstill to standstill, and between them.

    standing:  chores -- asked to play? --no--> read inputs, report, doze until it rings
                              | yes
    playing:   core.poll until the motors stand; chores in its waits

Rule 1: as with a core in one's own thread, a run begins in a ``poll`` of the host, never with a
        push: the first block of many must not be played alone.
Rule 2: the core is polled once for a whole run. The clock breaks it off where it must act sooner.
Rule 3: what ended otherwise than at its target makes a new generation: blocks that were pushed in
        ignorance of it are dropped.
"""

from typing import Final

from fraese.motor.core import MotorCore
from fraese.motor.realtime.chores import ALL_OUTPUTS, Chores
from fraese.motor.realtime.clock import Interrupted
from fraese.motor.realtime.hostline import HostLine
from fraese.motor.realtime.memory import ASKED, COMMAND, DOZING, RING_HEAD, WISHES
from fraese.motor.seams import Ended, IdleLevel

#: Longer than any run.
_A_RUN_S: Final = 1e9
#: At standstill inputs are read at least so often, s.
DOZE_S: Final = 0.01
_PLAYED_ON: Final = (Ended.NOT, Ended.TARGET)


class Player:
    """Plays what the host sends until it is to leave.

    Args:
        core: on the child's clock.
        chores: the clock's attendant.
        words: of the shared memory.
        host: the pipe.
        doze_s: longest sleep at standstill.
    """

    def __init__(
        self,
        core: MotorCore,
        chores: Chores,
        words: memoryview,
        host: HostLine,
        doze_s: float = DOZE_S,
    ) -> None:
        self._core = core
        self._run = core.run
        self._chores = chores
        self._words = words
        self._host = host
        self._doze_s = doze_s
        self._polled = 0

    def play(self) -> None:
        """Until the child is to leave, and the motors stand."""
        while not (self._chores.leaving and self._run.standing):
            self.turn()

    def turn(self) -> None:
        """Once round: what is wished for, a run or a look at the inputs, a report."""
        run, chores = self._run, self._chores
        seen = self._stirring()
        asked = chores.reporter.echo
        if run.standing:
            asked = self._words[ASKED]
            self._attend()
        plays = self._is_to_play(asked)
        if plays:
            asked = self._play(asked)
        else:
            run.wires.sample()
        if run.standing:
            self._finish_silence()
            chores.reporter.write(asked)
            # After a run there is what was left lying while it ended.
            if not plays and not chores.leaving:
                self._doze(seen)

    def _attend(self) -> None:
        if self._chores.has_wish():
            self._chores.take_wishes()
        self._chores.round()

    def _is_to_play(self, asked: int) -> bool:
        run = self._run
        wants = run.requests.stop_wanted or run.requests.brake_wanted
        return not run.standing or wants or (run.may_play and asked != self._polled)

    def _play(self, asked: int) -> int:
        """Poll the core until it returns; the last question that is answered by that."""
        run, chores = self._run, self._chores
        plays = run.may_play or run.requests.stop_wanted
        chores.playing = True
        try:
            run.poll(_A_RUN_S)
        except Interrupted:
            pass
        finally:
            chores.playing = False
        dropped = run.standing and not run.governor.held and run.ended not in _PLAYED_ON
        if plays and dropped:
            chores.reporter.generation += 1
        self._polled = max(asked, chores.reporter.echo)
        return self._polled

    def _finish_silence(self) -> None:
        """The host was silent: nothing more is played, motors and outputs are off."""
        if self._chores.silent:
            self._chores.silent = False
            self._run.finish(Ended.SILENCE)
            self._core.set_outputs(ALL_OUTPUTS, 0)
            self._core.idle(IdleLevel.OFF)
            self._chores.reporter.generation += 1

    def _stirring(self) -> tuple[int, ...]:
        words = self._words
        return words[ASKED], words[COMMAND], words[WISHES], words[RING_HEAD]

    def _doze(self, seen: tuple[int, ...]) -> None:
        self._words[DOZING] = 1
        if seen == self._stirring():
            self._host.doze(self._doze_s)
        self._words[DOZING] = 0
