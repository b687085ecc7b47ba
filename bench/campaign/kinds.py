"""All kinds of faults: one line for each module of them."""

from typing import Final

from bench.campaign import bridge, signals
from bench.campaign.frame import Kind

KINDS: Final[tuple[Kind, ...]] = (*signals.KINDS, *bridge.KINDS)
