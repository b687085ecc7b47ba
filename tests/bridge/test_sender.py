"""A sender drives a bridge by ``fraese serve``: port, firmware and simulated mill, in real time."""

import json
import os
import select
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.bridge.device import reason_to_skip
from tests.bridge.stack import PATIENCE_S, Stack

pytestmark = [
    pytest.mark.alone,
    pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip()),
    pytest.mark.skipif(sys.platform != "linux", reason="a pty takes the serial port's place"),
]


@pytest.fixture
def stack(tmp_path: Path) -> Iterator[Stack]:
    stack = Stack(tmp_path)
    with stack.mill:
        yield stack


def _until(fd: int, word: bytes) -> bytes:
    heard = b""
    while word not in heard:
        assert select.select([fd], [], [], PATIENCE_S)[0], heard
        heard += os.read(fd, 4096)
    return heard


def test_a_sender_references_jogs_and_streams(stack: Stack, tmp_path: Path) -> None:
    link = tmp_path / "sender"
    process = stack.start("serve", "--json", "--link", str(link))
    assert process.stdout is not None
    process.stdout.readline()
    fd = os.open(link, os.O_RDWR | os.O_NOCTTY)
    _until(fd, b"to unlock]")
    os.write(fd, b"$H\n")
    _until(fd, b"ok\r\n")
    zero = stack.mill.carriages_steps()
    os.write(fd, b"$J=G91 G21 X0.5 F600\n")
    _until(fd, b"ok\r\n")
    os.write(fd, b"?")
    while b"<Idle|" not in _until(fd, b">"):
        os.write(fd, b"?")
    lines = [b"G21 G90 F600", *(b"G1 X%d.%d Y1" % divmod(n, 10) for n in range(5, 25)), b"G4 P0"]
    for line in lines:
        os.write(fd, line + b"\n")
        _until(fd, b"ok\r\n")
    moved = [b - a for a, b in zip(zero, stack.mill.carriages_steps(), strict=True)]
    assert moved == [480, 200, 0]
    assert stack.mill.lost_steps() == (0, 0, 0)
    os.close(fd)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, out + err
    where = json.loads(stack.run("where", "--json").stdout.splitlines()[-1])
    assert where["position_mm"] == {"x": 2.4, "y": 1.0, "z": 0.0}
    assert all(where["referenced"].values())
