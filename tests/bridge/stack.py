"""Commands in processes of their own, and the bridge that they drive: firmware, port and mill."""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from fraese.config import Config
from fraese.config.file import load
from tests.bridge.ptymill import PtyMill

#: A small mill: 4 mm of travel are 800 steps.
SETTINGS = """
[port]
kind = "bridge"
device = "{device}"
[axes.x]
travel_mm = 8
[axes.y]
travel_mm = 8
[axes.z]
travel_mm = 8
"""
PATIENCE_S = 60


class Stack:
    """A shell in which commands are given, and a mill beside it.

    Args:
        folder: for configuration, state and the serial port.
        settings: the configuration.
        popen: what starts a process.

    Attributes:
        mill: with the firmware.
        device: its serial port.
    """

    def __init__(
        self, folder: Path, settings: str = SETTINGS, popen: Any = subprocess.Popen
    ) -> None:
        self._popen = popen
        self._folder = folder
        self._config = folder / "fraese.toml"
        self._config.write_text(settings.format(device=folder / "ttySIM"))
        self.mill = PtyMill(folder, self.config)
        self.device = self.mill.port

    @property
    def config(self) -> Config:
        return load(self._config)

    def words(self, *words: str) -> list[str]:
        """A command of this machine; without any, the app."""
        place = ["--config", str(self._config), "--state", str(self._folder / "state")]
        return [sys.executable, "-m", "fraese", *words, *place]

    def start(self, *words: str) -> "subprocess.Popen[str]":
        process: subprocess.Popen[str] = self._popen(
            self.words(*words),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        return process

    def run(self, *words: str) -> "subprocess.CompletedProcess[str]":
        with self.start(*words) as process:
            try:
                out, err = process.communicate(timeout=PATIENCE_S)
            finally:
                process.kill()
        return subprocess.CompletedProcess(words, process.returncode, out, err)

    def bridge(self, *words: str) -> "subprocess.CompletedProcess[str]":
        return self.fraese("bridge", *words, "--config", str(self._config))

    def fraese(self, *words: str) -> "subprocess.CompletedProcess[str]":
        command = [sys.executable, "-m", "fraese", *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)


def until_moving(stack: Stack, beyond_steps: float) -> None:
    before = stack.mill.carriages_steps()[0]
    deadline_s = time.monotonic() + PATIENCE_S
    while abs(stack.mill.carriages_steps()[0] - before) < beyond_steps:
        assert time.monotonic() < deadline_s, "nothing moves"
        time.sleep(0.005)
