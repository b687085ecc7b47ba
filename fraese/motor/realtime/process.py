"""The child as its parent sees it: started, rung, watched, and buried.

Rule 1: a subprocess, not a fork: it has nothing of the app's threads, terminal or locks. It has the
        parent's module path, and no streams: under the app there may be none.
Rule 2: a thread waits for its death. Unless it left in order, the port is opened again at once and
        the motors are switched off; only then anybody is told. It is woken before all other
        threads and programs, if it may, and on any core.
Rule 3: the shared memory is given back when nobody holds it any more: ``brake`` may come late, from
        any thread.
Rule 4: a parent that ends without closing tells the child so by its pipe, and stays until the
        motors are off: the child may have died a moment ago, unknown to anybody. Only a parent that
        is killed does not; then a child that lives sees to it alone.
Rule 5: while it lives, the threads of this process leave its core to it.
"""

import atexit
import contextlib
import os
import pickle
import signal
import subprocess
import threading
import time
from dataclasses import dataclass
from typing import Final

from fraese import alarms
from fraese.comefirst import come_first_when_woken
from fraese.errors import FraeseError, PortError
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.cores import KeptOff
from fraese.motor.realtime.hostline import message
from fraese.motor.realtime.memory import DOZING, STAGE, Memory
from fraese.motor.realtime.rescue import switch_off
from fraese.motor.realtime.setup import Setup
from fraese.phrases import phrase, reason, remembered
from fraese.spawn import command, environment

_MODULE: Final = "fraese.motor.realtime.child"
#: Python has to start and to import, on a busy machine.
_START_S: Final = 20.0
_LOOK_S: Final = 0.001
#: After its death, the motors are off or not within this.
_BURIAL_S: Final = 2.0
_BELL: Final = b"\n"


@dataclass(frozen=True, slots=True)
class Death:
    """How the child ended, and how the motors were left.

    Attributes:
        how: half a sentence; empty when it left in order.
        off_ms: the parent switched the motors off so long after it; None: there was no need to.
        error: why it could not.
    """

    how: str
    off_ms: float | None = None
    error: str = ""

    def sentence(self) -> str:
        """For the user."""
        if self.error and self.error == self.how:
            # The port itself is gone, and has said what to do.
            return phrase("{how}, then reference the machine again.", how=self.how)
        if self.error:
            off = phrase(
                "the motors could not be switched off ({error}): cut their power", error=self.error
            )
        elif self.off_ms is None:
            off = phrase("it switched the motors off")
        else:
            off = phrase("the motors were switched off {off_ms:.0f} ms later", off_ms=self.off_ms)
        return phrase(
            "{how}; {off}. The position is uncertain: reference the machine again.",
            how=self.how,
            off=off,
        )


