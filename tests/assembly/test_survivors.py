"""What a step process left, and whether the next program believes it: files only, no port."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import assemble, survivors
from fraese.assembly.keeping import Keeping
from fraese.assembly.meaning import meaning
from fraese.assembly.survivors import KNOWN, Opening, words_to
from fraese.control.savedstate import DAMAGED, KeptDoubt, Motion, SavedState
from fraese.errors import ConfigError
from fraese.journal import store
from fraese.journal.pages import SLOT
from fraese.machine import Machine
from fraese.motor.realtime.lastwords import LastWords, leave
from fraese.motor.seams import Ended
from tests.helpers import configured

CONFIG = configured(port={"kind": "ppdev"})
MACHINE = Machine.from_config(CONFIG)
TOKEN = b"0123456789abcdef"
RECORD = SavedState(
    position_steps=(500, 40, 0),
    slack_steps=(0, 0, 0),
    parameters={},
    referenced=(True, True, True),
    phases=(1, 2, 3),
    axes=meaning(CONFIG, MACHINE),
    motion=Motion(low_steps=(400, 0, -10), high_steps=(600, 80, 10), counted_steps=(120, -7, 0)),
    session=TOKEN.decode(),
)
WORDS = LastWords(TOKEN, (173, -7, 2), (6, 2, 5), frozenset(), Ended.TARGET)
PLACE = (553, 40, 2)


def left(folder: Path, record: SavedState, words: LastWords | None) -> Keeping:
    """What a killed program and its step process leave."""
    keeping = Keeping(folder, CONFIG, MACHINE)
    keeping.write(record, durable=True)
    to = words_to(Opening(TOKEN, keeping.path))
    assert to is not None
    if words is not None:
        leave(to.fd, words)
    os.close(to.fd)
    return Keeping(folder, CONFIG, MACHINE)


def test_who_looks_believes_it_and_writes_nothing(tmp_path: Path) -> None:
    keeping = left(tmp_path, RECORD, WORDS)
    for _ in range(2):
        state, notes = keeping.load(to_write=False)
        assert state is not None
        assert (state.position_steps, state.phases) == (PLACE, WORDS.phases)
        assert (state.referenced, state.doubt) == ((True, True, True), None)
        assert notes == [KNOWN]


def test_who_drives_takes_it_over_before_the_words_are_overwritten(tmp_path: Path) -> None:
    state, _ = left(tmp_path, RECORD, WORDS).load(to_write=True)
    (tmp_path / "ppdev-parport0.words").unlink()
    again, notes = Keeping(tmp_path, CONFIG, MACHINE).load(to_write=True)
    assert again == state
    assert notes == []


def test_where_the_journal_cannot_take_it_nobody_drives_and_the_words_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A step process that is started would leave its own words in their place."""
    left(tmp_path, RECORD, WORDS)

    def broken(*arguments: object) -> None:
        raise OSError(5, "Input/output error")

    for name in ("write_all", "replace"):
        monkeypatch.setattr(store, name, broken)
    for _ in range(2):
        with pytest.raises(ConfigError, match=r"Input/output error\. What made the steps knows"):
            assemble(CONFIG, state=tmp_path)
    assert (tmp_path / "ppdev-parport0.words").read_bytes() == WORDS.packed()
    # Who only looks is told all the same.
    state, notes = Keeping(tmp_path, CONFIG, MACHINE).load(to_write=False)
    assert state is not None
    assert (state.position_steps, notes) == (PLACE, [KNOWN])
    monkeypatch.undo()
    again, notes = Keeping(tmp_path, CONFIG, MACHINE).load(to_write=True)
    assert again == state
    assert notes == [KNOWN]


CHANGED = replace(WORDS, position_steps=(173, -7, 3)).packed()[:-4] + WORDS.packed()[-4:]


