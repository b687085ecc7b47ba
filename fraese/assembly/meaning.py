"""What gives the numbers of a kept state their meaning, and which of them still have one.

Rule 1: a word for each axis. Configured otherwise, nothing that was kept means anything.
Rule 2: a simulated mill adds what its carriages are counted in. Files from before it had facts of
        its own have no such word: it was as configured then, and counted pulses on stepdir.
Rule 3: where only the machine is another one, work offsets keep their meaning: they are lengths.
"""

from typing import Final

from fraese.assembly.trueaxis import TrueAxis, true_axes
from fraese.config import Config
from fraese.control.savedstate import SavedState
from fraese.kinds.card import card_kind
from fraese.machine import Machine
from fraese.phrases import phrase

_OTHERWISE: Final = phrase(
    "The axes were configured otherwise before: the old position is forgotten."
)
_ANOTHER: Final = phrase(
    "The old position is that of another machine, or of the simulated mill as it was"
    " otherwise: it is forgotten, the work offsets are kept."
)
_ON: Final = " on "


def meaning(config: Config, machine: Machine) -> tuple[str, ...]:
    """What steps, phases and slack are counted in: a word per axis."""
    words = _of_axes(config, machine)
    if config.port.kind != "simulation":
        return words
    trues = true_axes(config)
    return tuple(f"{word}{_ON}{true.in_words}" for word, true in zip(words, trues, strict=True))


def fits_old(kept: SavedState, config: Config, machine: Machine) -> bool:
    """Whether a file that any machine may have written is of this one, or of one like it."""
    words = tuple(word.partition(_ON)[0] for word in kept.axes)
    is_simulated = config.port.kind == "simulation"
    return words == _of_axes(config, machine) and bool(kept.simulation) == is_simulated


def still_meant(
    kept: SavedState, config: Config, machine: Machine
) -> tuple[SavedState | None, str]:
    """What of a kept state can be taken up, and what is to be said about the rest."""
    if kept.axes == meaning(config, machine):
        return kept, ""
    words = _of_axes(config, machine)
    if tuple(word.partition(_ON)[0] for word in kept.axes) != words:
        return None, _OTHERWISE
    trues, axes = true_axes(config), config.axes.table.values()
    if (
        kept.axes == words
        and kept.simulation
        and all(true.suits(axis) for true, axis in zip(trues, axes, strict=True))
    ):
        return _in_half_steps(kept, config, trues), ""
    return _only_offsets(kept), _ANOTHER


def _of_axes(config: Config, machine: Machine) -> tuple[str, ...]:
    word = card_kind(config).word(config)
    return tuple(
        f"{config.card.kind} {word} {axis.steps_per_mm} {axis.motor_sign} {axis.home_sign}"
        f" {axis.low_mm} {axis.high_mm} {axis.backlash_steps}{other}"
        for axis, other in zip(machine.axes, _unusual(config), strict=True)
    )


def _unusual(config: Config) -> list[str]:
    """Name and socket of each axis, where they are not those of a mill of X, Y and Z."""
    usual = [("x", 0), ("y", 1), ("z", 2)]
    axes = list(zip(config.axes.names, config.axes.sockets, strict=True))
    return ["" if axes == usual else f" {name} {socket}" for name, socket in axes]


def _in_half_steps(kept: SavedState, config: Config, trues: tuple[TrueAxis, ...]) -> SavedState:
    """A simulated mill as older files keep it, see rule 2."""
    if not card_kind(config).divides:
        return kept
    scales = [float(true.half_steps_per_step) for true in trues]
    simulation = tuple(
        (position * scale, lost * scale, angle, slack * scale)
        for (position, lost, angle, slack), scale in zip(kept.simulation, scales, strict=True)
    )
    return kept.model_copy(update={"simulation": simulation})


def _only_offsets(kept: SavedState) -> SavedState:
    """Nothing is known but the work offsets."""
    count = len(kept.position_steps)
    nothing = (0,) * count
    return SavedState(
        position_steps=nothing,
        slack_steps=nothing,
        parameters=kept.parameters,
        referenced=(False,) * count,
        phases=nothing,
    )
