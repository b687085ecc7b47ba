"""What a step process leaves whose host was killed: whole or nothing, and to the step."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fraese.errors import PortError
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime import lastwords
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.lastwords import SIZE, LastWords, unpacked
from fraese.motor.realtime.setup import Setup, WordsTo
from fraese.motor.seams import Ended
from tests.motor.distantmill import Log, Spectator
from tests.motor.workbench import line

WORDS = LastWords(
    bytes(range(16)), (12, -(10**9), 0), (3, 5, 7), frozenset({1}), Ended.TARGET, (12, 10**9, 4)
)

HOST = """
import sys
from functools import partial
from pathlib import Path
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.lastwords import open_for
from fraese.motor.realtime.setup import Setup, WordsTo
from tests.motor.distantmill import DistantMill
from tests.motor.workbench import line

fd = open_for(Path(sys.argv[2]))
port = partial(DistantMill, Path(sys.argv[1]), "smc")
driver = RealtimeDriver(Setup(port, SmcCard(), last_words=WordsTo(fd, bytes(range(16)))))
driver.push(line(700, -130))
driver.push(line(9000, 4000))
driver.poll(0.2)
if sys.argv[3] == "another":
    import os, signal
    os.kill(driver.pid, signal.SIGKILL)
    try:
        while True:
            driver.poll(0.005)
    except Exception:
        where = driver.poll(0).position_steps
        driver.push(line(9000, 4000))
        print(*where, flush=True)
    driver.poll(0.2)
print(driver.pid, flush=True)
while True:
    driver.poll(0.05)
"""


def killed_host(folder: Path, way: str = "") -> tuple[list[str], Spectator, LastWords | None]:
    """A host that is killed while its step process moves; what it had said, and what was left."""
    log, path = folder / "log", folder / "words"
    Log.create(log)
    command = [sys.executable, "-c", HOST, str(log), str(path), way]
    there = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=there) as host:
        assert host.stdout is not None
        said = [host.stdout.readline() for _ in range(2 if way else 1)]
        assert lastwords.read(path) is None
        host.kill()
    child, until_s = int(said[-1]), time.monotonic() + 5
    while Path(f"/proc/{child}").exists():
        assert time.monotonic() < until_s
        time.sleep(0.002)
    spectator = Spectator(log, "smc")
    return said, spectator, lastwords.read(path)


def poll_for_ever(driver: RealtimeDriver) -> None:
    while True:
        driver.poll(0.01)


@pytest.mark.skipif(sys.platform != "linux", reason="the step process needs Linux")
class TestKilledHost:
    def test_its_step_process_leaves_where_the_carriages_are(self, tmp_path: Path) -> None:
        _, mill, words = killed_host(tmp_path)
        assert words is not None
        assert set(mill.currents()) == {(0, 0)}
        assert words.position_steps == mill.carriages()
        assert words.position_steps[0] > 700
        assert (words.token, words.torn) == (bytes(range(16)), frozenset())
        assert len(words.phases) == 3

    def test_counts_go_on_over_an_earlier_step_process(self, tmp_path: Path) -> None:
        said, mill, words = killed_host(tmp_path, "another")
        assert words is not None
        where = [int(word) for word in said[0].split()]
        # The second one was begun where the first was seen last; the mill knows the difference.
        left = [a - b for a, b in zip(words.position_steps, where, strict=True)]
        assert left[0] > 300
        assert left[0] <= mill.carriages()[0] - where[0] + 50

    def test_a_second_step_process_begins_anew_and_unsure(self, tmp_path: Path) -> None:
        path = tmp_path / "words"
        to = WordsTo(lastwords.open_for(path), bytes(range(16)))
        driver = RealtimeDriver(Setup(NullPort, SmcCard(), last_words=to))
        driver.push(line(200))
        while driver.poll(0.01).running:
            pass
        os.kill(driver.pid, signal.SIGTERM)
        with pytest.raises(PortError, match="was told to end"):
            poll_for_ever(driver)
        left = lastwords.read(path)
        assert left is not None
        assert (left.position_steps, left.torn) == ((200, 0, 0), frozenset())
        driver.poll(0)
        # Whatever it does from now on, the place of the first one is none of its.
        assert lastwords.read(path) is None
        driver.close()
        words = lastwords.read(path)
        assert words is not None
        assert (words.position_steps, words.torn) == ((200, 0, 0), frozenset({0, 1, 2}))
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.fstat(to.fd)
        driver.close()


def test_what_was_left_is_read_again(tmp_path: Path) -> None:
    fd = lastwords.open_for(tmp_path / "words")
    lastwords.leave(fd, WORDS)
    os.close(fd)
    assert lastwords.read(tmp_path / "words") == WORDS
    assert (tmp_path / "words").stat().st_mode & 0o777 == 0o600
    os.close(lastwords.open_for(tmp_path / "words"))
    assert lastwords.read(tmp_path / "words") is None


def test_no_changed_bit_and_no_part_is_taken_for_a_place() -> None:
    data = WORDS.packed()
    assert unpacked(data) == WORDS
    for at in range(SIZE):
        for bit in range(8):
            assert unpacked(data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1 :]) is None
    assert [unpacked(data[:length]) for length in range(SIZE)] == [None] * SIZE
    assert unpacked(data + b"\0") is None
    assert unpacked(bytes(SIZE)) is None


def test_links_pipes_and_what_is_not_there_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(WORDS.packed())
    (tmp_path / "link").symlink_to(tmp_path / "real")
    os.mkfifo(tmp_path / "pipe")
    for name in ("link", "pipe", "nothing", "."):
        assert lastwords.read(tmp_path / name) is None
    for name in ("link", "pipe", "."):
        with pytest.raises(OSError, match=r"no file|links|directory"):
            lastwords.open_for(tmp_path / name)
    assert (tmp_path / "real").read_bytes() == WORDS.packed()
