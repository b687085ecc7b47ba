"""What every sender has to bring about: connect, jog, stream a file, hold, go on, reset.

Rule 1: what the sender believes is compared with what the simulated mill says of its carriages.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Protocol

from rigs.senders import program
from rigs.senders.served import served

Place = tuple[float, ...]
_NEAR_MM: Final = 0.006
_PATIENCE_S: Final = 20.0
#: The whole file, in real time, takes about a minute.
_STREAM_S: Final = 240.0


class Sender(Protocol):
    """A real sender, driven as a person would."""

    name: str

    def connect(self, port: str) -> None:
        """Open the port, and wait until it is ready."""

    def state(self) -> tuple[str, Place]:
        """State and machine position as it shows them."""

    def send(self, line: str) -> None:
        """One line, at once."""

    def stream(self, path: Path) -> None:
        """Begin to send a file."""

    def is_sent(self) -> bool:
        """All of it was sent and answered."""

    def hold(self) -> None:
        """Feed hold."""

    def resume(self) -> None:
        """Go on."""

    def reset(self) -> None:
        """Soft reset."""

    def unlock(self) -> None:
        """Take note of an alarm."""

    def close(self) -> None:
        """Leave."""


def wait(what: str, is_so: Callable[[], bool], patience_s: float = _PATIENCE_S) -> float:
    """Until something is so; how long that took, s."""
    begun_s = time.monotonic()
    while not is_so():
        assert time.monotonic() - begun_s < patience_s, f"never: {what}"
        time.sleep(0.02)
    return time.monotonic() - begun_s


def _word(sender: Sender) -> str:
    word = sender.state()[0].partition(":")[0]
    # bCNC shows which alarm it was.
    return "Alarm" if word == "ALARM" else word


def _is_near(place: Place, wanted: Place) -> bool:
    return all(abs(a - b) < _NEAR_MM for a, b in zip(place, wanted, strict=False))


def _jog(sender: Sender) -> None:
    before = sender.state()[1]
    sender.send("$J=G91 G21 X5 F900")
    there = (before[0] + 5, *before[1:])
    wait("jogged by 5 mm", lambda: _word(sender) == "Idle" and _is_near(sender.state()[1], there))


def _hold(sender: Sender) -> dict[str, Any]:
    at = sender.state()[1]
    wait("it moves", lambda: not _is_near(sender.state()[1], at) and _word(sender) == "Run")
    sender.hold()
    held_s = wait("it is held", lambda: sender.state()[0] in ("Hold", "Hold:0"))
    time.sleep(0.5)
    held = sender.state()[1]
    time.sleep(0.7)
    assert _is_near(sender.state()[1], held), "it moves while it is held"
    sender.resume()
    wait("it goes on", lambda: not _is_near(sender.state()[1], held))
    return {"held_after_s": round(held_s, 2)}


def play(sender: Sender, folder: Path, count: int = program.LINES) -> dict[str, Any]:
    """All of it; figures of it."""
    path = program.write(folder / "curve.nc", count)
    found: dict[str, Any] = {"sender": sender.name, "lines": count}
    with served(folder / "machine") as server:
        sender.connect(server.at[0])
        wait("idle", lambda: _word(sender) == "Idle")
        _jog(sender)
        begun_s = time.monotonic()
        sender.stream(path)
        wait("it runs", lambda: _word(sender) == "Run")
        time.sleep(2)
        found |= _hold(sender)
        wait("all is sent", sender.is_sent, _STREAM_S)
        wait("it stands at the end", lambda: _word(sender) == "Idle")
        found["streamed_s"] = round(time.monotonic() - begun_s, 1)
        believed = sender.state()[1]
        assert _is_near(believed, program.END_MM), believed
        sender.stream(path)
        wait("it runs again", lambda: _word(sender) == "Run")
        time.sleep(2)
        sender.reset()
        wait("the reset locks it", lambda: _word(sender) == "Alarm")
        sender.unlock()
        wait("it is unlocked", lambda: _word(sender) == "Idle")
        _jog(sender)
        believed = sender.state()[1]
        sender.close()
        assert server.end() == 130
        ended, left = server.ended, server.where()
    assert ended["lost_steps"] == {"x": 0, "y": 0, "z": 0}, ended["lost_steps"]
    assert ended["dry_queues"] == 0
    carriages, places = (
        tuple(each.values()) for each in (ended["carriages_mm"], left["position_mm"])
    )
    assert _is_near(carriages, believed), (carriages, believed)
    assert _is_near(places, believed), (places, believed)
    return found | {"at_mm": [round(mm, 3) for mm in places], "late_ticks": ended["late_ticks"]}
