"""The firmware put on a board: which, how, what is said where it fails; by a real avrdude too."""

import os
import shutil
import stat
import subprocess
import sys
import tty
from pathlib import Path

import pytest
from serial.tools.list_ports_common import ListPortInfo

from fraese.cli import flash
from fraese.cli.bridgeplace import Place
from fraese.config import Config
from fraese.errors import Cancelled, PortError, UsageError
from fraese.motor.bridge.boards import BOARDS, IMAGE_BAUD, boards_of, tries_of
from rigs import images
from tests.bridge.bootloader import BootLoader, image_bytes
from tests.bridge.device import reason_to_skip
from tests.bridge.stack import Stack

#: Where an Uno's boot loaders begin; a Mega has room for all.
_ROOM = {"uno": 30 * 1024, "mega": 248 * 1024}

AVRDUDE = shutil.which("avrdude")
#: Notes what it was called with, and ends as told: "fails on" what stands in its first argument.
FAKE = """#!{python}
import sys
from pathlib import Path
here = Path(__file__).parent
with (here / "called").open("a") as file:
    file.write(" ".join(sys.argv[1:]) + "\\n")
if (here / "fails").read_text() in " ".join(sys.argv):
    sys.stderr.write("avrdude: opening\\navrdude error: programmer is not responding\\n\\n")
    sys.exit(1)
"""


@pytest.fixture
def avrdude(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """One that only notes; its folder."""
    folder = tmp_path / "bin"
    folder.mkdir()
    program = folder / "avrdude"
    program.write_text(FAKE.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    (folder / "fails").write_text("never")
    monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)
    return folder


def _calls(avrdude: Path) -> list[str]:
    called = avrdude / "called"
    return called.read_text().splitlines() if called.exists() else []


def _place(device: str) -> Place:
    return Place(Config(), device, IMAGE_BAUD)


# --- images and boards ---------------------------------------------------------------------------


def test_every_board_has_a_whole_image_that_fits() -> None:
    for board in BOARDS.values():
        held = image_bytes(board.path)
        # From its first byte on, without a hole.
        assert sorted(held) == list(range(len(held)))
        assert 10_000 < len(held) <= _ROOM[board.image]


@pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())
@pytest.mark.parametrize("board", images.images())
def test_the_images_are_those_of_the_sources(board: str, tmp_path: Path) -> None:
    made_with = images.MADE_WITH.read_text("utf-8").strip()
    if images.compiler() != made_with:
        pytest.skip(f"the images were made with {made_with}, here is {images.compiler()}")
    kept = images.images()[board].read_text("ascii")
    assert images.built(board, tmp_path) == kept, "run make images"


def test_a_board_that_says_what_it_is_is_known_and_others_are_tried_in_turn() -> None:
    assert boards_of(0x2341, 0x0043) == ("uno",)
    assert boards_of(0x2341, 0x0042) == ("mega",)
    assert boards_of(0x1A86, 0x7523) == boards_of(None, None) == ("nano", "mega")
    tried = [(each.board.part, each.baud) for each in tries_of(("nano", "mega"))]
    assert tried == [("atmega328p", 115_200), ("atmega328p", 57_600), ("atmega2560", 115_200)]


def test_the_usb_device_behind_the_port_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    found = ListPortInfo("/dev/ttyACM7")
    found.vid, found.pid = 0x2341, 0x0042
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: [found])
    assert flash._seen("/dev/ttyACM7") == ("mega",)
    assert flash._seen("/dev/ttyACM8") == ("nano", "mega")


# --- what is called, and what is said ------------------------------------------------------------


