"""A record in motion, and the place where what made the steps says that they ended.

    record   position 500 at count 120, and bounds of it ----.
    words    count 173, phases, torn motors -----------------+--> position 553, as trusted as it was

Rule 1: words are believed if they lie within the record's bounds: nothing else can have been.
Rule 2: how far a carriage lags behind its motor is known where that has not turned round since: it
        has gone as far as it has come. Else an axis with backlash keeps a doubt as wide as that.
Rule 3: a motor that stopped without ramp at speed loses its reference, as while the program lived.
"""

from fraese.control.savedstate import IN_MOTION, KeptDoubt, Motion, SavedState
from fraese.machine import Axis, Machine, Steps
from fraese.motor.realtime.lastwords import LastWords
from fraese.planner.backlash import followed


def survived(record: SavedState, words: LastWords, machine: Machine) -> SavedState | None:
    """What is known of a machine whose program ended in motion; None: the words are not of it.

    Args:
        record: that says so.
        words: of the record's session.
        machine: its axes.
    """
    motion, motors = record.motion, len(machine.axes)
    if motion is None or {len(motion.counted_steps), len(words.position_steps)} != {motors}:
        return None
    turned_steps = tuple(
        axis.motor_sign * (now - then)
        for axis, now, then in zip(
            machine.axes, words.position_steps, motion.counted_steps, strict=True
        )
    )
    if not _are_within(record, turned_steps):
        return None
    followed_steps = [
        followed(slack, axis.backlash_steps, turned)
        for axis, slack, turned in zip(machine.axes, record.slack_steps, turned_steps, strict=True)
    ]
    slack_steps = tuple(slack for _, slack in followed_steps)
    is_sure = [
        went or not axis.backlash_steps
        for went, axis in zip(_went_straight(motion, words), machine.axes, strict=True)
    ]
    # A motor may have lost its reference on the way: what it was before counts no more.
    old_doubt = record.doubt and record.doubt.model_copy(update={"referenced": ()})
    update = {
        "position_steps": tuple(
            at + moved for at, (moved, _) in zip(record.position_steps, followed_steps, strict=True)
        ),
        "slack_steps": slack_steps,
        "phases": words.phases,
        "referenced": tuple(
            old and sure and motor not in words.torn
            for motor, (old, sure) in enumerate(zip(record.referenced, is_sure, strict=True))
        ),
        "doubt": _doubt(old_doubt, slack_steps, machine.axes, is_sure),
        "in_hand": False,
        # What was known of a contact was before it moved.
        "ends": (),
        "motion": None,
    }
    return record.model_copy(update=update)


def _went_straight(motion: Motion, words: LastWords) -> list[bool]:
    """Every motor: it has not turned round since the record."""
    motors = len(words.position_steps)
    if {len(motion.travelled_steps), len(words.travelled_steps)} != {motors}:
        return [False] * motors
    counts = zip(motion.counted_steps, words.position_steps, strict=True)
    ways = zip(motion.travelled_steps, words.travelled_steps, strict=True)
    return [
        abs(now - then) == far - near for (then, now), (near, far) in zip(counts, ways, strict=True)
    ]


def _are_within(record: SavedState, turned_steps: Steps) -> bool:
    """Every motor, as far as its carriage follows it at all."""
    assert record.motion is not None
    return all(
        low <= at + turned <= high
        for low, at, turned, high in zip(
            record.motion.low_steps,
            record.position_steps,
            turned_steps,
            record.motion.high_steps,
            strict=True,
        )
    )


def _doubt(
    old: KeptDoubt | None, slack_steps: Steps, axes: tuple[Axis, ...], is_sure: list[bool]
) -> KeptDoubt | None:
    """See rule 2; a doubt of before goes on."""
    if all(is_sure) or (old is not None and not old.spans_steps):
        return old
    before = old.spans_steps if old else ((0, 0),) * len(axes)
    spans = tuple(
        (below, above) if sure else (below + slack, above + axis.backlash_steps - slack)
        for (below, above), slack, axis, sure in zip(
            before, slack_steps, axes, is_sure, strict=True
        )
    )
    return KeptDoubt(why=IN_MOTION, spans_steps=spans)
