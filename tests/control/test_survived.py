"""What is believed of the word of something that outlived its program."""

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.control.savedstate import KeptDoubt, Motion, SavedState
from fraese.control.survived import survived
from fraese.machine import Machine
from fraese.motor.realtime.lastwords import LastWords
from fraese.motor.seams import Ended
from fraese.planner.backlash import followed
from tests.helpers import configured

RECORD = SavedState(
    position_steps=(500, 40, 0),
    slack_steps=(0, 0, 0),
    parameters={},
    referenced=(True, True, False),
    phases=(1, 2, 3),
    ends=("xmin",),
    motion=Motion(low_steps=(400, 0, -10), high_steps=(600, 80, 10), counted_steps=(120, -7, 0)),
)
WORDS = LastWords(bytes(16), (173, -7, 2), (6, 2, 5), frozenset(), Ended.SILENCE)


def machine(**axes: Any) -> Machine:
    return Machine.from_config(configured(axes=axes))


def test_the_place_is_that_of_the_words_and_trusted_as_before() -> None:
    known = survived(RECORD, WORDS, machine())
    assert known is not None
    assert known.position_steps == (553, 40, 2)
    assert (known.phases, known.referenced) == ((6, 2, 5), (True, True, False))
    assert (known.motion, known.doubt, known.ends) == (None, None, ())
    assert known.believed() == known


def test_an_inverted_axis_went_the_other_way() -> None:
    known = survived(RECORD, WORDS, machine(x={"inverted": True}))
    assert known is not None
    assert known.position_steps == (447, 40, 2)


def test_a_motor_that_may_have_turned_on_has_no_reference() -> None:
    known = survived(RECORD, replace(WORDS, torn=frozenset({1})), machine())
    assert known is not None
    assert known.referenced == (True, False, False)


@pytest.mark.parametrize(
    "old", [None, KeptDoubt(why="of before", spans_steps=((3, 4), (0, 0), (0, 0)))]
)
def test_backlash_is_in_doubt_since_the_motor_may_have_turned_round(old: KeptDoubt | None) -> None:
    record = RECORD.model_copy(update={"doubt": old, "slack_steps": (5, 0, 0)})
    known = survived(record, WORDS, machine(x={"backlash_mm": 0.1}))
    assert known is not None
    # 53 steps on, five of which took up the slack; 20 steps are a tenth of a millimetre.
    assert known.position_steps == (548, 40, 2)
    assert known.referenced == (False, True, False)
    assert known.doubt is not None
    below, above = (3, 4) if old else (0, 0)
    assert known.doubt.spans_steps == ((below, above + 20), (0, 0), (0, 0))


@pytest.mark.parametrize(
    ("travelled_steps", "is_sure"),
    [((1053, 900, 2), True), ((1055, 900, 2), False), ((), False)],
    ids=["straight on", "there and back", "nobody knows"],
)
def test_backlash_is_known_where_the_motor_has_not_turned_round(
    travelled_steps: tuple[int, ...], is_sure: bool
) -> None:
    assert RECORD.motion is not None
    motion = RECORD.motion.model_copy(update={"travelled_steps": (1000, 900, 0)})
    record = RECORD.model_copy(update={"motion": motion, "slack_steps": (5, 0, 0)})
    words = replace(WORDS, travelled_steps=travelled_steps)
    known = survived(record, words, machine(x={"backlash_mm": 0.1}))
    assert known is not None
    assert (known.position_steps, known.slack_steps) == ((548, 40, 2), (0, 0, 0))
    assert known.referenced == (is_sure, True, False)
    assert (known.doubt is None) is is_sure


ways = st.lists(st.integers(-40, 40).filter(bool), min_size=1, max_size=6)


@given(ways, st.floats(0, 1), st.floats(0, 1), st.integers(0, 20), st.sampled_from([1, -1]))
def test_with_backlash_the_truth_is_what_is_claimed_or_within(
    made: list[int], recorded: float, ended: float, slack: int, sign: int
) -> None:
    """A motor goes to and fro; recorded somewhere, ended somewhere later, in single steps."""
    steps = [(1 if way > 0 else -1) for way in made for _ in range(abs(way))]
    at = int(recorded * len(steps))
    end = at + int(ended * (len(steps) - at))
    carriage, play, seen = 0, slack, []
    for step in [*steps, 0]:
        seen.append((carriage, play))
        moved, play = followed(play, 20, sign * step)
        carriage += moved
    far = 10**6
    motion = Motion(
        low_steps=(-far,) * 3,
        high_steps=(far,) * 3,
        counted_steps=(sum(steps[:at]), 0, 0),
        travelled_steps=(at, 0, 0),
    )
    record = RECORD.model_copy(
        update={
            "motion": motion,
            "position_steps": (seen[at][0], 0, 0),
            "slack_steps": (seen[at][1], 0, 0),
        }
    )
    words = replace(WORDS, position_steps=(sum(steps[:end]), 0, 0), travelled_steps=(end, 0, 0))
    known = survived(record, words, machine(x={"backlash_mm": 0.1, "inverted": sign < 0}))
    assert known is not None
    true = seen[end][0]
    if known.referenced[0]:
        assert (known.position_steps[0], known.slack_steps[0], known.doubt) == (*seen[end], None)
    else:
        assert known.doubt is not None
        below, above = known.doubt.spans_steps[0]
        assert -below <= true - known.position_steps[0] <= above
    if len(set(steps[at:end])) <= 1:
        assert known.referenced[0]


@pytest.mark.parametrize(
    "doubt", [KeptDoubt(why="x"), KeptDoubt(why="x", spans_steps=((1, 1),) * 3)]
)
def test_a_doubt_of_before_goes_on(doubt: KeptDoubt) -> None:
    known = survived(RECORD.model_copy(update={"doubt": doubt}), WORDS, machine())
    assert known is not None
    assert known.doubt == doubt


@pytest.mark.parametrize(
    "words",
    [
        replace(WORDS, position_steps=(221, -7, 2)),
        replace(WORDS, position_steps=(173, -7, -11)),
        replace(WORDS, position_steps=(173, -7)),
    ],
    ids=["beyond", "below", "of two motors"],
)
def test_what_cannot_have_been_is_not_believed(words: LastWords) -> None:
    assert survived(RECORD, words, machine()) is None


def test_a_record_of_earlier_versions_has_no_counts() -> None:
    motion = Motion(low_steps=(400, 0, -10), high_steps=(600, 80, 10))
    assert survived(RECORD.model_copy(update={"motion": motion}), WORDS, machine()) is None
