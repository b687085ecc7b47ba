"""grbl-streamer (PyPI), the module that gerbil became: it counts characters."""

from pathlib import Path
from typing import Any

from rigs.senders.scenario import Place, wait


class Streamer:
    """It, driven by its own methods."""

    name = "grbl-streamer"

    def __init__(self) -> None:
        from grbl_streamer import GrblStreamer

        self._booted = False
        self.errors: list[Any] = []
        self._it: Any = GrblStreamer(self._event)
        self._it.poll_interval = 0.05

    def _event(self, event: str, *data: Any) -> None:
        self._booted = self._booted or event == "on_boot"
        if event == "on_error":
            self.errors.append(data)

    def connect(self, port: str) -> None:
        self._it.setup_logging()
        self._it.cnect(port, 115_200)
        wait("booted", lambda: self._booted)
        self._it.poll_start()

    def state(self) -> tuple[str, Place]:
        return self._it.cmode or "", tuple(self._it.cmpos)

    def send(self, line: str) -> None:
        self._it._iface_write(line + "\n")

    def stream(self, path: Path) -> None:
        self._it.job_new()
        self._it.load_file(str(path))
        self._it.job_run()

    def is_sent(self) -> bool:
        assert not self.errors, self.errors
        return bool(self._it.streaming_complete)

    def hold(self) -> None:
        self._it.hold()

    def resume(self) -> None:
        self._it.resume()

    def reset(self) -> None:
        self._it.abort()

    def unlock(self) -> None:
        self._it.killalarm()

    def close(self) -> None:
        if self._it.is_connected():
            self._it.disconnect()
