"""Whom a machine asks after a crash, and whom it does not believe."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import survivors
from fraese.assembly.keeping import Keeping
from fraese.assembly.meaning import meaning
from fraese.assembly.survivors import KNOWN, Opening, ledger_of
from fraese.control.savedstate import Motion, SavedState
from fraese.journal.pages import SLOT
from fraese.machine import Machine
from fraese.motor.bridge import survivor
from fraese.motor.bridge.ledger import TOKEN_BYTES, Book, this_boot
from fraese.motor.realtime.lastwords import LastWords
from fraese.motor.seams import Ended
from tests.helpers import configured

SESSION = "0123456789abcdef"
TOKEN = SESSION.encode()
CONFIG = configured(port={"kind": "bridge", "device": "/dev/ttyFR"})
MACHINE = Machine.from_config(CONFIG)
MOVING = SavedState(
    position_steps=(50, 0, 0),
    slack_steps=(0, 0, 0),
    parameters={},
    referenced=(True, True, True),
    phases=(0, 0, 0),
    motion=Motion(low_steps=(0, 0, 0), high_steps=(90, 0, 0), counted_steps=(50, 0, 0)),
    axes=meaning(CONFIG, MACHINE),
    session=SESSION,
)

pytestmark = pytest.mark.skipif(not this_boot(), reason="the system does not say which run it is")


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Tokens of those who asked; a bridge answers everybody."""
    tokens: list[bytes] = []

    def ask(_line: object, _clock: object, book: Book) -> LastWords:
        tokens.append(book.token)
        return LastWords(book.token, (73, 0, 0), (1, 0, 0), frozenset(), Ended.SILENCE)

    monkeypatch.setattr(survivor, "ask", ask)
    return tokens


def ended_suddenly(folder: Path, record: SavedState = MOVING, token: bytes = TOKEN) -> None:
    """A program that drives a bridge leaves a record and a ledger."""
    kept = keeping(folder)
    kept.write(record, durable=True)
    ledger = ledger_of(Opening(token, kept.path))
    ledger.begin(77, 8, (0, 0, 0), (0, 0, 0))
    ledger.close()
    kept.close()


def keeping(folder: Path) -> Keeping:
    return Keeping(folder, CONFIG, MACHINE)


def loaded(folder: Path, *, to_write: bool = True) -> tuple[SavedState, list[str]]:
    kept = keeping(folder)
    state, notes = kept.load(to_write=to_write)
    kept.close()
    assert state is not None
    return state, notes


def test_what_it_knows_is_taken_up_and_written_down(tmp_path: Path, asked: list[bytes]) -> None:
    ended_suddenly(tmp_path)
    for notes in ([KNOWN], []):
        state, said = loaded(tmp_path)
        assert said == notes
        assert (state.position_steps, state.phases) == ((73, 0, 0), (1, 0, 0))
        assert state.referenced == (True, True, True)
        assert (state.motion, state.doubt) == (None, None)
    # It is asked but once: the driver's greeting makes it forget.
    assert asked == [TOKEN]


def test_who_only_looks_asks_nobody(tmp_path: Path, asked: list[bytes]) -> None:
    ended_suddenly(tmp_path)
    state, _ = loaded(tmp_path, to_write=False)
    assert state.doubt is not None
    assert asked == []


@pytest.mark.parametrize(
    "left",
    [
        {"token": bytes(TOKEN_BYTES)},
        {"record": MOVING.model_copy(update={"session": ""})},
        {"record": MOVING.model_copy(update={"session": "fedcba9876543210"})},
        {"record": MOVING.model_copy(update={"motion": None})},
    ],
    ids=["ledger of another", "no session", "another session", "at rest"],
)
def test_another_session_is_not_asked_for(
    tmp_path: Path, asked: list[bytes], left: dict[str, Any]
) -> None:
    ended_suddenly(tmp_path, **left)
    state, notes = loaded(tmp_path)
    assert (state.position_steps, notes, asked) == ((50, 0, 0), [], [])


def test_after_the_computer_began_anew_nobody_is_asked(
    tmp_path: Path, asked: list[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    ended_suddenly(tmp_path)
    monkeypatch.setattr(survivors, "this_boot", lambda: bytes(16))
    state, _ = loaded(tmp_path)
    assert state.doubt is not None
    assert asked == []


def test_a_record_that_may_not_be_the_last_asks_nobody(tmp_path: Path, asked: list[bytes]) -> None:
    ended_suddenly(tmp_path)
    path = keeping(tmp_path).path
    data = bytearray(path.read_bytes())
    # In the other of its two slots: what stood there may have been the last one.
    data[SLOT] ^= 1
    path.write_bytes(data)
    loaded(tmp_path)
    assert asked == []


def test_where_nothing_can_be_written_down_nothing_is(tmp_path: Path) -> None:
    ledger = ledger_of(Opening(TOKEN, tmp_path / "missing" / "bridge.journal"))
    ledger.begin(77, 8, (0,), (0,))
    assert list(tmp_path.iterdir()) == []
