"""All kinds of faults: one line for each module of them."""

from typing import Final

from bench.campaign import bridge, lastwords, signals, survivors, terminals
from bench.campaign.frame import Kind

KINDS: Final[tuple[Kind, ...]] = (
    *signals.KINDS,
    *lastwords.KINDS,
    *survivors.KINDS,
    *terminals.KINDS,
    *bridge.KINDS,
)
