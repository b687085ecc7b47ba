"""Starting, dying and coming back: real processes, on a mill that writes everything down."""

import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest

from fraese.blocks import Outputs, dwell
from fraese.errors import PortError, StateError
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import RealtimeOptions, Setup
from fraese.motor.seams import Ended, IdleLevel
from tests.motor.distantmill import ChildBench, DistantMill, Log, Spectator
from tests.motor.workbench import Workbench, line, steady

OFF = {(0, 0)}
ALL = frozenset({0, 1, 2})

if sys.platform != "linux":
    pytest.skip("the step process needs Linux", allow_module_level=True)


@pytest.fixture
def bench() -> Iterator[ChildBench]:
    bench = ChildBench("smc", capacity=8, safe_outputs=0)
    yield bench
    bench.remove()


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for_end_of(pid: int, seconds: float = 5.0) -> None:
    until_s = time.monotonic() + seconds
    while is_alive(pid):
        assert time.monotonic() < until_s, f"process {pid} still lives"
        time.sleep(0.002)


def poll_for_ever(driver: RealtimeDriver) -> None:
    while True:
        driver.poll(0.005)


def braked(bench: Spectator) -> bool:
    """At first the motor went at 5000 Hz; its last steps were those of a ramp's end.

    The shortest of some gaps: a busy machine makes steps late, never early.
    """
    gaps_ns = [b - a for a, b in pairwise(bench.steps_ns(motor=0))]
    # The last of them is the byte that switches off.
    fast_ns, slow_ns = min(gaps_ns[-400:-300]), min(gaps_ns[-6:-1])
    return 2 * fast_ns < slow_ns and 600_000 < slow_ns < 1_500_000


