"""The lock: one program drives a machine, and the other one is told which."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fraese.errors import BusyError, ConfigError
from fraese.journal import Holder, MachineLock

_HOLD = """
import sys, time
from pathlib import Path
from fraese.journal import MachineLock
lock = MachineLock(Path(sys.argv[1]))
lock.take("fraese run part.ngc")
print("has it", flush=True)
if len(sys.argv) > 2:
    import os, subprocess
    child = [sys.executable, "-c", "import sys; sys.stdin.read()"]
    subprocess.Popen(child, stdin=0, stdout=2, pass_fds=[lock.descriptor])
    os.kill(os.getpid(), 9)
sys.stdin.read()
"""


def holding(path: Path, *words: str) -> "subprocess.Popen[str]":
    process = subprocess.Popen(
        [sys.executable, "-c", _HOLD, str(path), *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "has it\n"
    return process


def ended(process: "subprocess.Popen[str]") -> None:
    process.communicate(timeout=30)


def test_a_second_program_is_told_who_has_it(tmp_path: Path) -> None:
    path = tmp_path / "mill.lock"
    process = holding(path)
    lock = MachineLock(path)
    since_s = time.monotonic()
    with pytest.raises(BusyError, match=r"driven by fraese run part.ngc \(process \d+\)") as caught:
        lock.take("fraese where")
    assert time.monotonic() - since_s < 1
    assert str(process.pid) in str(caught.value)
    assert caught.value.exit_code == 1
    holder = lock.holder()
    assert holder is not None
    assert (holder.pid, holder.lives) == (process.pid, True)
    ended(process)
    assert lock.holder() is None
    lock.take("fraese where")
    lock.let_go()


def test_a_killed_program_does_not_hold_it(tmp_path: Path) -> None:
    path = tmp_path / "mill.lock"
    process = holding(path)
    process.kill()
    ended(process)
    lock = MachineLock(path)
    assert lock.holder() is None
    lock.take("fraese")
    assert lock.descriptor is not None
    lock.let_go()
    assert lock.descriptor is None


def test_what_a_killed_program_left_behind_is_waited_for(tmp_path: Path) -> None:
    path = tmp_path / "mill.lock"
    process = holding(path, "with a child")
    process.wait()
    lock = MachineLock(path)
    holder = lock.holder()
    assert holder is not None
    assert not holder.lives
    with pytest.raises(BusyError, match="what is left of fraese run"):
        lock.take("fraese", leaves_s=0.1)
    # The child ends with its input.
    ended(process)
    lock.take("fraese")
    lock.let_go()


def test_the_file_is_the_users_alone(tmp_path: Path) -> None:
    lock = MachineLock(tmp_path / "state" / "mill.lock")
    lock.take("fraese")
    assert lock.path.stat().st_mode & 0o777 == 0o600
    assert lock.path.parent.stat().st_mode & 0o777 == 0o700
    lock.let_go()


def test_whoever_looks_writes_nothing(tmp_path: Path) -> None:
    assert MachineLock(tmp_path / "mill.lock").holder() is None
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"[]", b"{", b'{"pid": "x"}', b"\xff" * 100])
def test_whatever_stands_in_it_it_can_be_held(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "mill.lock"
    path.write_bytes(content)
    lock, other = MachineLock(path), MachineLock(path)
    lock.take("fraese")
    with pytest.raises(BusyError, match="driven by fraese"):
        other.take("fraese")
    path.write_bytes(content)
    with pytest.raises(BusyError, match="another program"):
        other.take("fraese", leaves_s=0)
    lock.let_go()


def test_nothing_else_is_opened_in_its_place(tmp_path: Path) -> None:
    path, victim = tmp_path / "mill.lock", tmp_path / "victim"
    victim.write_bytes(b"mine")
    path.symlink_to(victim)
    with pytest.raises(ConfigError, match="remove it"):
        MachineLock(path).take("fraese")
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(ConfigError, match="remove it"):
        MachineLock(path).take("fraese")
    assert victim.read_bytes() == b"mine"


_SAYS_WHEN = "import os; from fraese.journal.lock import _started; print(_started(os.getpid()))"


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="there is no such list")
def test_a_dead_program_of_which_its_parent_has_not_heard_does_not_live() -> None:
    command = [sys.executable, "-c", _SAYS_WHEN]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        started = process.stdout.read().strip()
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        assert started.isdigit()
        assert not Holder("fraese", process.pid, started).lives
