"""The store: whatever a power cut leaves and whichever byte changes, no wrong record is trusted.

Truth is what was written; the disk is a model that knows what was synced.
"""

import os
import stat
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.errors import ConfigError
from fraese.journal import MOST_BYTES, Journal, files, store
from fraese.journal.pages import PAGE, SLOT, Condition, blank_slot, read_slot, record
from tests.helpers import as_nobody


def told(path: Path) -> tuple[bytes, bool] | None:
    """What a start that comes now would be told."""
    found = Journal(path).read()
    return None if found is None else (found.payload, found.is_trusted)


def told_of(folder: Path, content: bytes) -> tuple[bytes, bool] | None:
    """The same, of a file with this content; None: it is refused."""
    path = folder / "tried.journal"
    path.write_bytes(content)
    return told_or_refused(path)


def told_or_refused(path: Path) -> tuple[bytes, bool] | None:
    """What a start is told; None: it is refused."""
    try:
        return told(path)
    except ConfigError as error:
        refused = str(error)
    assert "--fresh" in refused
    assert "\n" not in refused
    return None


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "mill.journal"


@given(st.lists(st.binary(max_size=3000), min_size=1, max_size=6))
@settings(max_examples=30)
def test_what_was_written_last_is_found(
    tmp_path_factory: pytest.TempPathFactory, payloads: list[bytes]
) -> None:
    path = tmp_path_factory.mktemp("kept") / "mill.journal"
    journal = Journal(path)
    assert journal.read() is None
    for payload in payloads:
        journal.write(payload)
        assert told(path) == (payload, True)
    # Another program goes on with it.
    again = Journal(path)
    again.read()
    again.write(b"another")
    assert told(path) == (b"another", True)
    assert path.stat().st_size == 2 * SLOT


def test_a_record_may_be_as_long_as_a_slot_and_no_longer(path: Path) -> None:
    Journal(path).write(b"x" * MOST_BYTES)
    assert told(path) == (b"x" * MOST_BYTES, True)
    with pytest.raises(ValueError, match="the most"):
        record(b"x" * (MOST_BYTES + 1), 1)


# --- a changed byte ------------------------------------------------------------------------------


def changed(content: bytes, at: int, by: int) -> bytes:
    return content[:at] + bytes([content[at] ^ by]) + content[at + 1 :]


@pytest.mark.parametrize("records", [1, 2, 3, 4])
def test_no_changed_byte_uncovers_another_trusted_record(tmp_path: Path, records: int) -> None:
    """Every byte of both records, and some behind them."""
    path = tmp_path / "mill.journal"
    journal = Journal(path)
    for number in range(records):
        journal.write(b"%d" % number * (400 + 300 * number))
    content, last = path.read_bytes(), told(path)
    assert last is not None
    wrong = []
    used, every = 3 * PAGE, 1 if records == 3 else 11
    places = [at for at in range(len(content)) if not at % (every if at % SLOT < used else 499)]
    for at in places:
        with path.open("r+b") as file:
            file.seek(at)
            file.write(bytes([content[at] ^ 1 << at % 8]))
            file.flush()
            answer = told_or_refused(path)
            file.seek(at)
            file.write(content[at : at + 1])
        if answer not in (last, (last[0], False)) and (answer is None or answer[1]):
            wrong.append((at, answer))
    # The only record there is cannot be damaged and found.
    assert all(answer is None and records == 1 for _, answer in wrong)


@given(at=st.integers(0, 2 * SLOT - 1), by=st.integers(1, 255))
@settings(max_examples=200)
def test_nor_does_any_other_change_of_a_byte(
    tmp_path_factory: pytest.TempPathFactory, at: int, by: int
) -> None:
    folder = tmp_path_factory.mktemp("changed")
    journal = Journal(folder / "mill.journal")
    for payload in (b"first" * 200, b"second" * 200, b"in motion" * 100):
        journal.write(payload)
    answer = told_of(folder, changed((folder / "mill.journal").read_bytes(), at, by))
    assert answer is not None
    assert answer[0] == b"in motion" * 100 or not answer[1]


