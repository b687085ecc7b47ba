"""Feed and spindle: what was read ahead does not count before the motors are there."""

from hypothesis import given
from hypothesis import strategies as st

from fraese.control.cutting import Cutting, CuttingHistory


def test_what_was_read_ahead_is_not_in_force() -> None:
    history = CuttingHistory()
    history.note(1, 0, feed_mm_min=300.0)
    history.note(4, 0, direction=1, rev_min=12000.0)
    assert history.at(0) == Cutting()
    assert history.at(3) == Cutting(300.0)
    assert history.at(4) == Cutting(300.0, 1, 12000.0)


def test_the_end_forgets_what_was_not_reached() -> None:
    history = CuttingHistory()
    history.note(1, 0, feed_mm_min=300.0, direction=1, rev_min=5.0)
    history.note(9, 0, direction=0)
    history.end(4)
    assert history.at(100) == Cutting(300.0, 1, 5.0)
    history.end(4, is_off=True)
    assert history.at(0) == Cutting(300.0, 0, 5.0)


def test_the_next_program_has_no_feed_and_the_spindle_as_it_was() -> None:
    history = CuttingHistory()
    history.note(1, 0, feed_mm_min=300.0, direction=1, rev_min=5.0)
    history.end()
    history.begin()
    assert history.at(0) == Cutting(0.0, 1, 5.0)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 5)), max_size=40))
def test_a_look_is_as_if_nothing_were_ever_forgotten(ways: list[tuple[int, int]]) -> None:
    """Moves are read and played in any turn; each has its own number for a feed."""
    history, read, played = CuttingHistory(), 0, 0
    for ahead, back in ways:
        for _ in range(ahead):
            read += 1
            history.note(read, played, feed_mm_min=float(read))
        played = min(read, played + back)
        assert history.at(played).feed_mm_min == played
