"""Straight lines by hand: what a jog, a move, a reference run and a lift are made of.

Rule 1: every line goes from rest to rest. A program's lines go through the look-ahead instead.
Rule 2: what moves by hand obeys the feed override: also where it goes as fast as the axes can.
Rule 3: backlash is taken up first, in a block of its own; a watched line is one block, so that its
        watch sees the contact wherever it comes.
"""

from collections.abc import Iterator, Sequence

from fraese.blocks import OVERRIDES, Block, Watch
from fraese.control.jobs import Job
from fraese.control.position import Position
from fraese.machine import Machine, Steps
from fraese.planner.backlash import take_up
from fraese.planner.lines import plan_line


def line_blocks(
    position: Position,
    delta: Steps,
    feed_mm_min: float | None = None,
    watch: Watch | None = None,
    most: float = 0.0,
) -> Iterator[Block]:
    """A straight line from here.

    Args:
        position: from where, and with how much slack.
        delta: signed axis steps.
        feed_mm_min: along the line; None: as fast as the axes can.
        watch: condition while it plays; then only one axis may move.
        most: the highest feed override that acts on it; 0: none does.
    """
    machine = position.machine
    turned = _taken_up(machine, position.slack_steps, delta)
    if watch is not None:
        whole = tuple(n + extra for n, extra in zip(delta, turned, strict=True))
        yield from _made(plan_line(machine, whole, feed_mm_min, watch=watch, most=most))
        return
    yield from _made(plan_line(machine, turned))
    yield from _made(plan_line(machine, delta, feed_mm_min, most=most))


def slack_after(position: Position, delta: Steps) -> Steps:
    """Backlash between motor and carriage after such a line."""
    before = position.slack_steps
    return _difference(before, _taken_up(position.machine, before, delta))


def line(
    position: Position,
    delta: Steps,
    feed_mm_min: float | None = None,
    watch: Watch | None = None,
    most: float = 0.0,
) -> Job:
    """A straight line from here as a job; see ``line_blocks``."""
    for block in line_blocks(position, delta, feed_mm_min, watch, most):
        yield block


def axis_line(
    position: Position,
    motor: int,
    steps: int,
    feed_mm_min: float | None,
    watch: Watch | None,
    most: float = 0.0,
) -> Job:
    """The same of one axis."""
    delta = [0] * len(position.machine.axes)
    delta[motor] = steps
    return line(position, tuple(delta), feed_mm_min, watch, most)


def line_to(
    position: Position,
    target: Steps,
    feed_mm_min: float | None = None,
    watch: Watch | None = None,
) -> Job:
    """The same to a machine position, which is the aim from then on."""
    position.aim_steps = target
    delta = _difference(target, position.position_steps)
    yield from line(position, delta, feed_mm_min, watch, OVERRIDES[1])


def curve(position: Position, targets: Sequence[Steps], feed_mm_min: float | None) -> Job:
    """Straight lines through machine positions; each block is tagged with its number, from 1."""
    machine = position.machine
    here, slack = position.position_steps, position.slack_steps
    for number, target in enumerate(targets, start=1):
        delta, here = _difference(target, here), target
        turned = _taken_up(machine, slack, delta)
        slack = _difference(slack, turned)
        for block in (
            plan_line(machine, turned, tag=number),
            plan_line(machine, delta, feed_mm_min, tag=number, most=OVERRIDES[1]),
        ):
            if block is not None:
                yield block


def _taken_up(machine: Machine, slack_steps: Steps, delta: Steps) -> Steps:
    """Motor steps until the carriages follow in the directions of a line."""
    return tuple(
        take_up(slack, axis.backlash_steps, n)
        for slack, axis, n in zip(slack_steps, machine.axes, delta, strict=True)
    )


def _difference(to: Steps, at: Steps) -> Steps:
    return tuple(a - b for a, b in zip(to, at, strict=True))


def _made(block: Block | None) -> Iterator[Block]:
    """A block, if there is one to make."""
    if block is not None:
        yield block