def test_what_a_damaged_record_hides_never_comes_back_as_trusted(path: Path) -> None:
    """Its place is not simply written over: that write may be broken off."""
    journal = Journal(path)
    journal.write(b"at rest")
    journal.write(b"in motion")
    path.write_bytes(changed(path.read_bytes(), SLOT + 100, 1))
    again = Journal(path)
    found = again.read()
    assert found is not None
    assert (found.payload, found.is_trusted) == (b"at rest", False)
    again.write(b"doubtful")
    content = path.read_bytes()
    assert told(path) == (b"doubtful", True)
    assert b"at rest" not in content
    assert b"in motion" not in content


def test_what_a_disk_lost_is_no_record_that_was_never_written(tmp_path: Path) -> None:
    path = tmp_path / "mill.journal"
    journal = Journal(path)
    journal.write(b"at rest" * 200)
    journal.write(b"in motion" * 200)
    content = path.read_bytes()
    for at in range(SLOT, SLOT + 4 * PAGE, PAGE):
        lost = content[:at] + bytes(PAGE) + content[at + PAGE :]
        assert told_of(tmp_path, lost) == (b"at rest" * 200, False)
    assert told_of(tmp_path, content[: SLOT + PAGE]) == (b"at rest" * 200, False)


@pytest.mark.parametrize("content", [b"", b"{}", bytes(2 * SLOT), blank_slot() * 2], ids=len)
def test_what_is_no_journal_is_refused(tmp_path: Path, content: bytes) -> None:
    assert told_of(tmp_path, content) is None


