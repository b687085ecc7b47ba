"""What in a configuration does not suit: the phase table, and the simulated mill.

Nothing here is refused: a motor may be an unusual one, and a simulated mill is there to show what a
wrong configuration does. It is said, a sentence for all axes that it is true of.
"""

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from typing import Final

from fraese.assembly.cards import checked_table
from fraese.assembly.trueaxis import TrueAxis, true_axes
from fraese.config import Config
from fraese.config.axis import AxisConfig
from fraese.motor.phases import FULL_STEPS_PER_REV, describe_table, steps_per_rev
from fraese.phrases import joined, phrase


def misfits(config: Config) -> tuple[str, ...]:
    """Everything that does not suit.

    Raises:
        ConfigError: if the card cannot be built as configured.
    """
    axes_by_text: dict[str, list[str]] = {}
    for name, text in (*_CARDS[config.card.kind](config), *_of_simulation(config)):
        axes_by_text.setdefault(text, []).append(name.upper())
    return tuple(
        joined("", (", ".join(names), ": ", text, ".")) for text, names in axes_by_text.items()
    )


def described(config: Config) -> str:
    """What the phase table is, a sentence; empty where there is none."""
    if config.card.kind != "smc1500":
        return ""
    return phrase(
        "card.table: {describe_table}.", describe_table=describe_table(checked_table(config.card))
    )


def _of_table(config: Config) -> Iterator[tuple[str, str]]:
    """Steps of a table in a turn of any motor that is sold: half a sentence for each axis."""
    table = checked_table(config.card)
    known = [steps_per_rev(table, full_steps) for full_steps in FULL_STEPS_PER_REV]
    for name, axis in config.axes.table.items():
        if all(axis.steps_per_rev % steps for steps in known):
            yield (
                name,
                phrase(
                    "steps_per_rev {steps_per_rev} does not suit card.table ({describe_table})",
                    steps_per_rev=axis.steps_per_rev,
                    describe_table=describe_table(table),
                ),
            )


def _of_drives(_config: Config) -> Iterator[tuple[str, str]]:
    """Their switches may be set to anything."""
    return iter(())


_CARDS: Final[Mapping[str, Callable[[Config], Iterator[tuple[str, str]]]]] = {
    "smc1500": _of_table,
    "stepdir": _of_drives,
}


def _of_simulation(config: Config) -> Iterator[tuple[str, str]]:
    """What will go wrong on the simulated mill, if that is the machine."""
    if config.port.kind != "simulation":
        return
    for true in true_axes(config):
        axis = config.axes.table[true.name]
        ratio = true.ratio(axis)
        if ratio != 1:
            yield (
                true.name,
                phrase(
                    "{with_unit} becomes {with_unit_2} on the simulated mill ({differences};"
                    " see simulation.axes)",
                    with_unit=true.with_unit(1),
                    with_unit_2=true.with_unit(ratio),
                    differences=joined(", ", _differences(true, axis)),
                ),
            )
        if true.travel is not None and true.travel != axis.travel:
            configured = phrase("endless") if axis.travel is None else f"{float(axis.travel):g}"
            yield (
                true.name,
                phrase(
                    "travel_{key_unit} {configured}, really {travel:g} on the simulated mill"
                    " (see simulation.axes)",
                    key_unit=axis.key_unit,
                    configured=configured,
                    travel=float(true.travel),
                ),
            )
        if config.card.kind != "stepdir" and config.simulation.own(true.name).microsteps:
            yield (
                true.name,
                phrase(
                    "microsteps in simulation.axes has no effect: steps are made by"
                    " card.table on {kind}",
                    kind=config.card.kind,
                ),
            )
        if axis.motor - 1 != true.socket:
            yield (
                true.name,
                phrase(
                    "its motor hangs on socket {socket} of the simulated mill, not on {motor}",
                    socket=true.socket + 1,
                    motor=axis.motor,
                ),
            )
        too_much = list(_of_rates(true, axis))
        if too_much:
            yield (
                true.name,
                phrase(
                    "the simulated motor cannot follow: {too_much}", too_much=joined(", ", too_much)
                ),
            )


def _differences(true: TrueAxis, axis: AxisConfig) -> Iterator[str]:
    """What makes a way on the simulated mill another one."""
    for key, configured, really in (
        ("steps_per_rev", axis.steps_per_rev, true.steps_per_rev),
        (f"pitch_{axis.key_unit}", Fraction(axis.pitch), true.pitch),
        ("gear", Fraction(axis.gear), true.gear),
    ):
        if configured != really:
            yield phrase(
                "{key} {configured:g}, really {really:g}",
                key=key,
                configured=float(configured),
                really=float(really),
            )
    if axis.inverted != (true.sign < 0):
        yield phrase(
            "inverted {inverted}, really {what}",
            inverted=str(axis.inverted).lower(),
            what=str(true.sign < 0).lower(),
        )
    if true.sense < 0:
        yield phrase("card.table turns backwards")


def _of_rates(true: TrueAxis, axis: AxisConfig) -> Iterator[str]:
    motor = true.motor
    for key, rate, follows in (
        ("max_rate_hz", axis.max_rate_hz, motor.max_turns_s),
        ("start_rate_hz", axis.start_rate_hz, motor.start_turns_s),
        ("acceleration_hz_s", axis.acceleration_hz_s, motor.acceleration_turns_s2),
    ):
        turns = float(rate / true.steps_per_rev)
        if turns > follows:
            yield phrase(
                "{key} {rate:g} is {turns:g} in turns, it follows {follows:g}",
                key=key,
                rate=rate,
                turns=turns,
                follows=follows,
            )
