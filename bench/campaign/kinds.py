"""All kinds of faults: one line for each module of them."""

from typing import Final

from bench.campaign import (
    bridge,
    cuts,
    damage,
    disks,
    lastwords,
    lines,
    signals,
    surroundings,
    survivors,
    switches,
    terminals,
)
from bench.campaign.frame import Kind

KINDS: Final[tuple[Kind, ...]] = (
    *signals.KINDS,
    *switches.KINDS,
    *lines.KINDS,
    *surroundings.KINDS,
    *damage.KINDS,
    *disks.KINDS,
    *cuts.KINDS,
    *lastwords.KINDS,
    *survivors.KINDS,
    *terminals.KINDS,
    *bridge.KINDS,
)
