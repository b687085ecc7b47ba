"""A sender at a machine that the app has: it is seen, it is stopped, and somebody takes over."""

import os
import select
import threading
from pathlib import Path

from fraese.cli.appserving import AppSenders
from fraese.config.serving import ServeConfig
from fraese.serve.access import Access
from fraese.serve.settings import Changes
from fraese.serve.store import Store
from tests.ui.helpers import Bench, bench, play


def _unwritten(changes: Changes) -> str:
    return ""


class Sender:
    """At the pseudo-terminal."""

    def __init__(self, link: Path) -> None:
        self._fd = os.open(link, os.O_RDWR | os.O_NOCTTY)
        self.heard = b""
        self._leaves = False
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        while not self._leaves:
            if select.select([self._fd], [], [], 0.02)[0]:
                self.heard += os.read(self._fd, 4096)

    def say(self, text: str) -> None:
        os.write(self._fd, text.encode())

    def close(self) -> None:
        # Who reads keeps it open.
        self._leaves = True
        self._thread.join()
        os.close(self._fd)


def _let_in(b: Bench, link: Path) -> None:
    senders = AppSenders(
        b.plant.controller, Store(None), _unwritten, ServeConfig(link=str(link)), Access((), "")
    )
    senders.go_by(b.app.link)
    senders.start()


def _strip(b: Bench) -> str:
    return b.text("#work")


def test_who_drives_is_seen_and_a_stop_takes_the_machine(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            _let_in(b, tmp_path / "mill")
            sender = Sender(tmp_path / "mill")
            await b.wait(lambda: b"to unlock" in sender.heard)
            await b.wait(lambda: "SENDER mill" in _strip(b))
            sender.say("$X\nG1 X50 F600\n")
            await b.wait(lambda: b.drawn.position_mm[0] > 1)
            await b.press("escape")
            await b.wait(lambda: b"ALARM:3" in sender.heard)
            await b.wait(lambda: not b.app.link.moving)
            assert b.drawn.position_mm[0] < 40
            before = b.drawn.position_mm[0]
            sender.say("G0 X0\n")
            await b.wait(lambda: b"error:9" in sender.heard)
            assert b.drawn.position_mm[0] == before
            sender.close()
            await b.wait(lambda: "SENDER" not in _strip(b))

    play(scene)


def test_one_key_takes_over_and_gives_back(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench() as b:
            _let_in(b, tmp_path / "mill")
            sender = Sender(tmp_path / "mill")
            await b.wait(lambda: b"to unlock" in sender.heard)
            await b.press("O")
            await b.wait(lambda: "SENDER OUT" in _strip(b))
            sender.say("$X\n$H\nG0 X1\n")
            await b.wait(lambda: sender.heard.count(b"error:9") == 3)
            await b.press("right")
            await b.wait(lambda: b.drawn.position_mm[0] > 0)
            await b.press("O")
            await b.wait(lambda: "SENDER mill" in _strip(b))
            sender.say("$X\n")
            await b.wait(lambda: b"ok" in sender.heard)
            sender.close()

    play(scene)


def test_without_a_sender_there_is_nothing_to_take(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("O")
            await b.wait(lambda: "No sender is connected" in b.text("#message"))

    play(scene)
