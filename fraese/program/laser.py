"""The beam of a laser as a program has it, and as the planner was told.

Rule 1: it changes with the first tick of the next move, without a stop.
Rule 2: it burns along feeds and arcs only. S0, and no S at all where S sets its power, are dark.
Rule 3: where the port can set its power, S is a share of it: M3 for as long as it burns, M4 at the
        programmed feed and in proportion below and above it. Elsewhere it is on or off.
"""

from collections.abc import Sequence
from typing import Final

from fraese.blocks import FULL_POWER, Block
from fraese.config.outputs import OutputsConfig
from fraese.gcode import canon
from fraese.planner.planner import Planner

_CUTTING: Final = frozenset({canon.Feed, canon.Arc})


def _cuts(move: canon.Move) -> bool:
    """Along it a beam burns."""
    return type(move) in _CUTTING or (
        isinstance(move, canon.Along) and move.feed_mm_min is not None
    )


class Laser:
    """The beam of one program.

    Args:
        outputs: what hangs on them.

    Attributes:
        mask: of its output; 0: there is no laser.
    """

    def __init__(self, outputs: OutputsConfig) -> None:
        self.mask = outputs.mask("laser")
        self._config = outputs.laser
        # Share of its power, and whether that goes with the speed.
        self._wanted = self._told = (0, False)

    def along(self, move: canon.Move, planner: Planner) -> Sequence[Block]:
        """This move comes next: blocks that became final by it."""
        return self._tell(self._wanted if _cuts(move) else (0, False), planner)

    def switch(self, move: canon.Spindle, planner: Planner) -> Sequence[Block]:
        """M3, M4, M5 or S; what is dark stays so up to the next move."""
        self._wanted = self._power(move)
        return self._tell(self._wanted if self._told[0] else (0, False), planner)

    def percent(self, move: canon.Spindle) -> float | None:
        """How much of its power S means; None: it is on or off."""
        config = self._config
        if config is None or not config.pwm:
            return None
        return 100 * min(1.0, move.rev_min / config.power_max_s) if move.has_speed else 0.0

    def _power(self, move: canon.Spindle) -> tuple[int, bool]:
        config = self._config
        if config is None or not move.is_on:
            return 0, False
        if not config.pwm:
            return FULL_POWER, False
        share = min(1.0, move.rev_min / config.power_max_s)
        # The least power that can be set is not none.
        return (max(1, round(FULL_POWER * share)) if share else 0), move.direction < 0

    def _tell(self, power: tuple[int, bool], planner: Planner) -> Sequence[Block]:
        if power == self._told:
            return ()
        share, follows = power
        was_on, self._told = bool(self._told[0]), power
        blocks: list[Block] = []
        if bool(share) is not was_on:
            blocks += planner.outputs(self.mask, self.mask if share else 0)
        if self._config is not None and self._config.pwm:
            blocks += planner.beam(share, follows=follows)
        return blocks
