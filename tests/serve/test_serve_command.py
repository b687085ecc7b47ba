"""``fraese serve`` as a process: somebody connects, moves the mill, and goes; Ctrl+C ends it."""

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

FRAESE = (sys.executable, "-m", "fraese")


def _run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*FRAESE, *words, "--state", str(folder)], capture_output=True, text=True, cwd=folder
    )


@pytest.fixture
def server(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], list[str]]]:
    """It, and where it is."""
    process = subprocess.Popen(
        [*FRAESE, "serve", "--json", "--fast", "--tcp", "0", "--link", str(tmp_path / "mill"),
         "--state", str(tmp_path)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path,
    )  # fmt: skip
    assert process.stdout is not None
    said = process.stdout.readline()
    assert said, process.communicate(timeout=10)[1]
    yield process, json.loads(said)["at"]
    process.kill()
    process.communicate(timeout=10)


def _until(there: socket.socket, word: bytes) -> bytes:
    heard = b""
    while word not in heard:
        more = there.recv(4096)
        assert more, heard
        heard += more
    return heard


@pytest.mark.alone
def test_a_sender_on_the_port_and_another_at_the_terminal(
    server: tuple[subprocess.Popen[str], list[str]], tmp_path: Path
) -> None:
    process, (link, port) = server
    host, _, number = port.rpartition(":")
    with socket.create_connection((host, int(number)), timeout=20) as there:
        _until(there, b"to unlock]\r\n")
        fd = os.open(link, os.O_RDWR | os.O_NOCTTY)
        assert os.read(fd, 100) == b"[MSG:Another sender is connected]\r\n"
        os.close(fd)
        there.sendall(b"$H\n")
        _until(there, b"ok\r\n")
        there.sendall(b"G1 X10 Y5 F600\nG4 P0\n")
        _until(there, b"ok\r\nok\r\n")
        there.sendall(b"?")
        assert b"<Idle|MPos:10.000,5.000,0.000|" in _until(there, b">")
    process.send_signal(signal.SIGINT)
    ended, said = process.communicate(timeout=20)
    assert process.returncode == 130
    told = json.loads(ended)
    assert told["status"] == "cancelled"
    assert told["position_mm"] == told["carriages_mm"] == {"x": 10, "y": 5, "z": 0}
    assert told["lost_steps"] == {"x": 0, "y": 0, "z": 0}
    assert told["dry_queues"] == 0
    assert "A sender is connected" in said
    assert "The sender has gone" in said
    assert not os.path.lexists(link)
    where = json.loads(_run(tmp_path, "where", "--json").stdout.splitlines()[-1])
    assert where["position_mm"] == {"x": 10, "y": 5, "z": 0}
    assert where["referenced"] == {"x": True, "y": True, "z": True}


def test_nobody_is_let_in_from_everywhere(tmp_path: Path) -> None:
    done = _run(tmp_path, "serve", "--tcp", "0.0.0.0:0")
    assert done.returncode == 2
    assert "say which by serve.allow" in done.stderr
    assert "Traceback" not in done.stderr
