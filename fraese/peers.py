"""Who stands behind a name of the configuration: one of ours, or one of a package of its own.

    seam    key            a package of its own says, in its pyproject.toml
    CARDS   card.kind      [project.entry-points."fraese.cards"]   name = "module:RECORD"
    PORTS   port.kind      [project.entry-points."fraese.ports"]   name = "module:RECORD"
    RAMPS   planner.ramp   [project.entry-points."fraese.ramps"]   name = "module:RECORD"
    WORDS   (M100 to M199) [project.entry-points."fraese.words"]   M110 = "module:RECORD"

Rule 1: a name leads to a record, by "module:RECORD", ours like theirs. Nothing is imported before
        it is asked for: so the configuration asks by name for what only higher floors know.
Rule 2: a name of ours is ours, whatever is installed; a name leads to one record.
Rule 3: a package that cannot be used is told of in one sentence. Nobody is stopped by it who does
        not name it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from fraese.errors import ConfigError
from fraese.phrases import phrase

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


@dataclass(frozen=True)
class Seam:
    """A key of the configuration whose choices follow from records.

    Attributes:
        key: with its dots.
        group: of entry points.
        kind: what a record must be, "module:class".
        ours: "module:RECORD" of each of ours, by its name.
    """

    key: str
    group: str
    kind: str
    ours: Mapping[str, str]

    def __hash__(self) -> int:
        return hash(self.group)

    @property
    def names(self) -> tuple[str, ...]:
        """Every name that there is now, ours first."""
        theirs = sorted({each.name for each in _installed(self.group)} - self.ours.keys())
        return (*self.ours, *theirs)

    def has(self, name: str) -> bool:
        """Somebody stands behind it."""
        return name in self.ours or any(each.name == name for each in _installed(self.group))

    def record(self, name: str) -> Any:
        """The record behind a name.

        Raises:
            ConfigError: there is none, or its package cannot be used.
        """
        return _loaded(self, name)


def _installed(group: str) -> "tuple[EntryPoint, ...]":
    # Takes as long as the rest of a configuration: nobody pays for it who names one of ours.
    from importlib.metadata import entry_points

    return tuple(entry_points(group=group))


def _object(place: str) -> Any:
    """What "module:name" names."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


@cache
def _loaded(seam: Seam, name: str) -> Any:
    if name in seam.ours:
        return _object(seam.ours[name])
    found = next((each for each in _installed(seam.group) if each.name == name), None)
    if found is None:
        raise ConfigError(
            phrase(
                '{key}: there is no "{name}"; there are {names}.',
                key=seam.key,
                name=name,
                names=", ".join(seam.names),
            )
        )
    package = found.dist.name if found.dist else found.module
    try:
        record = found.load()
    except Exception as error:  # Whatever a stranger's module may raise.
        raise ConfigError(
            phrase(
                '{key} "{name}": its package {package} cannot be loaded: {error}.',
                key=seam.key,
                name=name,
                package=package,
                error=f"{type(error).__name__}: {error}",
            )
        ) from error
    if not isinstance(record, _object(seam.kind)):
        raise ConfigError(
            phrase(
                '{key} "{name}": {value} of its package {package} is no {kind}.',
                key=seam.key,
                name=name,
                value=found.value,
                package=package,
                kind=seam.kind.replace(":", "."),
            )
        )
    return record


CARDS: Final = Seam(
    "card.kind",
    "fraese.cards",
    "fraese.kinds.card:CardKind",
    {"smc1500": "fraese.kinds.smc1500:CARD", "stepdir": "fraese.kinds.stepdir:CARD"},
)
PORTS: Final = Seam(
    "port.kind",
    "fraese.ports",
    "fraese.kinds.port:PortKind",
    {
        "simulation": "fraese.kinds.port:SIMULATION",
        "ppdev": "fraese.kinds.port:PPDEV",
        "devport": "fraese.kinds.port:DEVPORT",
        "bridge": "fraese.kinds.port:BRIDGE",
    },
)
RAMPS: Final = Seam(
    "planner.ramp",
    "fraese.ramps",
    "fraese.planner.laws:RampKind",
    {
        "linear": "fraese.planner.laws:LINEAR",
        "sine": "fraese.planner.laws:SINE",
        "s-curve": "fraese.planner.laws:S_CURVE",
    },
)
#: Words of the language that fraese leaves to others.
WORDS: Final = Seam("M-code", "fraese.words", "fraese.gcode.userwords:Word", {})
