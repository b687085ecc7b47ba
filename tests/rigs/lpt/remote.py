"""A port that lives in a process of its own, spoken to over a pipe.

    test --["write_data", [73]]--> worker (preloaded) --> PpdevPort --> fake port
         <----------[null]--------                   or <--["PortError", "sentence"]

So a contract suite in this process can be held against a port that needs a preloaded one. The same
file is both ends: ``python -m tests.rigs.lpt.remote`` is the worker.
"""

import json
import sys
from functools import partial
from typing import IO, Any, Protocol

from fraese.errors import PortError
from fraese.motor.ports.devport import DevPort
from fraese.motor.ports.ppdev import PpdevPort
from fraese.motor.seams import Port

#: What the configuration calls them.
PORTS = {"ppdev": PpdevPort, "devport": DevPort}


class Process(Protocol):
    """What is used of ``subprocess.Popen``."""

    pid: int

    @property
    def stdin(self) -> IO[str] | None: ...

    @property
    def stdout(self) -> IO[str] | None: ...

    def kill(self) -> None: ...

    def communicate(self) -> object: ...


class Launcher(Protocol):
    """Starts a Python module where the port is: a fake port, or a guest's own."""

    def start(self, *arguments: str) -> Process: ...


class RemotePort:
    """The port of that kind, opened by a worker.

    Raises:
        PortError: whatever the worker's port says.
    """

    def __init__(self, launcher: Launcher, kind: str, *arguments: object) -> None:
        self._worker = launcher.start("tests.rigs.lpt.remote")
        self.pid = self._worker.pid
        try:
            self._ask(kind, *arguments)
        except PortError:
            self.quit()
            raise

    def write_data(self, value: int) -> None:
        self._ask("write_data", value)

    def write_control(self, value: int) -> None:
        self._ask("write_control", value)

    def read_status(self) -> int:
        return int(self._ask("read_status"))

    def close(self) -> None:
        self._ask("close")

    def quit(self) -> None:
        """The worker ends, without closing its port by itself."""
        self._worker.kill()
        self._worker.communicate()

    def _ask(self, what: str, *arguments: object) -> Any:
        assert self._worker.stdin is not None
        assert self._worker.stdout is not None
        self._worker.stdin.write(json.dumps([what, arguments]) + "\n")
        self._worker.stdin.flush()
        answer = json.loads(self._worker.stdout.readline())
        if answer[0] == "PortError":
            raise PortError(answer[1])
        return answer[0]


def main() -> None:
    """Open the port that the first line names, then do what the others say."""
    port: Port | None = None
    for line in sys.stdin:
        what, arguments = json.loads(line)
        action = partial(PORTS[what], *arguments) if port is None else getattr(port, what)
        answer: list[object]
        try:
            if port is None:
                port, answer = action(), [None]
            else:
                answer = [action(*arguments)]
        except PortError as error:
            answer = ["PortError", str(error)]
        print(json.dumps(answer), flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
