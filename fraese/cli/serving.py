"""How senders come to a machine, as configured and as said, with an app or without."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fraese.config.edit import file_to_write, set_keys
from fraese.config.file import from_table, load
from fraese.config.serving import ServeConfig, address_of
from fraese.control.adopting import adopt, is_at_once
from fraese.control.controller import Controller
from fraese.phrases import phrase
from fraese.serve.access import Access, token_of
from fraese.serve.pty import PtyDoor
from fraese.serve.server import Door
from fraese.serve.settings import Changes
from fraese.serve.system import Write
from fraese.serve.tcp import TcpDoor


def how_served(configured: ServeConfig, given: Mapping[str, Any]) -> ServeConfig:
    """How senders come in: as configured, but for what was said.

    Raises:
        ConfigError: what was said makes no sense.
    """
    said = {
        key: str(value) if isinstance(value, Path) else value
        for key, value in given.items()
        if value is not None
    }
    table = {**configured.model_dump(mode="json"), **said}
    return from_table({"serve": table}, "fraese serve").serve


def access_of(how: ServeConfig) -> Access:
    """Who may come in.

    Raises:
        ConfigError: the file of the token holds none.
    """
    token = token_of(Path(how.token_file).expanduser() if how.token_file else None)
    return Access(how.networks, token)


def doors_of(how: ServeConfig, access: Access, wants_turn: Callable[[], object]) -> list[Door]:
    """What senders come in by.

    Raises:
        PortError: one of them cannot be had.
        ConfigError: the link cannot be made.
    """
    doors: list[Door] = [PtyDoor(how.link_path, wants_turn)]
    if how.tcp:
        try:
            doors.append(TcpDoor(*address_of(how.tcp), access, wants_turn))
        except BaseException:
            doors[0].close()
            raise
    return doors


def writer(named: Path | None, controller: Controller) -> Write:
    """What writes keys of the configuration, and puts into force what counts at once.

    Args:
        named: the file, by the user; None: the one that is found.
        controller: of the machine; called in its thread.
    """

    def write(changes: Changes) -> str:
        path = file_to_write(named)
        set_keys(path, changes)
        adopt(controller, load(path))
        later = [key for key in changes if not is_at_once(key)]
        return (
            phrase("Written to {path}; it counts from the next start.", path=path) if later else ""
        )

    return write
