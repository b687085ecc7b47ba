r"""Backlash: what the motor turns and the carriage does not see.

    carriage = motor + slack          0 <= slack <= backlash

    slack ^ backlash |      ______________      the motor turns back: first the slack grows,
          |          |     /              \     then the carriage follows; turning forward it
          |          |____/                \__  shrinks to nothing first
          +------------------------------------> time

Rule 1: the planner inserts motor steps where an axis reverses, in a block of their own before the
        move: the path is not bent, and the junction rule holds for them as for any other move.
Rule 2: the position is the carriage's. It follows from the motor's counts by the same play, here
        and nowhere else. A stretch in which a motor does not turn round, a block or a part of
        one, may be taken in one go.
Rule 3: where nothing else is known the slack is nil: the axis was last moved upwards.
"""

from collections.abc import Sequence

from fraese.machine import Machine, Steps


def followed(slack_steps: int, backlash_steps: int, motor_steps: int) -> tuple[int, int]:
    """Steps that the carriage makes, and the slack afterwards.

    Args:
        slack_steps: carriage ahead of motor, before.
        backlash_steps: greatest slack.
        motor_steps: signed turn of the motor, in axis direction, without turning round.
    """
    slack_after = min(max(slack_steps - motor_steps, 0), backlash_steps)
    return motor_steps + slack_after - slack_steps, slack_after


def take_up(slack_steps: int, backlash_steps: int, direction: int) -> int:
    """Signed motor steps until the carriage follows in a direction; 0 if it does already."""
    if direction > 0:
        return slack_steps
    return slack_steps - backlash_steps if direction else 0


class Carriages:
    """Where the axes really are, from what the motors really did.

    Args:
        machine: backlash and motor directions.
        position_steps: the axes' positions now, in axis steps.
        slack_steps: carriage ahead of motor, per axis; None: nil.

    Attributes:
        position_steps: after everything that was advanced.
        slack_steps: likewise.
    """

    def __init__(
        self, machine: Machine, position_steps: Steps, slack_steps: Steps | None = None
    ) -> None:
        self._signs = tuple(axis.motor_sign for axis in machine.axes)
        self._backlash_steps = tuple(axis.backlash_steps for axis in machine.axes)
        self.position_steps = position_steps
        self.slack_steps = slack_steps or (0,) * len(position_steps)

    def advance(self, motor_steps: Sequence[int]) -> None:
        """Take up a finished block, or the part of one that was played before it was dropped."""
        self.position_steps, self.slack_steps = self._after(motor_steps)

    def seen(self, motor_steps: Sequence[int]) -> Steps:
        """Position with so many signed motor steps of the present block done; nothing is kept."""
        return self._after(motor_steps)[0]

    def slack_seen(self, motor_steps: Sequence[int]) -> Steps:
        """The slack there; nothing is kept."""
        return self._after(motor_steps)[1]

    def _after(self, motor_steps: Sequence[int]) -> tuple[Steps, Steps]:
        moved = [
            followed(slack, backlash, sign * steps)
            for slack, backlash, sign, steps in zip(
                self.slack_steps, self._backlash_steps, self._signs, motor_steps, strict=True
            )
        ]
        position_steps = tuple(
            at + steps for at, (steps, _) in zip(self.position_steps, moved, strict=True)
        )
        return position_steps, tuple(slack for _, slack in moved)
