"""Which files belong to a machine: its kind of port and its device make the name.

    simulation.journal    ppdev-parport0.journal    bridge-ttyUSB0.journal    ....lock

Rule 1: two machines never have one name: what a file name cannot hold is replaced, and then a
        digest of the device stands behind it.
"""

import hashlib
import re
from pathlib import Path
from typing import Final

_PLAIN: Final = re.compile(r"/dev/([A-Za-z0-9][A-Za-z0-9.]{0,60})")
_FOREIGN: Final = re.compile(r"[^A-Za-z0-9.]+")
_MOST_CHARACTERS: Final = 40
_DIGEST: Final = 8


def machine_file(folder: Path, kind: str, device: str) -> Path:
    """Where the journal of a machine lies; its other files differ by their suffix.

    Args:
        folder: of the state.
        kind: of the port.
        device: path, address or name; empty: there is only one.
    """
    return folder / (f"{kind}-{_safe(device)}.journal" if device else f"{kind}.journal")


def _safe(device: str) -> str:
    plain = _PLAIN.fullmatch(device)
    if plain:
        return plain[1]
    digest = hashlib.sha256(device.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGEST]
    return f"{_FOREIGN.sub('-', device).strip('-.')[-_MOST_CHARACTERS:]}-{digest}"