class TestStart:
    def test_what_the_system_granted_and_refused_is_told(self, bench: ChildBench) -> None:
        assert len(bench.driver.notes) == 6
        assert "timer slack 1 ns" in bench.driver.notes

    def test_a_port_that_cannot_be_opened_says_so_itself(self) -> None:
        with pytest.raises(PortError, match=r"^no port today$"):
            RealtimeDriver(Setup(refuse, SmcCard()))

    def test_an_error_nobody_thought_of_is_told_too(self) -> None:
        with pytest.raises(PortError, match="ZeroDivisionError"):
            RealtimeDriver(Setup(divide, SmcCard()))

    def test_a_child_that_ends_before_it_is_ready_is_not_waited_for(self) -> None:
        with pytest.raises(PortError, match="did not start"):
            RealtimeDriver(Setup(vanish, SmcCard()))

    def test_under_an_app_that_has_taken_the_streams_away(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        for name in ("stdin", "stdout", "stderr", "__stderr__"):
            monkeypatch.setattr(sys, name, io.StringIO())
        driver = RealtimeDriver(Setup(NullPort, SmcCard()))
        assert driver.poll(0).ended is Ended.NOT
        driver.close()

    def test_closed_it_is_gone(self) -> None:
        driver = RealtimeDriver(Setup(NullPort, SmcCard()))
        driver.close()
        assert not is_alive(driver.pid)
        driver.brake()
        driver.close()
        with pytest.raises(PortError, match="closed"):
            driver.poll(0)


def refuse() -> NullPort:
    raise PortError("no port today")


def divide() -> NullPort:
    raise ZeroDivisionError


def vanish() -> NullPort:
    os._exit(3)


class HeldUp:
    """Every sleep takes some seconds more; after three of them a hanging child comes back."""

    def __init__(self, seconds: float, child: int) -> None:
        self._seconds = seconds
        self._child = child
        self._sleeps = 0
        self.monotonic_ns = time.monotonic_ns

    def monotonic(self) -> float:
        return time.monotonic() + self._sleeps * self._seconds

    def sleep(self, seconds: float) -> None:
        self._sleeps += 1
        if self._sleeps == 3:
            os.kill(self._child, signal.SIGCONT)
        time.sleep(seconds)


class Fragile(DistantMill):
    """A port that goes away when somebody pulls the plug: the file beside the log is gone."""

    def __init__(self, path: Path, plug: Path) -> None:
        super().__init__(path, "smc")
        if not plug.exists():
            raise PortError("there is no port")
        self._plug = plug

    def write_data(self, value: int) -> None:
        if not self._plug.exists():
            raise PortError("the port went away")
        super().write_data(value)


class TestDeathOfTheChild:
    def test_killed_the_motors_are_off_within_a_tenth_of_a_second(self, bench: ChildBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        died_ns = time.monotonic_ns()
        os.kill(bench.driver.pid, signal.SIGKILL)
        with pytest.raises(
            PortError, match=r"SIGKILL\); the motors were switched off \d+ ms later"
        ):
            poll_for_ever(bench.driver)
        assert set(bench.currents()) == OFF
        last_ns = bench.last_write_ns()
        assert 0 < last_ns - died_ns < 100_000_000

    @pytest.mark.parametrize("seconds", [0.03, 0.11, 0.2])
    def test_where_it_was_is_told_to_a_tick(self, bench: ChildBench, seconds: float) -> None:
        for told in (False, True):
            for _ in range(4):
                bench.driver.push(line(400, -130))
            bench.driver.poll(seconds)
            time.sleep(0.05)
            os.kill(bench.driver.pid, signal.SIGKILL)
            with pytest.raises(PortError, match="It was at steps motor 1 ") as caught:
                poll_for_ever(bench.driver)
            facts = caught.value.facts
            low, high = facts["low_steps"], facts["high_steps"]
            assert isinstance(low, tuple)
            assert isinstance(high, tuple)
            assert max(b - a for a, b in zip(low, high, strict=True)) <= 2
            if not told:
                bounds = zip(low, bench.carriages(), high, strict=True)
                assert all(a <= true <= b for a, true, b in bounds)
                assert bench.driver.poll(0).position_steps[0] >= low[0] > 0
                time.sleep(1.1)

    def test_the_motors_are_off_even_if_nobody_polls(self, bench: ChildBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        os.kill(bench.driver.pid, signal.SIGKILL)
        bench.wait(0.3)
        assert set(bench.currents()) == OFF

    def test_the_next_poll_starts_another_and_the_counts_go_on(self, bench: ChildBench) -> None:
        bench.driver.push(line(500, -100))
        while bench.driver.poll(0.01).running:
            pass
        bench.driver.push(line(9000))
        before = bench.driver.poll(0.2)
        os.kill(bench.driver.pid, signal.SIGKILL)
        with pytest.raises(PortError, match="reference the machine"):
            poll_for_ever(bench.driver)
        with pytest.raises(PortError, match="dead"):
            bench.driver.push(line(1))
        report = bench.driver.poll(0)
        assert report.torn == ALL
        assert (report.playing, report.finished, report.queued, report.free) == (2, 1, 0, 8)
        assert (report.running, report.energised) == (False, False)
        where = report.position_steps
        assert where[0] >= before.position_steps[0]
        assert where[1] == -100
        assert bench.driver.push(steady(-20, 4))
        while (report := bench.driver.poll(0.01)).running:
            pass
        assert report.position_steps == (where[0] - 20, -96, 0)
        assert (report.torn, report.playing, report.finished) == (frozenset(), 3, 2)

    def test_a_child_that_hangs_is_killed(self, bench: ChildBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        os.kill(bench.driver.pid, signal.SIGSTOP)
        with pytest.raises(
            PortError, match="did not answer for 1 s and was killed; the motors were"
        ):
            poll_for_ever(bench.driver)
        assert set(bench.currents()) == OFF

    def test_a_host_that_was_held_up_itself_does_not_blame_the_child(
        self, bench: ChildBench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """A machine that stood still for seconds: both come back, and the child may answer."""
        bench.driver.push(line(3000))
        bench.driver.poll(0.1)
        os.kill(bench.driver.pid, signal.SIGSTOP)
        held_up = HeldUp(3.0, bench.driver.pid)
        monkeypatch.setattr("fraese.motor.realtime.session.time", held_up)
        report = bench.driver.poll(0)
        assert (report.running, report.torn) == (True, frozenset())

    def test_one_that_hangs_is_killed_when_it_is_to_close(self, bench: ChildBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        os.kill(bench.driver.pid, signal.SIGSTOP)
        bench.driver.close()
        assert not is_alive(bench.driver.pid)
        assert set(bench.currents()) == OFF

    def test_asked_to_end_by_a_signal_it_brakes_and_switches_off(self, bench: ChildBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        os.kill(bench.driver.pid, signal.SIGTERM)
        with pytest.raises(PortError, match="was told to end; it switched the motors off"):
            poll_for_ever(bench.driver)
        assert set(bench.currents()) == OFF
        assert braked(bench)

    def test_a_port_that_goes_away_is_told_with_its_own_sentence(self, tmp_path: Path) -> None:
        plug, log = tmp_path / "plug", tmp_path / "log"
        plug.touch()
        Log.create(log)
        driver = RealtimeDriver(Setup(partial(Fragile, log, plug), SmcCard()))
        driver.push(line(9000))
        driver.poll(0.1)
        plug.unlink()
        with pytest.raises(
            PortError,
            match=r"the port went away; the motors could not be switched off \(there is no port\)",
        ):
            poll_for_ever(driver)
        driver.close()


#: A host of its own: says its child's number, then does what it is told.
HOST = """
import sys, time
from functools import partial
from itertools import pairwise
from pathlib import Path
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import Setup
from tests.motor.distantmill import DistantMill
from tests.motor.workbench import line

driver = RealtimeDriver(Setup(partial(DistantMill, Path(sys.argv[1]), "smc"), SmcCard()))
driver.push(line(9000))
driver.poll(0.3)
print(driver.pid, flush=True)
while True:
    driver.poll(0.05)
"""


#: A host that ends just after its child was killed.
BURYING_HOST = """
import os, signal, sys
from functools import partial
from pathlib import Path
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import Setup
from tests.motor.workbench import line
from tests.realtime.test_lives import opened_slowly

driver = RealtimeDriver(Setup(partial(opened_slowly, Path(sys.argv[1])), SmcCard()))
driver.push(line(9000))
driver.poll(0.2)
os.kill(driver.pid, signal.SIGKILL)
raise KeyboardInterrupt
"""


def opened_slowly(log: Path) -> DistantMill:
    time.sleep(0.1)
    return DistantMill(log, "smc")


def python(program: str, log: Path) -> "subprocess.Popen[str]":
    """A process of its own that runs a program."""
    return subprocess.Popen(
        [sys.executable, "-c", program, str(log)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


class TestDeathOfTheHost:
    @pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
    def test_the_child_brakes_switches_off_and_goes(self, tmp_path: Path, number: int) -> None:
        log = tmp_path / "log"
        Log.create(log)
        with python(HOST, log) as host:
            assert host.stdout is not None
            child = int(host.stdout.readline())
            host.send_signal(number)
            host.wait()
            died_ns = time.monotonic_ns()
        wait_for_end_of(child)
        bench = Spectator(log, "smc")
        assert set(bench.currents()) == OFF
        assert braked(bench)
        assert bench.last_write_ns() - died_ns < 400_000_000

    def test_a_host_that_ends_while_it_buries_its_child_still_switches_off(
        self, tmp_path: Path
    ) -> None:
        """Both at once: Ctrl-C just when the child was killed, and the port is slow to open."""
        log = tmp_path / "log"
        Log.create(log)
        with python(BURYING_HOST, log) as host:
            host.wait()
        assert set(Spectator(log, "smc").currents()) == OFF

    def test_a_host_that_hangs_is_told_when_it_comes_back(self) -> None:
        bench = ChildBench("smc", 8, 0, RealtimeOptions(silent_s=0.3))
        bench.driver.push(line(9000))
        bench.driver.poll(0.2)
        bench.wait(0.8)
        assert set(bench.currents()) == OFF
        # Pushed before it was told: not played.
        assert bench.driver.push(line(100))
        report = bench.driver.poll(0)
        assert (report.ended, report.torn, report.energised) == (Ended.SILENCE, frozenset(), False)
        assert (report.queued, report.playing) == (0, 2)
        assert bench.carriages() == report.position_steps
        bench.remove()


@pytest.mark.parametrize("wiring", ["smc", "x4step"])
def test_the_child_writes_the_very_bytes_that_the_core_writes(wiring: str) -> None:
    blocks = (line(300, -211, 7), dwell(3, 0.02), line(-50, 99, 99, outputs=Outputs(1, 1)))
    here = Workbench(wiring, outputs=True, safe_outputs=0b10)
    here.run(*blocks)
    there = ChildBench(wiring, capacity=8, safe_outputs=0b10)
    for block in blocks:
        there.driver.push(block)
    while there.driver.poll(0.02).running:
        pass
    assert there.writes() == here.writes()
    there.remove()


class TestCommands:
    def test_refusals_come_back_as_the_cores_own(self, bench: ChildBench) -> None:
        bench.driver.push(line(3000))
        bench.driver.poll(0.1)
        with pytest.raises(StateError, match="the queue can only be dropped at standstill"):
            bench.driver.flush()
        with pytest.raises(StateError, match="the motors can only be switched off at standstill"):
            bench.driver.idle(IdleLevel.OFF)
        bench.driver.stop()
        bench.driver.poll(0)
        bench.driver.idle(IdleLevel.OFF)
        assert set(bench.currents()) == OFF
