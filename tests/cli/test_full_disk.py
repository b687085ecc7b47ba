"""A disk that is really full, or can only be read: what is said, and what the machine does.

At random moments in mid-job, against a truth from outside: ``make campaign``.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("pty")

from bench.campaign.mounts import fill, missing, mounted, small
from fraese.journal import Journal, machine_file
from tests.terminals import Pty

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

FRAESE = [sys.executable, "-m", "fraese"]
FULL = "No space left on device"
PART = "G21 G90\n(MSG,here)\nG0 X5\nG1 X9 F600\nM2\n"


class Shop:
    """A user whose state lies on a disk of its own."""

    def __init__(self, folder: Path, disk: Path) -> None:
        self.folder, self.disk = folder, disk
        self.state = disk / "fraese"
        (folder / "part.ngc").write_text(PART)
        self.environment = {
            **os.environ,
            "TERM": "xterm-256color",
            "XDG_CONFIG_HOME": str(folder / "config"),
            "XDG_STATE_HOME": str(disk),
            "PYTHONPATH": os.environ.get("PYTHONPATH") or str(Path(__file__).parents[2]),
        }

    def begin(self, *words: object) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [*FRAESE, *map(str, words)],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def end(self, process: "subprocess.Popen[str]") -> tuple[int, str, str]:
        said, noted = process.communicate(timeout=60)
        assert "Traceback" not in noted
        return process.returncode, said, noted

    def do(self, *words: object) -> tuple[int, str, str]:
        return self.end(self.begin(*words))

    def x_mm(self) -> tuple[float, bool]:
        """Where it is for whoever looks, and whether it is referenced."""
        code, said, noted = self.do("where", "--json")
        assert code == 0, noted
        place = json.loads(said)
        assert place["doubt"] is None
        return place["position_mm"]["x"], place["referenced"]["x"]


@pytest.fixture
def shop(tmp_path: Path) -> Iterator[Shop]:
    with small(tmp_path / "disk", 300) as disk:
        yield Shop(tmp_path, disk)


@pytest.mark.parametrize("words", [("run", "part.ngc"), ("jog", "x", 1), ("home",), ("zero", "x")])
def test_full_from_the_start_it_is_refused_and_nothing_is_left(
    shop: Shop, words: tuple[object, ...]
) -> None:
    fill(shop.disk)
    code, said, noted = shop.do(*words, "--json")
    assert code == 2
    assert json.loads(said)["status"] == "refused"
    assert noted.startswith("fraese: ")
    assert FULL in noted
    assert noted.count("\n") == 1
    assert not machine_file(shop.state, "simulation", "").exists()
    assert shop.x_mm() == (0, False)


def test_full_after_the_first_start_all_goes_on_and_nothing_is_lost(shop: Shop) -> None:
    assert shop.do("home")[0] == 0
    fill(shop.disk)
    code, said, noted = shop.do("run", "part.ngc", "--json")
    assert code == 0
    assert json.loads(said)["status"] == "done"
    assert f"part.ngc: no copy can be kept: {FULL}" in noted
    assert shop.x_mm() == (9, True)
    assert shop.do("jog", "x", -2)[0] == 0
    assert shop.x_mm() == (7, True)
    assert shop.do("zero", "x")[0] == 0
    # Without a copy nothing can be gone on with, and that is said.
    code, _, noted = shop.do("resume")
    assert code == 2
    assert noted.startswith("fraese: ")


@pytest.mark.parametrize("trace", [True, False])
def test_it_fills_while_a_program_runs(shop: Shop, trace: bool) -> None:
    """Log and waveform are on it too: they end, the job does not."""
    (shop.folder / "fraese.toml").write_text("[log]\nenabled = true\n")
    assert shop.do("home")[0] == 0
    waveform = shop.disk / "w.vcd"
    options = ("--trace", waveform) if trace else ()
    process = shop.begin("run", "part.ngc", "--real-time", "--json", *options)
    journal = Journal(machine_file(shop.state, "simulation", ""))
    until_s = time.monotonic() + 30
    while time.monotonic() < until_s:
        found = journal.read()
        if found and json.loads(found.payload)["motion"]:
            break
        time.sleep(0.01)
    fill(shop.disk)
    code, said, noted = shop.end(process)
    assert code == 0, noted
    assert json.loads(said)["status"] == "done"
    assert shop.x_mm() == (9, True)
    if trace:
        assert json.loads(said)["trace"]["failure"]
        assert FULL in noted


def test_a_waveform_that_cannot_be_begun_is_refused(shop: Shop) -> None:
    assert shop.do("home")[0] == 0
    fill(shop.disk)
    code, said, noted = shop.do("jog", "x", 1, "--json", "--trace", shop.disk / "w.vcd")
    assert code == 2
    assert json.loads(said)["status"] == "refused"
    assert f"the waveform cannot be written: {FULL}" in noted
    assert shop.x_mm() == (0, True)


def test_a_log_that_has_no_room_is_nobodys_fault(shop: Shop) -> None:
    fill(shop.disk)
    (shop.folder / "fraese.toml").write_text(
        f"[log]\nenabled = true\nfile = '{shop.disk / 'the.log'}'\n"
    )
    code, _, noted = shop.do("run", "part.ngc", "--state", shop.folder / "elsewhere")
    assert code == 0, noted


def test_a_disk_that_can_only_be_read_can_be_looked_at(shop: Shop) -> None:
    assert shop.do("home")[0] == 0
    assert shop.do("jog", "x", 3)[0] == 0
    subprocess.run(["mount", "-o", "remount,ro", shop.disk], check=True)
    assert shop.x_mm() == (3, True)
    for words in (("jog", "x", 1), ("run", "part.ngc"), ("where", "--fresh")):
        code, said, noted = shop.do(*words, "--json")
        assert code == 2, words
        assert json.loads(said)["status"] == "refused"
        assert "Read-only file system" in noted
    assert shop.do("check", "part.ngc")[0] == 0
    assert shop.x_mm() == (3, True)


def test_a_folder_on_a_disk_that_can_only_be_read(tmp_path: Path) -> None:
    """It was never there."""
    with mounted(tmp_path / "disk", "-t", "tmpfs", "-o", "ro", "tmpfs") as disk:
        shop = Shop(tmp_path, disk)
        code, _, noted = shop.do("jog", "x", 1)
        assert code == 2
        assert "Read-only file system" in noted
        assert shop.x_mm() == (0, False)


# --- the app -------------------------------------------------------------------------------------


def test_the_app_does_not_start_where_nothing_can_be_kept(shop: Shop) -> None:
    fill(shop.disk)
    pty = Pty(FRAESE, shop.folder, shop.environment)
    try:
        assert pty.end(reading=True) == 2
        assert FULL.encode() in pty.drawn
        assert b"Traceback" not in pty.drawn
    finally:
        pty.close()


@pytest.mark.alone
def test_the_app_goes_on_while_the_disk_fills(shop: Shop) -> None:
    assert shop.do("home")[0] == 0
    pty = Pty(FRAESE, shop.folder, shop.environment)
    try:
        pty.read_until(b"Hold")
        fill(shop.disk)
        pty.type(b"5\x1b[C")
        pty.read_until(b"mm/min")
        while pty.read(1.5):
            pass
        pty.type(b"\x11")
        assert pty.end(reading=True) == 0, pty.drawn[-2000:]
    finally:
        pty.close()
    assert shop.x_mm() == (10, True)
