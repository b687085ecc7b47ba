"""The app in a browser: another program stands between, and when that is gone the app goes, too."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

_SECONDS = 60


def packet(text: str) -> bytes:
    """What is typed, as who serves the app sends it."""
    data = text.encode()
    return b"D" + len(data).to_bytes(4, "big") + data


@pytest.mark.alone
def test_a_served_app_that_nobody_serves_any_more_brakes_and_goes(tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "TEXTUAL_DRIVER": "textual.drivers.web_driver:WebDriver",
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "COLUMNS": "80",
        "ROWS": "24",
    }
    app = subprocess.Popen(
        [sys.executable, "-m", "fraese"],
        env=environment,
        cwd=tmp_path,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert app.stdin is not None
    assert app.stdout is not None
    drawn = threading.Event()

    def look() -> None:
        assert app.stdout is not None
        seen = b""
        for part in iter(lambda: os.read(app.stdout.fileno(), 4096), b""):  # type: ignore[union-attr]
            seen = seen[-4096:] + part
            if b"Stop" in seen:
                drawn.set()

    watcher = threading.Thread(target=look, daemon=True)
    watcher.start()
    try:
        assert drawn.wait(_SECONDS), "no picture came"
        app.stdin.write(packet("5") + packet("\x1b[C") * 10)
        app.stdin.close()
        assert app.wait(_SECONDS) == 128 + 15
    finally:
        app.kill()
        app.wait()
        watcher.join(_SECONDS)
        app.stdout.close()