@pytest.mark.parametrize(
    "left_over",
    [b"", WORDS.packed()[:-1], CHANGED, replace(WORDS, token=bytes(16)).packed(),
     replace(WORDS, position_steps=(500, -7, 2)).packed()],
    ids=["nothing", "half", "damaged", "of another session", "outside of the bounds"],
)  # fmt: skip
def test_else_the_bounds_of_the_record_hold(tmp_path: Path, left_over: bytes) -> None:
    keeping = left(tmp_path, RECORD, None)
    (tmp_path / "ppdev-parport0.words").write_bytes(left_over)
    state, notes = keeping.load(to_write=True)
    assert state is not None
    assert notes == []
    assert state.position_steps == RECORD.position_steps
    assert state.referenced == (False, False, False)
    assert state.doubt is not None
    assert state.doubt.spans_steps == ((100, 100), (40, 40), (10, 10))


@pytest.mark.parametrize(
    "change",
    [
        {"motion": None},
        {"session": "0123456789abcdeX"},
        {"session": "short"},
        {"session": "ß" * 16},
    ],
    ids=["at rest", "another session", "no token", "no letters"],
)
def test_words_are_of_the_record_that_says_in_motion(
    tmp_path: Path, change: dict[str, Any]
) -> None:
    record = RECORD.model_copy(update=change)
    state, notes = left(tmp_path, record, WORDS).load(to_write=True)
    assert state == record.believed()
    assert notes == []


def test_motors_that_were_torn_have_no_reference(tmp_path: Path) -> None:
    words = replace(WORDS, torn=frozenset({0, 2}))
    state, _ = left(tmp_path, RECORD, words).load(to_write=True)
    assert state is not None
    assert (state.position_steps, state.referenced) == (PLACE, (False, True, False))


def test_a_damaged_journal_is_not_mended_by_words(tmp_path: Path) -> None:
    keeping = left(tmp_path, RECORD, WORDS)
    keeping.load(to_write=False)
    keeping.write(RECORD, durable=True)
    data = bytearray(keeping.path.read_bytes())
    data[SLOT + 100] ^= 1
    keeping.path.write_bytes(data)
    state, _ = Keeping(tmp_path, CONFIG, MACHINE).load(to_write=True)
    assert state is not None
    assert state.doubt == KeptDoubt(why=DAMAGED)


def test_under_another_configuration_nothing_is_made_of_words(tmp_path: Path) -> None:
    """Their counts mean something else there; configured as before they mean the same as before."""
    left(tmp_path, RECORD, WORDS)
    other = configured(port={"kind": "ppdev"}, axes={"x": {"inverted": True}})
    state, notes = Keeping(tmp_path, other, Machine.from_config(other)).load(to_write=True)
    assert state is None
    assert KNOWN not in notes
    state, notes = Keeping(tmp_path, CONFIG, MACHINE).load(to_write=True)
    assert state is not None
    assert (state.position_steps, notes) == (PLACE, [KNOWN])


@pytest.mark.parametrize("what", ["a link", "no file", "a folder"])
def test_what_is_no_file_there_is_refused(tmp_path: Path, what: str) -> None:
    path = tmp_path / "ppdev-parport0.words"
    made = {"a link": lambda: path.symlink_to("x"), "no file": lambda: os.mkfifo(path)}
    made.get(what, path.mkdir)()
    with pytest.raises(ConfigError, match=f"words: is {what}, where the state is kept"):
        words_to(Opening(TOKEN, tmp_path / "ppdev-parport0.journal"))


def test_where_no_file_can_be_made_there_are_no_words(tmp_path: Path) -> None:
    assert words_to(Opening(TOKEN, tmp_path / "none" / "ppdev-parport0.journal")) is None
    assert words_to(None) is None


def test_a_ledger_counts_in_the_run_of_the_computer_in_which_it_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A board has had no current since, perhaps."""
    opening = survivors.Opening(b"t" * 16, tmp_path / "bridge-x.journal")
    monkeypatch.setattr(survivors, "this_boot", lambda: b"b" * 16)
    ledger = survivors.ledger_of(opening)
    ledger.begin(77, 8, (0, 0, 0), (0, 0, 0))
    ledger.close()
    book = survivors._book_of(opening)
    assert book is not None
    assert book.session == 77
    assert survivors._book_of(opening._replace(token=b"o" * 16)) is None
    monkeypatch.setattr(survivors, "this_boot", lambda: b"c" * 16)
    assert survivors._book_of(opening) is None
