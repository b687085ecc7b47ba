"""Where senders come in: a pseudo-terminal, a port, and who is let in there."""

import os
import socket
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fraese.config.file import from_table
from fraese.errors import ConfigError, PortError
from fraese.serve.access import Access, token_of
from fraese.serve.connection import Connection
from fraese.serve.pty import PtyDoor
from fraese.serve.tcp import TcpDoor
from tests.helpers import configured

TOKEN = "a-word-of-enough-letters"


def _nothing() -> None:
    """Nobody waits for a turn."""


def _soon(look: Callable[[], Connection | None]) -> Connection:
    """What comes within a second."""
    until_s = time.monotonic() + 1
    while (found := look()) is None:
        assert time.monotonic() < until_s
        time.sleep(0.001)
    return found


def _read(connection: Connection) -> bytes | None:
    until_s = time.monotonic() + 1
    while (data := connection.read()) == b"":
        assert time.monotonic() < until_s
        time.sleep(0.001)
    return data


def test_a_pseudo_terminal_is_found_by_its_link_and_left_as_it_was(tmp_path: Path) -> None:
    link = tmp_path / "mill"
    door = PtyDoor(link, _nothing)
    assert door.arrived() is None
    for word in (b"one\n", b"two\n"):
        fd = os.open(link, os.O_RDWR | os.O_NOCTTY)
        sender = _soon(door.arrived)
        os.write(fd, word)
        assert _read(sender) == word
        sender.put("answer\r\n")
        assert os.read(fd, 100) == b"answer\r\n"
        sender.put("what nobody reads\r\n")
        os.close(fd)
        assert _read(sender) is None
        door.left(sender)
    door.close()
    assert not os.path.lexists(link)


def test_what_is_no_link_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "mill").write_text("mine")
    with pytest.raises(ConfigError, match="no link"):
        PtyDoor(tmp_path / "mill", _nothing)
    assert (tmp_path / "mill").read_text() == "mine"


def test_who_is_told_more_than_he_reads_holds_nobody_up(tmp_path: Path) -> None:
    door = PtyDoor(None, _nothing)
    fd = os.open(door.path, os.O_RDWR | os.O_NOCTTY)
    sender = _soon(door.arrived)
    for _ in range(20_000):
        sender.put("x" * 100)
    assert sender.is_waiting
    os.close(fd)
    door.close()


@pytest.fixture
def port() -> Callable[[Access], TcpDoor]:
    return lambda access: TcpDoor("127.0.0.1", 0, access, _nothing)


def _knock(door: TcpDoor) -> socket.socket:
    host, _, number = door.name.rpartition(":")
    return socket.create_connection((host, int(number)), timeout=1)


def test_this_computer_is_let_in(port: Callable[[Access], TcpDoor]) -> None:
    door = port(Access((), ""))
    with _knock(door) as there:
        sender = _soon(door.arrived)
        there.sendall(b"?")
        assert _read(sender) == b"?"
        sender.put("ok\r\n")
        assert there.recv(10) == b"ok\r\n"
        door.left(sender)
    door.close()


class _Strangers(Access):
    """This computer is none of ours."""

    def admits(self, address: str) -> bool:
        return False


def test_a_stranger_is_sent_away(port: Callable[[Access], TcpDoor]) -> None:
    door = port(_Strangers((), ""))
    with _knock(door) as there:
        assert door.arrived() is None
        assert there.recv(100).startswith(b"[MSG:This address is not allowed")
        assert there.recv(100) == b""
    door.close()


def test_the_token_lets_a_stranger_in_and_nothing_else_does(
    port: Callable[[Access], TcpDoor],
) -> None:
    door = port(_Strangers((), TOKEN))
    with _knock(door) as there, _knock(door) as other:
        assert door.arrived() is None
        assert door.arrived() is None
        other.sendall(b"$X\n")
        there.sendall(TOKEN.encode() + b"\n?")
        sender = _soon(door.arrived)
        assert _read(sender) == b"?"
        assert door.arrived() is None
        assert other.recv(100) == b""
    door.close()


@pytest.mark.parametrize(
    ("address", "admitted"),
    [
        ("127.0.0.1", True), ("::1", True), ("::ffff:127.0.0.1", True), ("192.168.1.20", True),
        ("10.0.0.200", True), ("192.168.1.21", False), ("::ffff:192.168.1.20", True),
        ("fe80::1%eth0", False),
    ],
)  # fmt: skip
def test_who_is_admitted_by_his_address(address: str, admitted: bool) -> None:
    serve = configured(serve={"allow": ["192.168.1.20", "10.0.0.0/24"]}).serve
    assert Access(serve.networks, TOKEN).admits(address) is admitted


def test_a_port_that_somebody_has_is_refused() -> None:
    taken = socket.create_server(("127.0.0.1", 0))
    with taken, pytest.raises(PortError, match="cannot be had"):
        TcpDoor("127.0.0.1", taken.getsockname()[1], Access((), ""), _nothing)


@pytest.mark.parametrize(
    ("serve", "said"),
    [
        ({"tcp": "0.0.0.0:2000"}, "say which by serve.allow"),
        ({"tcp": "[::]:2000"}, "say which by serve.allow"),
        ({"tcp": "machine:2000"}, "say which by serve.allow"),
        ({"tcp": "here"}, "must be a port"),
        ({"tcp": "70000"}, "must be a port"),
        ({"allow": ["everybody"]}, "no address or network"),
    ],
)
def test_what_would_let_everybody_in_is_refused(serve: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        from_table({"serve": serve}, "here")


@pytest.mark.parametrize("tcp", ["2000", "127.0.0.1:2000", "[::1]:2000", "localhost:2000"])
def test_this_computer_needs_nothing(tcp: str) -> None:
    configured(serve={"tcp": tcp})


@pytest.mark.parametrize("said", [b"short\n", b"two words of some length\n", b"\xff" * 20, b""])
def test_a_token_is_one_long_word(said: bytes, tmp_path: Path) -> None:
    (tmp_path / "token").write_bytes(said)
    with pytest.raises(ConfigError, match="one word of 16"):
        token_of(tmp_path / "token")
    (tmp_path / "token").write_text(TOKEN + "\n")
    assert token_of(tmp_path / "token") == TOKEN
