"""bCNC (PyPI): the whole program on a screen that nobody sees, driven by its own pendant page."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.parse
import urllib.request
from pathlib import Path
from typing import Any, Final

from rigs.senders.scenario import Place, wait

_INI: Final = """\
[Connection]
port = {port}
baud = 115200
pendant = 1
pendantport = {number}
openserial = 1
errorreport = 0
controller = GRBL1
"""
#: It says of no file that it is through: so long it has been idle then.
_IDLE_S: Final = 2.0


class Bcnc:
    """It, by the page that it has for telephones.

    Args:
        folder: for its configuration.
    """

    name = "bCNC"

    def __init__(self, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self._number = free.getsockname()[1]
        self._folder = folder
        self._log = (folder / "bcnc.log").open("w")
        self._it: subprocess.Popen[bytes] | None = None
        self._idle_since_s: float | None = None

    def connect(self, port: str) -> None:
        ini = self._folder / ".bCNC"
        ini.write_text(_INI.format(port=port, number=self._number))
        self._it = subprocess.Popen(
            ["xvfb-run", "-a", sys.executable, "-m", "bCNC", "-s", port, "-b", "115200"],
            env={**os.environ, "HOME": str(self._folder)},
            stdout=self._log, stderr=self._log, cwd=self._folder, start_new_session=True,
        )  # fmt: skip
        wait("the page is there", self._answers, 60)

    def _answers(self) -> bool:
        try:
            return bool(self.state())
        except OSError:
            return False

    def _get(self, page: str) -> bytes:
        with urllib.request.urlopen(f"http://localhost:{self._number}{page}", timeout=5) as said:
            return bytes(said.read())

    def _command(self, words: str) -> None:
        self._get("/send?" + urllib.parse.urlencode({"cmd": words}))

    def state(self) -> tuple[str, Place]:
        told: dict[str, Any] = json.loads(self._get("/state"))
        return str(told["state"]), tuple(float(told["m" + axis]) for axis in "xyz")

    def send(self, line: str) -> None:
        self._get("/send?" + urllib.parse.urlencode({"gcode": line}))

    def stream(self, path: Path) -> None:
        self._idle_since_s = None
        self._command(f"LOAD {path}")
        time.sleep(2)
        self._command("RUN")

    def is_sent(self) -> bool:
        if self.state()[0] != "Idle":
            self._idle_since_s = None
            return False
        self._idle_since_s = self._idle_since_s or time.monotonic()
        return time.monotonic() - self._idle_since_s > _IDLE_S

    def hold(self) -> None:
        self._command("FEEDHOLD")

    def resume(self) -> None:
        self._command("RESUME")

    def reset(self) -> None:
        self._command("RESET")

    def unlock(self) -> None:
        # To it the run goes on until somebody stops it.
        self._command("STOP")
        time.sleep(3)
        self._command("UNLOCK")

    def close(self) -> None:
        if self._it is not None and self._it.poll() is None:
            os.killpg(self._it.pid, signal.SIGTERM)
            self._it.wait(timeout=10)
        self._log.close()