class ChildProcess:
    """One life of the child.

    Args:
        setup: what it is told.

    Attributes:
        memory: shared with it.
        notes: what the system granted and refused it.
        death: how it ended, when the motors have been seen to.

    Raises:
        PortError: if it does not start, with its own sentence.
    """

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._why = ""
        self._leaves = False
        self.death: Death | None = None
        self._buried = threading.Event()
        self._kept_off = KeptOff()
        samples = setup.meter.samples if setup.meter else 0
        fd = shared.create(samples)
        try:
            self.memory = Memory(fd, samples)
            self._process = self._spawn(fd, samples)
        except OSError as error:
            raise PortError(
                phrase("The step process cannot be started: {reason}.", reason=reason(error)),
                alarms.STEP_PROCESS_START,
            ) from error
        finally:
            os.close(fd)
        assert self._process.stdin is not None
        self._pipe = self._process.stdin
        self._started = False
        self._code = 0
        watcher = threading.Thread(target=self._watch, name="step process", daemon=True)
        watcher.start()
        self._kept_off.sleeper = watcher.native_id
        atexit.register(self._end_with_it)
        self._hand_over(setup)
        self.notes = self._wait_until_ready()
        self._kept_off.leave_to(self.pid)

    @property
    def pid(self) -> int:
        """Process number."""
        return self._process.pid

    def _spawn(self, fd: int, samples: int) -> "subprocess.Popen[bytes]":
        return subprocess.Popen(
            command(_MODULE, str(fd), str(samples)),
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            pass_fds=(fd, *self._setup.kept_fds()),
            start_new_session=True,
            env=environment(),
        )

    def _hand_over(self, setup: Setup) -> None:
        data = memoryview(message(pickle.dumps(setup)))
        # Broken: it did not start, and that is seen soon.
        with contextlib.suppress(BrokenPipeError):
            while data:
                data = data[self._pipe.write(data) :]
        os.set_blocking(self._pipe.fileno(), False)

    def _wait_until_ready(self) -> tuple[str, ...]:
        stage, until_s = shared.STARTING, time.monotonic() + _START_S
        while stage == shared.STARTING and not self.is_gone and time.monotonic() < until_s:
            time.sleep(_LOOK_S)
            stage = self.memory.words[STAGE]
        if stage == shared.READY:
            self._started = True
            return tuple(map(remembered, self.memory.text().splitlines()))
        self._process.kill()
        self.bury()
        said = self.memory.text()
        if said:
            raise PortError(said)
        raise PortError(
            phrase("The step process did not start ({how}).", how=self._how(self._code)),
            alarms.STEP_PROCESS_START,
        )

    @property
    def is_gone(self) -> bool:
        """It has ended; whether the motors are off is known a little later."""
        return self._process.poll() is not None

    def ring(self) -> None:
        """Wake it if it sleeps."""
        if self.memory.words[DOZING]:
            # Full: it has been rung for often enough. Broken or closed: the watcher knows.
            with contextlib.suppress(OSError, ValueError):
                self._pipe.write(_BELL)

    def kill(self, why: str) -> None:
        """End it at once, motors off from here.

        Args:
            why: half a sentence for the user.
        """
        self._why = why
        self._process.kill()

    def leave(self, patience_s: float) -> Death:
        """It was told to end: wait for that; if it takes longer, kill it."""
        self._leaves = True
        if not self._buried.wait(patience_s):
            self.kill(phrase("The step process did not end when told to and was killed"))
        return self.bury()

    def bury(self) -> Death:
        """How it ended; waits until the motors have been seen to."""
        self._buried.wait(_BURIAL_S)
        self._pipe.close()
        return self.death or Death(
            phrase("The step process cannot be ended"), error=phrase("it still lives")
        )

    def _watch(self) -> None:
        """In a thread of its own: waits for the end."""
        come_first_when_woken()
        self._code = code = self._process.wait()
        ended_ns = time.monotonic_ns()
        try:
            self.death = self._judge(code, ended_ns)
        except BaseException as error:
            self.death = Death(self._how(code), error=repr(error))
        finally:
            self._kept_off.come_back()
            self._buried.set()
            atexit.unregister(self._end_with_it)

    def _end_with_it(self) -> None:
        """This process ends, but not before the motors are off."""
        self._pipe.close()
        self._buried.wait(_BURIAL_S)

    def _judge(self, code: int, ended_ns: int) -> Death:
        stage = self.memory.words[STAGE]
        if stage == shared.ENDED:
            how = "" if self._leaves else phrase("The step process was told to end")
            return Death(how)
        if stage == shared.FAILED or not self._started:
            return Death(self._how(code))
        try:
            switch_off(self._setup.open_port, self._setup.card)
        except FraeseError as error:
            return Death(self._how(code), error=str(error).rstrip("."))
        return Death(self._how(code), off_ms=(time.monotonic_ns() - ended_ns) * 1e-6)

    def _how(self, code: int) -> str:
        if self._why:
            return self._why
        if self.memory.words[STAGE] in (shared.FAILED, shared.FAILED_LIVE):
            return remembered(self.memory.text()).rstrip(".")
        if code < 0:
            return phrase("The step process died ({name})", name=signal.Signals(-code).name)
        return phrase("The step process ended by itself (code {code})", code=code)
