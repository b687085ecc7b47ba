"""The journal, and what lies beside it: never a trusted place that nobody wrote down.

The truth is what was written: places of the records, by the test.
"""

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import event, example, given
from hypothesis import strategies as st

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.state import Status
from fraese.journal import MOST_BYTES, Journal, machine_file
from fraese.journal.pages import PAGE, SLOT, record
from fraese.motor.bridge import ledger
from fraese.motor.realtime import lastwords
from fraese.motor.realtime.lastwords import LastWords
from fraese.motor.seams import Ended
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of
from tests.helpers import configured, homed

#: A mill of one axis, and one that steps otherwise.
OTHERS = (configured(axes={"names": ["x"]}), configured(card={"kind": "stepdir"}))
Place = tuple[int, ...]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A record of a mill that was referenced."""
    folder = tmp_path_factory.mktemp("kept")
    made = homed()
    state = made.controller.keep().model_dump(mode="json")
    plant = assemble(Config(), state=folder)
    plant.close()
    found = Journal(machine_file(folder, "simulation", "")).read()
    assert found is not None
    return {**json.loads(found.payload), **state, "axes": json.loads(found.payload)["axes"]}


def records(written: dict[str, Any]) -> list[dict[str, Any]]:
    """At three places; the last but one says that the machine moves."""
    places = ([100, 200, -300], [1000, 2000, -3000], [4000, 5000, -6000])
    made = [{**written, "position_steps": place, "simulation": []} for place in places]
    low = [at - 500 for at in places[1]]
    made[1]["motion"] = {"low_steps": low, "high_steps": places[1], "counted_steps": [0, 0, 0]}
    return made


def journal_of(path: Path, payloads: list[bytes]) -> bytes:
    """The file after these records."""
    path.unlink(missing_ok=True)
    journal = Journal(path)
    for payload in payloads:
        journal.write(payload)
    journal.close()
    return path.read_bytes()


class Start:
    """What the next program makes of a state folder."""

    def __init__(self, folder: Path) -> None:
        self.path = machine_file(folder, "simulation", "")
        self._folder = folder

    def of(self, content: bytes, config: Config | None = None) -> Iterator[Plant]:
        """Who only looks and then who drives; none where one sentence refuses it."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.path.write_bytes(content)
        for at_desk in (True, False):
            plants, refusal = self._begun(config or Config(), at_desk=at_desk)
            event("refused" if refusal else "taken")
            assert is_a_sentence(refusal)
            if at_desk or refusal:
                assert self.path.read_bytes() == content
            if refusal:
                assert "--fresh" in refusal
            for plant in plants:
                assert all(map(is_a_sentence, plant.notes))
                yield plant
                assert is_a_sentence(refusal_of(plant.close))

    def _begun(self, config: Config, *, at_desk: bool) -> tuple[list[Plant], str]:
        plants: list[Plant] = []

        def begin() -> None:
            plants.append(assemble(config, state=self._folder, at_desk=at_desk))

        refusal = refusal_of(begin)
        return plants, refusal

    def trusted(self, content: bytes) -> set[Place]:
        """Where the machine is said to be, by whoever believes it."""
        found = set()
        for plant in self.of(content):
            where = plant.controller.position
            if any(where.referenced):
                assert where.doubt is None
                found.add(where.position_steps)
        return found


@pytest.fixture
def start(tmp_path: Path) -> Start:
    return Start(tmp_path)


def test_any_bytes(start: Start) -> None:
    @fuzzed(60)
    @given(st.one_of(st.binary(max_size=2 * PAGE), st.binary(max_size=9).map(lambda b: b * PAGE)))
    @example(bytes(2 * SLOT))
    @example(b"")
    def check(data: bytes) -> None:
        assert start.trusted(data) == set()

    check()


def test_any_bytes_as_a_payload(start: Start) -> None:
    @fuzzed(60)
    @given(st.one_of(st.binary(max_size=600), st.text(max_size=200).map(str.encode)))
    @example(b"[" * 20_000)
    @example(b'{"position_steps": ' + b"9" * 5000)
    @example(b"null")
    def check(payload: bytes) -> None:
        content = journal_of(start.path, [payload[:MOST_BYTES]])
        assert start.trusted(content) == set()

    check()


_CHANGES = st.lists(
    st.tuples(st.integers(0, 2 * SLOT - 1), st.binary(min_size=1, max_size=40)), max_size=6
)
_NEAR = st.builds(
    lambda slot, page, at: slot * SLOT + page * PAGE + at,
    st.integers(0, 1),
    st.integers(0, 3),
    st.integers(0, PAGE - 1),
)


