"""Motors off, by the parent, when the child can no longer do it."""

import time
from collections.abc import Callable
from typing import Final

from fraese.errors import PortError
from fraese.motor.seams import CONTROL, DATA, Card, IdleLevel, Port

#: The child may have died with the strobe set: then the first byte has no edge and is not latched.
_TIMES: Final = 2
#: A port that was a dead process's a moment ago may be busy still, s.
PATIENCE_S: Final = 0.08
_RETRY_S: Final = 0.002


def switch_off(open_port: Callable[[], Port], card: Card, patience_s: float = PATIENCE_S) -> None:
    """Open the port again, write outputs and currents off, give it back.

    Args:
        open_port: as the child did it.
        card: what is on the port. It need not know what the child wrote: off is off.
        patience_s: how long to try while the port is busy.

    Raises:
        PortError: if it cannot be opened in that time, or goes away.
    """
    port = _reopened(open_port, patience_s)
    access = {DATA: port.write_data, CONTROL: port.write_control}
    try:
        for register, value in (*card.set_outputs(~0, 0), *card.idle(IdleLevel.OFF)) * _TIMES:
            access[register](value)
    finally:
        port.close()


def _reopened(open_port: Callable[[], Port], patience_s: float) -> Port:
    until_s = time.monotonic() + patience_s
    while True:
        try:
            return open_port()
        except PortError:
            if time.monotonic() >= until_s:
                raise
            time.sleep(_RETRY_S)
