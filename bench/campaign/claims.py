"""What a machine claims of its place once a program is gone, against where its carriages are."""

from dataclasses import dataclass

from tests.rigs.lpt.shop import Answer, Shop

#: What is said where no place is claimed.
_UNKNOWN = "ended while the machine moved"


@dataclass(frozen=True)
class Claim:
    """What ``fraese where`` says.

    Attributes:
        low_steps: the place of each axis is not below this,
        high_steps: and not above that; both None: no place is claimed.
    """

    low_steps: tuple[int, ...] | None
    high_steps: tuple[int, ...] | None

    @property
    def width_steps(self) -> int:
        """The widest of the bounds; 0: to the step."""
        if self.low_steps is None or self.high_steps is None:
            return 0
        return max(h - low for low, h in zip(self.low_steps, self.high_steps, strict=True))

    def beyond_steps(self, truth_steps: tuple[int, ...]) -> int:
        """How far the truth lies outside, all axes added up."""
        if self.low_steps is None or self.high_steps is None:
            return 0
        return sum(
            max(low - true, true - high, 0)
            for low, high, true in zip(self.low_steps, self.high_steps, truth_steps, strict=True)
        )


def claim_of(answer: Answer) -> Claim:
    """From the answer of ``where --json``."""
    assert answer.code == 0, answer.noted
    if _UNKNOWN in answer.noted:
        return Claim(None, None)
    steps = tuple(answer.result["position_steps"].values())
    return Claim(steps, steps)


def claimed(shop: Shop) -> Claim:
    """Ask the machine of a shop, in a new process."""
    return claim_of(shop.command("where", "--json"))