def test_any_change_and_any_cut(start: Start, written: dict[str, Any]) -> None:
    """Bytes changed, moved, lost, and taken from an older file."""
    made = [json.dumps(each).encode() for each in records(written)]
    places = {tuple(each["position_steps"]) for each in records(written)}
    contents = [journal_of(start.path, made[:count]) for count in (1, 2, 3)]

    @fuzzed(100)
    @given(
        st.integers(0, 2),
        _CHANGES,
        st.lists(st.tuples(_NEAR, st.binary(min_size=1, max_size=9)), max_size=3),
        st.one_of(st.none(), st.integers(0, 2 * SLOT)),
        st.lists(
            st.tuples(st.integers(0, 2), st.integers(0, 127), st.integers(0, 127)), max_size=3
        ),
    )
    def check(
        which: int,
        changes: list[tuple[int, bytes]],
        near: list[tuple[int, bytes]],
        cut: int | None,
        moved: list[tuple[int, int, int]],
    ) -> None:
        content = bytearray(contents[which])
        for older, source, to in moved:
            content[to * PAGE : (to + 1) * PAGE] = contents[older][source * PAGE :][:PAGE]
        for at, data in [*changes, *near]:
            content[at : at + len(data)] = data[: len(content) - at]
        found = start.trusted(bytes(content[:cut]))
        # The one that says "in motion" is trusted by nobody.
        assert found <= places - {(1000, 2000, -3000)}
        if not moved and which:
            assert (100, 200, -300) not in found or found <= {(100, 200, -300)}

    check()


_JSON = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.text(max_size=6),
        st.sampled_from([10**10, -(10**10), 10**400, "9" * 5000, 1e308, "\u202e\x1b[2J"]),
    ),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=8,
)


def test_records_of_other_versions_and_machines(start: Start, written: dict[str, Any]) -> None:
    """Keys that came or went, and values of another kind, in a record that is whole."""
    whole = records(written)[0]

    @fuzzed(120)
    @given(
        st.dictionaries(st.sampled_from([*whole, "tool", "units"]), _JSON, max_size=3),
        st.lists(st.sampled_from([*whole]), max_size=2),
        st.sampled_from([None, *OTHERS]),
    )
    @example({"position_steps": [10**10, 0, 0]}, [], None)
    @example({"job": {"file": "x" * 5000}}, [], None)
    @example({"parameters": {"5220": 7}}, [], None)
    @example({"phases": [99, -1, 2]}, [], None)
    def check(others: dict[str, Any], without: list[str], config: Config | None) -> None:
        values = {**whole, **others}
        for key in without:
            values.pop(key, None)
        payload = json.dumps(values).encode()[:MOST_BYTES]
        for plant in start.of(journal_of(start.path, [payload]), config):
            where = plant.controller.position
            if any(where.referenced):
                assert list(where.position_steps) == values["position_steps"]
                assert config is None
            assert is_a_sentence(plant.controller.state().message)
            if not others and not without:
                continue
            # It works, or says why not.
            refusal_of(partial(plant.controller.jog, "x", 0.05, clamp=True))
            if plant.controller.status is Status.RUN:
                assert plant.controller.run() in (Status.OK, Status.ERROR)

    check()


def test_a_version_that_is_not_ours(start: Start, written: dict[str, Any]) -> None:
    @fuzzed(40)
    @given(st.integers(0, 0xFFFF), st.integers(0, 2**40), st.booleans())
    def check(version: int, sequence: int, second: bool) -> None:
        first, other = (json.dumps(each).encode() for each in records(written)[::2])
        content = bytearray(journal_of(start.path, [first]))
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("fraese.journal.pages.VERSION", version)
            pages = record(other, sequence)
        content[second * SLOT : second * SLOT + len(pages)] = pages
        found = start.trusted(bytes(content))
        if version != 1:
            assert found == set()
        assert found <= {(100, 200, -300), (4000, 5000, -6000)}

    check()


# --- what lives on -------------------------------------------------------------------------------

WORDS = LastWords(b"t" * 16, (5, -7, 9), (1, 2, 3), frozenset({1}), Ended.STOP)


def changed(whole: bytes, changes: list[tuple[int, bytes]], cut: int | None) -> bytes:
    content = bytearray(whole)
    for at, data in changes:
        content[at % (len(whole) + 1) : at % (len(whole) + 1) + len(data)] = data
    return bytes(content[:cut])


CUT = st.one_of(st.none(), st.none(), st.integers(0, 400))


def test_last_words(tmp_path: Path) -> None:
    """Whole, or none."""
    path = tmp_path / "mill.words"

    @fuzzed(200)
    @given(_CHANGES, CUT)
    def check(changes: list[tuple[int, bytes]], cut: int | None) -> None:
        path.write_bytes(changed(WORDS.packed(), changes, cut))
        assert lastwords.read(path) in (None, WORDS)

    check()


def test_a_ledger(tmp_path: Path) -> None:
    """A block as it was written, or none."""
    path = tmp_path / "mill.ledger"
    book = ledger.FileLedger(path.open("w+b", buffering=0), b"t" * 16, b"b" * 16)
    book.begin(77, 8, (0, 0, 0), (1, 2, 3))
    blocks = {serial: ((serial, -1, 2), (serial * 10, 0, 5)) for serial in range(1, 600)}
    for serial, (steps, at) in blocks.items():
        book.note(serial, steps, serial + 3, at)
    book.close()
    whole = path.read_bytes()

    @fuzzed(150)
    @given(_CHANGES, CUT, st.lists(st.integers(0, 700), min_size=1, max_size=20))
    def check(changes: list[tuple[int, bytes]], cut: int | None, asked: list[int]) -> None:
        found = ledger.book_in(changed(whole, changes, cut))
        if found is None:
            return
        assert (found.session, found.table, found.counts, found.phases) == (
            77,
            8,
            (0,) * 3,
            (1, 2, 3),
        )
        for serial in asked:
            entry = found.entry(serial)
            if entry is not None and serial:
                assert (entry.steps, entry.start) == blocks[serial]

    check()
