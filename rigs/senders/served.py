"""``fraese serve`` on the simulated mill, in a process of its own, and what became of the mill."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

_FRAESE = (sys.executable, "-m", "fraese")


@dataclass
class Served:
    """A running server.

    Attributes:
        process: it.
        folder: where its state is.
        at: where senders find it: the pseudo-terminal, then the port, if there is one.
        ended: what it said of the machine at its end.
    """

    process: subprocess.Popen[str]
    folder: Path
    at: list[str]
    ended: dict[str, Any] = field(default_factory=dict)

    def end(self) -> int:
        """As by Ctrl+C; its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            out, _ = self.process.communicate(timeout=20)
            self.ended = json.loads(out.splitlines()[-1])
        return self.process.wait(timeout=20)

    def where(self) -> dict[str, Any]:
        """How the mill was left, by ``fraese where``."""
        done = subprocess.run(
            [*_FRAESE, "where", "--json", "--state", str(self.folder)],
            capture_output=True,
            text=True,
            check=True,
            cwd=self.folder,
        )
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return found


@contextmanager
def served(folder: Path, *options: str) -> Iterator[Served]:
    """A server on a mill that has been referenced; ended on every way out."""
    folder.mkdir(parents=True, exist_ok=True)
    state = ("--state", str(folder))
    subprocess.run([*_FRAESE, "home", *state], check=True, capture_output=True, cwd=folder)
    with (folder / "said").open("w") as said:
        process = subprocess.Popen(
            [*_FRAESE, "serve", "--json", *state, "--link", str(folder / "mill"), *options],
            stdout=subprocess.PIPE,
            stderr=said,
            text=True,
            cwd=folder,
        )
    assert process.stdout is not None
    try:
        first = process.stdout.readline()
        assert first, (folder / "said").read_text()
        server = Served(process, folder, json.loads(first)["at"])
        yield server
        server.end()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        process.stdout.close()
