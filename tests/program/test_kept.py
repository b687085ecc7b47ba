"""Copies of the programs that ran last."""

import os
import stat
from pathlib import Path

import pytest

from fraese.control.state import Status
from fraese.errors import ProgramError
from fraese.program import kept
from fraese.program.kept import KeptPrograms
from fraese.program.program import Program, open_program
from tests.helpers import carriages, homed

TEXT = "G21 G90\no<hop> call\nM2\n"


def written(folder: Path, name: str = "part.ngc", text: str = TEXT) -> Path:
    (folder / "hop.ngc").write_text("o<hop> sub\nG1 X5 F600\no<hop> endsub\n")
    path = folder / name
    path.write_text(text)
    return path


def test_what_ran_runs_again_when_everything_else_is_gone(tmp_path: Path) -> None:
    state = tmp_path / "state"
    made = homed()
    zero = carriages(made)
    path = written(tmp_path)
    part = open_program(path, kept=KeptPrograms(state))
    part.check(made.controller)
    part.start(made.controller)
    assert made.controller.run() is Status.OK
    path.unlink()
    (tmp_path / "hop.ngc").write_text("o<hop> sub\nG1 X100 F600\no<hop> endsub\n")
    again = Program(KeptPrograms(state).find(part.content_hash))
    assert again.name == "part.ngc"
    assert again.news() == "part.ngc is gone from where it was opened."
    made = homed()
    again.check(made.controller)
    again.start(made.controller)
    assert made.controller.run() is Status.OK
    assert carriages(made)[0] - zero[0] == 5 * 200


def test_nobody_else_reads_it_and_no_link_is_followed(tmp_path: Path) -> None:
    state, victim = tmp_path / "state", tmp_path / "victim"
    victim.write_text("mine")
    part = open_program(written(tmp_path))
    (state / "jobs").mkdir(parents=True, mode=0o700)
    for end in ("", ".new", ".json", ".json.new"):
        (state / "jobs" / (part.content_hash + end)).symlink_to(victim)
    before = os.umask(0)
    try:
        KeptPrograms(state).keep(part.taken)
    finally:
        os.umask(before)
    assert victim.read_text() == "mine"
    names = sorted(path.name for path in (state / "jobs").iterdir())
    assert names == [part.content_hash, part.content_hash + ".json"]
    for path in (state / "jobs").iterdir():
        assert stat.S_IMODE(path.lstat().st_mode) == 0o600
        assert not path.is_symlink()
    assert KeptPrograms(state).find(part.content_hash).main.content_hash == part.content_hash


def test_folders_are_nobody_elses(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        KeptPrograms(tmp_path / "state").keep(open_program(written(tmp_path)).taken)
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "state" / "jobs").stat().st_mode) == 0o700


def test_only_the_last_few_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = KeptPrograms(tmp_path / "state")
    parts = [open_program(written(tmp_path, text=f"(part {n})\n" + TEXT)) for n in range(8)]
    for second, part in enumerate(parts):
        store.keep(part.taken)
        os.utime(tmp_path / "state" / "jobs" / f"{part.content_hash}.json", (second, second))
    for part in parts[:3]:
        with pytest.raises(ProgramError, match="gone or damaged"):
            store.find(part.content_hash)
    for part in parts[3:]:
        assert store.find(part.content_hash).main.size == part.taken.main.size
    monkeypatch.setattr(kept, "_MOST_BYTES", 500)
    store.keep(parts[0].taken)
    assert sum(path.stat().st_size for path in (tmp_path / "state" / "jobs").iterdir()) <= 700
    assert store.find(parts[0].content_hash).path == parts[0].path
    monkeypatch.setattr(kept, "_MOST_BYTES", 10)
    with pytest.raises(ProgramError, match="no copy is kept"):
        store.keep(parts[1].taken)


def test_a_damaged_copy_is_never_believed_and_is_written_anew(tmp_path: Path) -> None:
    store = KeptPrograms(tmp_path)
    part = open_program(written(tmp_path))
    store.keep(part.taken)
    copy = tmp_path / "jobs" / part.content_hash
    data = copy.read_bytes()
    for place in range(len(data)):
        copy.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        with pytest.raises(ProgramError, match="gone or damaged"):
            store.find(part.content_hash)
    index = copy.with_name(copy.name + ".json")
    for text in ("", "{", "[]", "1", '{"path": 1, "files": 2}', '{"path": "a"}'):
        index.write_text(text)
        with pytest.raises(ProgramError, match="gone or damaged"):
            store.find(part.content_hash)
    store.keep(part.taken)
    assert store.find(part.content_hash).main.content_hash == part.content_hash


def test_a_copy_that_cannot_be_kept_is_said_and_the_job_runs(tmp_path: Path) -> None:
    state = tmp_path / "state"
    state.write_text("in the way")
    made = homed()
    zero = carriages(made)
    told: list[str] = []
    made.controller.set_tell(told.append)
    part = open_program(written(tmp_path), kept=KeptPrograms(state))
    part.check(made.controller)
    part.start(made.controller)
    assert made.controller.run() is Status.OK
    assert carriages(made)[0] - zero[0] == 5 * 200
    assert "no copy can be kept" in told[0]
