"""Program files that change, vanish, are none: what was opened is what runs."""

import os
import socket
import threading
from pathlib import Path

import pytest

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.errors import ProgramError
from fraese.program import content
from fraese.program.content import take
from fraese.program.program import open_program
from tests.helpers import carriages, homed, program, run_program

FIRST = (
    "G21 G90 F3000\n" + "".join(f"G1 X{n % 50} Y{n % 7}\n" for n in range(1, 400)) + "X5 Y3\nM2\n"
)


def way(text: str, tmp_path: Path) -> list[tuple[float, ...]]:
    """Where the carriages are from slice to slice, undisturbed."""
    made = homed()
    return watched(made, tmp_path, text, lambda path: None)[1]


def watched(
    made: Plant, folder: Path, text: str, meddle: object, at: int = 40
) -> tuple[Status, list[tuple[float, ...]], list[str]]:
    told: list[str] = []
    places: list[tuple[float, ...]] = []
    part = program(folder, text)
    slices = 0

    def look() -> None:
        nonlocal slices
        slices += 1
        places.append(carriages(made))
        if slices == at:
            meddle(part.path)  # type: ignore[operator]

    made.controller.set_tell(told.append)
    made.controller.set_break_key(look)
    return run_program(made, part), places, told


def insert(path: Path) -> None:
    """In place, one byte in front: everything behind it is read elsewhere."""
    path.write_text("1" + path.read_text())


def truncate(path: Path) -> None:
    os.truncate(path, 1000)


def replace(path: Path) -> None:
    path.write_text("G0 X221 Y150\n" * 1000)


def remove(path: Path) -> None:
    path.unlink()


@pytest.mark.parametrize("meddle", [insert, truncate, replace, remove], ids=lambda f: f.__name__)
def test_a_file_that_changes_under_a_running_job_changes_nothing(
    tmp_path: Path, meddle: object
) -> None:
    # Longer than any buffer between file and motors.
    text = FIRST.replace("M2\n", "(" + "x" * 3000 + ")\n" * 1) + "(y)\n" * 30_000 + "G1 X7 Y2\nM2\n"
    undisturbed = way(text, tmp_path)
    made = homed()
    status, places, told = watched(made, tmp_path, text, meddle)
    assert status is Status.OK
    assert places == undisturbed
    assert carriages(made)[:2] == undisturbed[-1][:2]
    assert any("What runs is what it held when it was opened" in said for said in told)


def test_what_was_looked_through_is_what_runs(tmp_path: Path) -> None:
    made = homed()
    zero = carriages(made)
    told: list[str] = []
    made.controller.set_tell(told.append)
    part = program(tmp_path, "G21 G90 G1 X5 F600\nM2\n")
    facts = part.check(made.controller)
    part.path.write_text("G21 G90 G1 X100 F600\nM2\n")
    part.start(made.controller, facts)
    assert made.controller.run() is Status.OK
    assert carriages(made)[0] - zero[0] == 5 * 200
    assert told[0].startswith("part.ngc has changed on disk since it was opened")


def test_a_subroutine_file_is_the_one_that_was_looked_through(tmp_path: Path) -> None:
    made = homed()
    zero = carriages(made)
    sub, late = tmp_path / "hop.ngc", tmp_path / "late.ngc"
    sub.write_text("o<hop> sub\nG1 X5 F600\no<hop> endsub\n")
    part = program(
        tmp_path, "G21 G90\no<hop> call\no<late> call\nM2\no<late> sub\no<late> endsub\n"
    )
    part.check(made.controller)
    sub.write_text("o<hop> sub\nG1 X100 F600\no<hop> endsub\n")
    late.write_text("o<late> sub\nG1 X200 F600\no<late> endsub\n")
    part.start(made.controller)
    assert made.controller.run() is Status.OK
    assert carriages(made)[0] - zero[0] == 5 * 200


def test_the_same_text_written_again_is_no_news(tmp_path: Path) -> None:
    part = program(tmp_path, "G0 X1\n")
    assert part.news() == ""
    part.path.write_text("G0 X1\n")
    os.utime(part.path, ns=(1, 1))
    assert part.news() == ""
    part.path.write_text("G0 X2\n")
    assert "has changed" in part.news()
    part.path.unlink()
    assert "is gone" in part.news()
    part.path.mkdir()
    assert "has changed" in part.news() or "is gone" in part.news()


def test_a_file_that_is_being_written_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G0 X1\n")
    real = content.taken_from

    def grows(*values: object) -> content.Content:
        with path.open("a") as file:
            file.write("G0 X2\n")
        return real(*values)  # type: ignore[arg-type]

    monkeypatch.setattr(content, "taken_from", grows)
    with pytest.raises(ProgramError, match="is being written just now"):
        open_program(path)


def test_one_that_was_written_once_more_is_taken_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G0 X1\n")
    real, once = content.taken_from, [True]

    def grows(*values: object) -> content.Content:
        if once:
            once.clear()
            path.write_text("G0 X2\nG0 X3\n")
        return real(*values)  # type: ignore[arg-type]

    monkeypatch.setattr(content, "taken_from", grows)
    assert list(open_program(path).lines) == ["G0 X2", "G0 X3"]


# --- what is no program file ---------------------------------------------------------------------


def test_what_is_no_plain_file_is_refused_at_once(tmp_path: Path) -> None:
    pipe, door = tmp_path / "pipe.nc", tmp_path / "door.nc"
    os.mkfifo(pipe)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(door))
        for path in (pipe, door, Path("/dev/zero"), Path("/dev/tty")):
            with pytest.raises(ProgramError, match="is a pipe or a device"):
                open_program(path)
    with pytest.raises(ProgramError, match="is a folder"):
        open_program(tmp_path)
    (tmp_path / "round").symlink_to("round")
    with pytest.raises(ProgramError, match="cannot be read"):
        open_program(tmp_path / "round")
    for name in ("a" * 5000, "nul\0", "part/of/nothing", "\ud800"):
        with pytest.raises(ProgramError, match="there is no such file") as caught:
            open_program(tmp_path / name)
        assert len(str(caught.value)) < 400


def test_a_subroutine_that_is_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "hop.ngc")
    made = homed()
    for call, said in (("hop", "is a pipe"), ("a" * 4000, "there is no such subroutine")):
        with pytest.raises(ProgramError, match=said):
            program(tmp_path, f"o<{call}> call\n").check(made.controller)


def test_a_file_larger_than_any_program_is_not_copied(tmp_path: Path) -> None:
    path = tmp_path / "huge.nc"
    with path.open("wb") as file:
        file.truncate(content.MOST_BYTES + 1)
    with pytest.raises(ProgramError, match="is larger than 1024 MB"):
        open_program(path)


def test_a_full_disk_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "part.nc"
    path.write_bytes(b"G0 X1\n" * 1_000_000)

    def full(*values: object, **options: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.TemporaryFile", full)
    with pytest.raises(ProgramError, match="cannot be copied: No space left on device"):
        open_program(path)


@pytest.mark.parametrize("size", [0, 1, 4096, content._IN_MEMORY_BYTES + 12_345])
def test_a_copy_is_read_by_several_at_once(tmp_path: Path, size: int) -> None:
    path = tmp_path / "part.nc"
    data = bytes(range(1, 255)) * (size // 254 + 1)
    path.write_bytes(data[:size])
    copy = take(path)
    assert copy is not None
    assert copy.size == size
    read: list[bytes] = []

    def look() -> None:
        with copy.open() as stream:
            read.append(b"".join(iter(lambda: stream.read(7_001), b"")))

    threads = [threading.Thread(target=look) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert read == [data[:size]] * 4
