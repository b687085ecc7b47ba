"""Which keys of the configuration may change while the program runs, and how they are taken over.

Rule 1: at once counts only what every command looks up anew: how one jogs, references, runs and
        plans, and the tools. What a machine was put together from waits for the next start.
Rule 2: what has been taken over fits to what has not, or nothing is taken over.
"""

from collections.abc import Mapping
from typing import Final

from fraese.config import Config
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.phrases import phrase

#: By table: keys that were looked up once, at the start; all others of it count at once.
_AT_ONCE: Final[Mapping[str, frozenset[str]]] = {
    "jog": frozenset(),
    "tools": frozenset(),
    "planner": frozenset(),
    # How far it is from the switch to machine zero is in every position since.
    "homing": frozenset({"pull_off_mm"}),
    "run": frozenset({"lead_s", "optional_stop", "block_delete"}),
}


def is_at_once(key: str) -> bool:
    """Whether a key counts from now on; else from the next start.

    Args:
        key: with its dots, as in ``jog.feed_mm_min``.
    """
    table, _, name = key.partition(".")
    return table in _AT_ONCE and name not in _AT_ONCE[table]


def adopt(controller: Controller, wanted: Config) -> None:
    """Take over what counts at once; in the machine's thread.

    Args:
        controller: of the machine.
        wanted: the whole configuration as it stands now.

    Raises:
        StateError: if something runs, or it does not fit to what waits for the next start.
    """
    if controller.status is Status.RUN:
        raise StateError(phrase("The machine runs: a configuration is not changed under it."))
    mixed = _mixed(controller.config, wanted)
    try:
        mixed.must_fit_together()
    except ValueError as error:
        raise StateError(
            phrase("It counts from the next start, with what else was changed.")
        ) from error
    controller.config = mixed


def _mixed(old: Config, new: Config) -> Config:
    tables = {}
    for table, left in _AT_ONCE.items():
        theirs, ours = getattr(old, table), getattr(new, table)
        if left:
            ours = ours.model_copy(update={name: getattr(theirs, name) for name in left})
        tables[table] = ours
    return old.model_copy(update=tables)