def test_a_newer_version_is_refused_and_left_alone(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("fraese.journal.pages.VERSION", 2)
        Journal(path).write(b"from tomorrow")
    content = path.read_bytes()
    with pytest.raises(ConfigError, match="another version"):
        Journal(path).read()
    assert path.read_bytes() == content


# --- a power cut ---------------------------------------------------------------------------------


class Disk:
    """Knows which writes were synced, by watching the calls that the store makes."""

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.path = path
        self.synced = path.read_bytes() if path.exists() else b""
        self.pending: list[tuple[int, bytes]] = []
        write_all, sync, replace = files.write_all, files.sync, files.replace

        def watched_write(fd: int, content: bytes, offset: int) -> None:
            write_all(fd, content, offset)
            self.pending += [
                (offset + at, content[at : at + PAGE]) for at in range(0, len(content), PAGE)
            ]

        def watched_sync(fd: int) -> None:
            sync(fd)
            self.synced, self.pending = path.read_bytes(), []

        def watched_replace(to: Path, content: bytes) -> None:
            replace(to, content)
            self.synced, self.pending = path.read_bytes(), []

        monkeypatch.setattr(store, "write_all", watched_write)
        monkeypatch.setattr(store, "sync", watched_sync)
        monkeypatch.setattr(store, "replace", watched_replace)

    def after_a_cut(self) -> list[bytes]:
        """Every state in which a power cut now may leave the file."""
        states = []
        for size in range(len(self.pending) + 1):
            for written in combinations(self.pending, size):
                content = bytearray(self.synced)
                for at, page in written:
                    content[at : at + len(page)] = page
                states.append(bytes(content))
        return states


def test_a_power_cut_leaves_the_old_record_or_the_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every subset of the pages that were not synced, at every record; nothing is doubted."""
    path = tmp_path / "mill.journal"
    journal = Journal(path)
    disk = Disk(path, monkeypatch)
    before = b""
    for number in range(5):
        payload = b"%d" % number * (100 + 600 * (number % 3))
        with monkeypatch.context() as patch:
            patch.setattr(store, "sync", lambda fd: None)
            journal.write(payload)
        for content in disk.after_a_cut() if number else ():
            assert told_of(tmp_path, content) in ((before, True), (payload, True))
        disk.synced, disk.pending = path.read_bytes(), []
        before = payload


def test_a_power_cut_after_records_that_are_not_durable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They never touch the last durable one."""
    path = tmp_path / "mill.journal"
    journal = Journal(path)
    disk = Disk(path, monkeypatch)
    journal.write(b"durable" * 100)
    written = [b"durable" * 100]
    for number in range(3):
        journal.write(b"%d" % number * 700, durable=False)
        written.append(b"%d" % number * 700)
        assert told(path) == (written[-1], True)
        for content in disk.after_a_cut():
            answer = told_of(tmp_path, content)
            assert answer is not None
            assert answer[0] in written
            assert answer[1]


def test_a_record_is_on_the_disk_when_it_was_written(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = Disk(path, monkeypatch)
    journal = Journal(path)
    for number in range(4):
        journal.write(b"%d" % number)
        assert disk.pending == []
        assert disk.after_a_cut() == [path.read_bytes()]


# --- where it lies -------------------------------------------------------------------------------


def test_it_never_grows_and_leaves_nothing_beside_it(path: Path) -> None:
    """So a full disk does not hinder it."""
    journal = Journal(path)
    journal.write(b"first")
    size = path.stat().st_size, path.stat().st_blocks
    for number in range(10):
        journal.write(b"%d" % number * 1000)
    assert (path.stat().st_size, path.stat().st_blocks) == size
    assert [each.name for each in path.parent.iterdir()] == ["mill.journal"]


def test_what_cannot_be_written_says_so_and_holds(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal = Journal(path)
    journal.write(b"first")

    def broken(fd: int) -> None:
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as patch:
        patch.setattr(store, "sync", broken)
        with pytest.raises(ConfigError, match="the state cannot be written: Input/output error"):
            journal.write(b"second")
    journal.write(b"third")
    assert told(path) == (b"third", True)


def test_a_folder_that_is_read_only_after_the_start_does_not_hinder_it(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(path.parent)
    with as_nobody(path.parent):
        journal = Journal(Path(path.name))
        journal.write(b"first")
        Path().chmod(0o500)
        journal.write(b"second")
        with pytest.raises(PermissionError):
            Path("another").touch()
        # Nor whoever comes then; but what must be replaced cannot be.
        again = Journal(Path(path.name))
        again.read()
        again.write(b"third")
        with pytest.raises(ConfigError, match="the state cannot be written: Permission denied"):
            Journal(Path("new.journal")).write(b"first")
        Path().chmod(0o700)
    assert told(path) == (b"third", True)


@pytest.mark.parametrize("umask", [0o000, 0o022, 0o777])
def test_file_and_folder_are_the_users_alone(tmp_path: Path, umask: int) -> None:
    path = tmp_path / "a" / "b" / "mill.journal"
    before = os.umask(umask)
    try:
        Journal(path).write(b"mine")
    finally:
        os.umask(before)
    modes = [stat.S_IMODE(each.stat().st_mode) for each in (path, path.parent, path.parent.parent)]
    assert modes == [0o600, 0o700, 0o700]
    assert told(path) == (b"mine", True)


@pytest.mark.parametrize("there", ["link", "dangling", "fifo", "device", "folder"])
def test_only_a_file_is_read_or_written(tmp_path: Path, there: str) -> None:
    path, victim = tmp_path / "mill.journal", tmp_path / "victim"
    victim.write_bytes(b"mine")
    make = {
        "link": lambda: path.symlink_to(victim),
        "dangling": lambda: path.symlink_to(tmp_path / "nowhere"),
        "fifo": lambda: os.mkfifo(path),
        "device": lambda: path.symlink_to("/dev/zero"),
        "folder": lambda: path.mkdir(),
    }
    make[there]()
    with pytest.raises(ConfigError, match="remove it"):
        Journal(path).read()
    assert victim.read_bytes() == b"mine"
    assert not (tmp_path / "nowhere").exists()


def test_a_planted_link_of_the_name_for_the_new_file_is_not_followed(path: Path) -> None:
    victim = path.parent / "victim"
    victim.write_bytes(b"mine")
    path.with_suffix(".journal.new").symlink_to(victim)
    Journal(path).write(b"kept")
    assert victim.read_bytes() == b"mine"
    assert sorted(each.name for each in path.parent.iterdir()) == ["mill.journal", "victim"]


def test_slots_say_what_became_of_them() -> None:
    whole = record(b"x" * 1000, 7)
    old = record(b"y" * 1000, 5)
    tail = blank_slot()[len(whole) :]
    assert read_slot(whole + tail).condition is Condition.WHOLE
    assert read_slot(whole[:PAGE] + old[PAGE:] + tail).condition is Condition.BROKEN_OFF
    assert read_slot(changed(whole, 600, 1) + tail).condition is Condition.DAMAGED
    assert read_slot(blank_slot()).condition is Condition.BLANK
