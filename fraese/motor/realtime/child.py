"""The process that makes the steps: ``python -m fraese.motor.realtime.child FD SAMPLES``.

Started by the driver and by nobody else. It reads its set-up from its standard input, opens the
port itself, and says in the shared memory how far it came.

Rule 1: on every way out the motors are off and the port is given back: told to, host dead, signal,
        error. Only a ``kill -9`` is left to the host.
Rule 2: then it leaves its last words, if it was told where: a host that was killed is followed by
        one that can know the place to the step.
Rule 3: it is in a session of its own, so Ctrl-C in the terminal is none of its business.
"""

import contextlib
import pickle
import signal
import sys
from types import FrameType
from typing import Final

from fraese.errors import FraeseError
from fraese.motor.core import MotorCore
from fraese.motor.realtime.chores import Chores
from fraese.motor.realtime.clock import Nobody, RealtimeClock
from fraese.motor.realtime.hostline import HostLine
from fraese.motor.realtime.lastwords import LastWords, leave
from fraese.motor.realtime.memory import ENDED, FAILED, FAILED_LIVE, READY, STAGE, Memory
from fraese.motor.realtime.meter import MeteredPort
from fraese.motor.realtime.player import DOZE_S, Player
from fraese.motor.realtime.setup import Setup
from fraese.motor.realtime.system import prepare
from fraese.motor.seams import Ended, Port
from fraese.phrases import phrase

_SIGNALS: Final = (signal.SIGTERM, signal.SIGHUP)


def main(memory_fd: int, samples: int, host_fd: int = 0) -> int:
    """Play until told to leave.

    Returns:
        0, or 1 if something failed; the shared memory says what.
    """
    memory = Memory(memory_fd, samples)
    host = HostLine(host_fd)
    try:
        setup: Setup = pickle.loads(host.read_message())
        host.listen()
        clock = RealtimeClock()
        core = _core(setup, clock, memory)
    except BaseException as error:
        return _fail(memory, FAILED, error)
    failure: BaseException | None = None
    try:
        _play(setup, core, clock, memory, host)
    except BaseException as error:
        failure = error
    # What comes now is for the port alone.
    clock.attendant = Nobody()
    ended = core.run.ended
    try:
        core.close()
    except BaseException as error:
        return _fail(memory, FAILED_LIVE, failure or error)
    if failure is not None:
        return _fail(memory, FAILED, failure)
    _leave_words(setup, core, ended, durable=host.broken)
    memory.words[STAGE] = ENDED
    return 0


def _leave_words(setup: Setup, core: MotorCore, ended: Ended, *, durable: bool) -> None:
    """Nobody may be there any more to whom the last report could be of use.

    Args:
        setup: where to leave them.
        core: closed.
        ended: why the motors stood before that.
        durable: wait for the disk; a host that lives would have to wait too.
    """
    to, track = setup.last_words, core.run.track
    if to is None:
        return
    counts = track.position_steps()
    base = to.base_steps or (0,) * len(counts)
    # Where the last one was killed is known to a tick only; that is told before this one moves.
    is_unsure = bool(to.base_steps) and not any(track.travelled_steps())
    words = LastWords(
        token=to.token,
        position_steps=tuple(a + b for a, b in zip(base, counts, strict=True)),
        phases=tuple(core.card.phases()),
        torn=frozenset(range(len(counts))) if is_unsure else track.torn,
        ended=ended,
        # What the ones before it went is not known to the step.
        travelled_steps=() if to.base_steps else tuple(track.travelled_steps()),
    )
    # A disk that fails must not keep the process from ending.
    with contextlib.suppress(OSError):
        leave(to.fd, words, durable=durable)


def _core(setup: Setup, clock: RealtimeClock, memory: Memory) -> MotorCore:
    port: Port = setup.open_port()
    if setup.meter:
        port = MeteredPort(port, clock, memory, setup.meter)
    return MotorCore(
        port, setup.card, clock, setup.switch, setup.settle_s, setup.capacity, setup.safe_outputs
    )


def _play(
    setup: Setup, core: MotorCore, clock: RealtimeClock, memory: Memory, host: HostLine
) -> None:
    chores = Chores(core, clock, memory, host, setup.options)
    pump = setup.options.pump
    doze_s = min(DOZE_S, 0.5 / pump.rate_hz) if pump else DOZE_S
    player = Player(core, chores, memory.words, host, doze_s)

    def leave(_signal: int, _frame: FrameType | None) -> None:
        chores.leave()

    for number in _SIGNALS:
        signal.signal(number, leave)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    memory.say("\n".join(prepare(setup)))
    clock.attendant = chores
    chores.reporter.write(0)
    memory.words[STAGE] = READY
    player.play()


def _fail(memory: Memory, stage: int, error: BaseException) -> int:
    known = isinstance(error, FraeseError)
    memory.say(
        str(error) if known else phrase("The step process failed: {error}.", error=repr(error))
    )
    memory.words[STAGE] = stage
    return 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2])))
