"""What a machine claims of its place once a program is gone, against where its carriages are."""

from dataclasses import dataclass
from typing import Final

from tests.rigs.lpt.shop import Answer, Shop

#: No wider than what was played since the last record, which is so old at most.
NO_WIDER_S: Final = 0.25


@dataclass(frozen=True)
class Claim:
    """What a command says of the place; to the step, or between bounds.

    Attributes:
        low_steps: the place of each axis is not below this,
        high_steps: and not above that; both None: no place is claimed.
    """

    low_steps: tuple[int, ...] | None
    high_steps: tuple[int, ...] | None

    @property
    def is_to_the_step(self) -> bool:
        """One place is claimed, and no other one is said to be possible."""
        return self.low_steps is not None and self.low_steps == self.high_steps

    @property
    def width_steps(self) -> int:
        """The widest of the bounds; 0: to the step."""
        if self.low_steps is None or self.high_steps is None:
            return 0
        return max(h - low for low, h in zip(self.low_steps, self.high_steps, strict=True))

    def width_s(self, rate_hz: float) -> float:
        """How long an axis that makes so many steps a second takes from the one to the other."""
        return self.width_steps / rate_hz

    def beyond_steps(self, truth_steps: tuple[int, ...]) -> int:
        """How far the truth lies outside, all axes added up."""
        if self.low_steps is None or self.high_steps is None:
            return 0
        return sum(
            max(low - true, true - high, 0)
            for low, high, true in zip(self.low_steps, self.high_steps, truth_steps, strict=True)
        )


def claim_of(answer: Answer) -> Claim:
    """From the answer of a command with ``--json``."""
    assert answer.code == 0, answer.noted
    doubt = answer.result["doubt"]
    if doubt is None:
        steps = tuple(answer.result["position_steps"].values())
        return Claim(steps, steps)
    if doubt["low_steps"] is None:
        return Claim(None, None)
    return Claim(tuple(doubt["low_steps"].values()), tuple(doubt["high_steps"].values()))


def claimed(shop: Shop) -> Claim:
    """Ask the machine of a shop, in a new process."""
    return claim_of(shop.command("where", "--json"))
