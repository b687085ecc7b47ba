"""cncjs (npm): its server as it is, and at its socket what stands for its web page."""

import json
import os
import socket
import subprocess
import threading
import time
import urllib.request
from pathlib import Path
from typing import Any, Final

from rigs.senders.scenario import Place, wait

_SCRIPT: Final = Path(__file__).with_suffix(".js")
_BAUD: Final = 115_200


class Cncjs:
    """It, as a browser drives it.

    Args:
        modules: folder ``node_modules`` in which it is installed.
        folder: for its configuration.
    """

    name = "cncjs"

    def __init__(self, modules: Path, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            number = free.getsockname()[1]
        url = f"http://127.0.0.1:{number}"
        config = folder / "cncrc"
        self._log = (folder / "cncjs.log").open("w")
        self._server = subprocess.Popen(
            ["node", str(modules / "cncjs" / "bin" / "cncjs"), "-p", str(number),
             "-H", "127.0.0.1", "-c", str(config)],
            stdout=self._log, stderr=self._log, env={**os.environ, "HOME": str(folder)},
        )  # fmt: skip
        self._port = ""
        self._seen: dict[str, Any] = {}
        self.heard: list[str] = []
        self._page: subprocess.Popen[str] | None = None
        token = self._token(url)
        self._page = subprocess.Popen(
            ["node", str(_SCRIPT), url, token],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "NODE_PATH": str(modules)},
        )  # fmt: skip
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        wait("the page is connected", lambda: "connect" in self._seen)

    def _token(self, url: str) -> str:
        until_s = time.monotonic() + 30
        while True:
            try:
                body = urllib.request.Request(
                    f"{url}/api/signin", b"{}", {"Content-Type": "application/json"}
                )
                with urllib.request.urlopen(body, timeout=5) as answer:
                    return str(json.load(answer)["token"])
            except OSError:
                assert time.monotonic() < until_s, Path(self._log.name).read_text()
                time.sleep(0.2)

    def _listen(self) -> None:
        assert self._page is not None
        assert self._page.stdout is not None
        for line in self._page.stdout:
            event, *data = json.loads(line)
            self._seen[event] = data
            if event == "serialport:read":
                self.heard.append(str(data[0]))

    def _say(self, *words: Any) -> None:
        assert self._page is not None
        assert self._page.stdin is not None
        self._page.stdin.write(json.dumps(words) + "\n")
        self._page.stdin.flush()

    def _command(self, *words: Any) -> None:
        self._say("command", self._port, *words)

    def connect(self, port: str) -> None:
        self._port = port
        self._say("open", port, {"controllerType": "Grbl", "baudrate": _BAUD})
        wait("the port is open", lambda: "serialport:open" in self._seen)
        wait("it knows the state", lambda: bool(self.state()[0]))

    def state(self) -> tuple[str, Place]:
        told = self._seen.get("controller:state", ["", {}])[1].get("status", {})
        place = told.get("mpos", {})
        return told.get("activeState", ""), tuple(float(place.get(axis, 0)) for axis in "xyz")

    def send(self, line: str) -> None:
        self._command("gcode", line)

    def stream(self, path: Path) -> None:
        self._seen.pop("sender:status", None)
        self._command("gcode:stop")
        self._command("gcode:load", path.name, path.read_text())
        self._command("gcode:start")

    def is_sent(self) -> bool:
        errors = [line for line in self.heard if line.startswith("error")]
        assert not errors, errors
        told = self._seen.get("sender:status", [{}])[0]
        return bool(told.get("total")) and told.get("received") == told.get("total")

    def hold(self) -> None:
        self._command("feedhold")

    def resume(self) -> None:
        self._command("cyclestart")

    def reset(self) -> None:
        self._command("reset")

    def unlock(self) -> None:
        self._command("unlock")

    def close(self) -> None:
        if self._page is not None and self._page.stdin is not None and not self._page.stdin.closed:
            self._say("close", self._port)
            time.sleep(0.5)
            self._page.stdin.close()
            self._page.wait(timeout=10)
            self._listener.join(timeout=10)
            assert self._page.stdout is not None
            self._page.stdout.close()
        self._server.terminate()
        self._server.wait(timeout=10)
        self._log.close()
