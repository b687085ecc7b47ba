"""How fast jogs go, asked as a number."""

import re
from typing import Final

from fraese.errors import UsageError
from fraese.phrases import spoken
from fraese.ui.dialogs.line import LineDialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.machinelink import MachineLink
from fraese.ui.widths import plain_rate

_RATE: Final = re.compile(r"f?\s*=?\s*(\d+(?:[.,]\d*)?)\s*(?:(?:mm|°)?/min)?", re.IGNORECASE)


class JogRateDialog(LineDialog):
    """A rate for all jogs from now on; also while the machine runs. The result is its text.

    Args:
        keys: the table.
        link: to the machine.
        configured_mm_min: what the configuration says.
    """

    AREA = Area.JOG_RATE
    HEADING = spoken("How fast jogs go, in mm (degrees) a minute")
    YES = spoken("Set it")

    def __init__(self, keys: KeyTable, link: MachineLink, configured_mm_min: float) -> None:
        example = spoken(
            "nothing: {configured}, as the configuration says",
            configured=plain_rate(configured_mm_min),
        )
        super().__init__(keys, link, plain_rate(link.jog_rate.feed_mm_min), example)

    def accept(self, line: str) -> None:
        """Nothing moves by it: it needs no turn of the machine's."""
        self.link.jog_rate.choose(_rate(line))
        self.taken(line)


def _rate(line: str) -> float | None:
    """The number; None: none is wanted.

    Raises:
        UsageError: if it is no number.
    """
    if not line:
        return None
    found = _RATE.fullmatch(line)
    if found is None:
        raise UsageError(spoken('"{line}" is no rate: type a number such as 600.', line=line))
    return float(found[1].replace(",", "."))