def test_a_dry_run_says_what_would_be_called(
    avrdude: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = flash.flashed(_place("/dev/none"), "nano", yes=False, dry_run=True, as_json=False)
    assert code == 0
    first, second = capsys.readouterr().out.splitlines()
    image = BOARDS["nano"].path
    named = "avrdude -p atmega328p -c arduino -P /dev/none -b 115200"
    assert first == f"{named} -D -U flash:w:{image}:i"
    assert second == first.replace("115200", "57600")
    assert _calls(avrdude) == []


@pytest.mark.parametrize(
    ("platform", "how"),
    [("linux", "sudo apt install avrdude"), ("darwin", "brew install"), ("win32", "winget")],
)
def test_without_avrdude_it_says_how_to_get_it(
    platform: str, how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(sys, "platform", platform)
    with pytest.raises(UsageError, match=how):
        flash.flashed(_place("/dev/none"), "uno", yes=True, dry_run=False, as_json=False)


def test_what_is_in_the_way_is_said_before_anything_is_written(avrdude: Path) -> None:
    with pytest.raises(UsageError, match="--board due: is none of uno, nano, mega"):
        flash.flashed(_place("/dev/none"), "due", yes=True, dry_run=False, as_json=False)
    with pytest.raises(PortError, match="/dev/none does not exist"):
        flash.flashed(_place("/dev/none"), "uno", yes=True, dry_run=False, as_json=False)
    with BootLoader() as loader, pytest.raises(UsageError, match="add --yes"):
        flash.flashed(_place(loader.port), "uno", yes=False, dry_run=False, as_json=False)
    assert _calls(avrdude) == []


def test_nothing_is_written_unless_somebody_says_yes(
    avrdude: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Person:
        def isatty(self) -> bool:
            return True

        def readline(self) -> str:
            return "n\n"

    monkeypatch.setattr(sys, "stdin", Person())
    with BootLoader() as loader, pytest.raises(Cancelled, match="Nothing was written"):
        flash.flashed(_place(loader.port), "uno", yes=False, dry_run=False, as_json=False)
    assert _calls(avrdude) == []


def test_where_it_cannot_be_written_it_says_what_avrdude_said(avrdude: Path) -> None:
    (avrdude / "fails").write_text("-p")
    with BootLoader() as loader, pytest.raises(PortError, match="programmer is not responding"):
        flash.flashed(_place(loader.port), "nano", yes=True, dry_run=False, as_json=False)
    assert len(_calls(avrdude)) == 1


@pytest.mark.parametrize(
    ("speaks_v2", "called"), [(False, "atmega328p -c arduino"), (True, "atmega2560 -c wiring")]
)
def test_the_boot_loader_that_answers_is_written(
    speaks_v2: bool, called: str, avrdude: Path
) -> None:
    (avrdude / "fails").write_text("-p")
    with BootLoader(speaks_v2=speaks_v2) as loader, pytest.raises(PortError):
        flash.flashed(_place(loader.port), None, yes=True, dry_run=False, as_json=False)
    (call,) = _calls(avrdude)
    assert call.startswith(f"-p {called} -P {loader.port} -b 115200")


def test_a_port_on_which_none_answers_is_not_written(avrdude: Path) -> None:
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    with pytest.raises(PortError, match=r"No boot loader on .* answers: is it an Uno, a Nano"):
        flash.flashed(_place(os.ttyname(theirs)), None, yes=True, dry_run=False, as_json=False)
    os.close(ours)
    os.close(theirs)
    assert _calls(avrdude) == []


# --- whole ---------------------------------------------------------------------------------------


@pytest.mark.alone
@pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())
def test_a_board_that_was_written_is_tried_out(avrdude: Path, tmp_path: Path) -> None:
    """By an avrdude that only notes; what answers afterwards is the firmware, simulated."""
    (avrdude / "fails").write_text("-b 115200 -D -U flash:w:nowhere")
    folder = tmp_path / "machine"
    folder.mkdir()
    stack = Stack(folder)
    with stack.mill:
        done = subprocess.run(
            stack.words("bridge", "flash", "--board", "uno", "--yes")[:-2],
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
    assert done.returncode == 0, done.stderr
    assert "Arduino Uno: written and read back" in done.stderr
    assert "ok      damage: 16 damaged frames sent, 16 noticed" in done.stdout
    assert len(_calls(avrdude)) == 1


@pytest.mark.alone
@pytest.mark.skipif(AVRDUDE is None, reason="needs the Debian package avrdude")
def test_a_real_avrdude_takes_the_arguments_and_writes_all_of_it() -> None:
    (attempt,) = tries_of(("uno",))
    with BootLoader() as loader:
        assert flash._called(attempt.command(loader.port)) is None
        assert loader.left
    held = image_bytes(attempt.board.path)
    assert {at: loader.flash[at] for at in held} == held


@pytest.mark.alone
@pytest.mark.skipif(AVRDUDE is None, reason="needs the Debian package avrdude")
def test_another_chip_is_not_written() -> None:
    (attempt,) = tries_of(("uno",))
    with BootLoader(signature=bytes((0x1E, 0x98, 0x01))) as loader:
        said = flash._called(attempt.command(loader.port))
    assert said is not None
    assert "signature" in said
    assert loader.flash == {}
