"""The program in hand, and the one that was cut short."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, cast

from fraese.control.motionqueue import MotionQueue
from fraese.control.position import Position
from fraese.control.state import CutShort
from fraese.control.unfinished import Unfinished


def a_note(name: str) -> Any:
    def note(tag: int, parameters: Mapping[int, float]) -> dict[str, Any]:
        return {"name": name, "line": tag, "parameters": dict(parameters)}

    return note


def unfinished() -> tuple[Unfinished, SimpleNamespace]:
    """And the queue of its motors."""
    queue = SimpleNamespace(tag=0)
    offsets = SimpleNamespace(parameters={5220: 1.0})
    position = cast(Position, SimpleNamespace(offsets=offsets))
    return Unfinished(cast(MotionQueue, queue), position), queue


def test_while_a_program_runs_none_is_gone_on_with() -> None:
    kept, queue = unfinished()
    kept.begin(a_note("one"))
    queue.tag = 7
    assert kept.place is None
    # But it is kept: a crash may come.
    assert kept.known() == {"name": "one", "line": 7, "parameters": {5220: 1.0}}
    kept.end(done=False)
    assert kept.place == CutShort("one", 7)
    kept.begin(a_note("two"))
    assert kept.place is None


def test_one_that_ended_well_is_forgotten() -> None:
    kept, _ = unfinished()
    kept.begin(a_note("one"))
    kept.end(done=True)
    assert (kept.left, kept.place) == (None, None)


def test_what_moves_between_two_programs_changes_nothing() -> None:
    kept, queue = unfinished()
    kept.begin(a_note("one"))
    queue.tag = 7
    kept.end(done=False)
    kept.begin(None)
    queue.tag = 3
    kept.end(done=True)
    assert kept.place == CutShort("one", 7)


def test_one_that_was_refused_before_its_first_move_leaves_what_was_there_before() -> None:
    kept, queue = unfinished()
    kept.begin(a_note("one"))
    queue.tag = 7
    kept.end(done=False)
    kept.begin(a_note("two"))
    queue.tag = 0
    assert kept.known() == {"name": "two", "line": 0, "parameters": {5220: 1.0}}, "of a crash"
    kept.end(done=False)
    assert kept.place == CutShort("one", 7)


def test_one_that_is_given_up_for_another_is_cut_short_until_that_begins() -> None:
    kept, queue = unfinished()
    kept.begin(a_note("one"))
    queue.tag = 7
    kept.begin(None)
    assert kept.place == CutShort("one", 7)
