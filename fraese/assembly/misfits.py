"""What in a configuration does not suit: the phase table, and the simulated mill.

Nothing here is refused: a motor may be an unusual one, and a simulated mill is there to show what a
wrong configuration does. It is said, a sentence for all axes that it is true of.
"""

from collections.abc import Iterator
from fractions import Fraction

from fraese.assembly.trueaxis import TrueAxis, true_axes
from fraese.config import Config
from fraese.config.axis import AxisConfig
from fraese.kinds.card import card_kind
from fraese.phrases import joined, phrase


def misfits(config: Config) -> tuple[str, ...]:
    """Everything that does not suit.

    Raises:
        ConfigError: if the card cannot be built as configured.
    """
    axes_by_text: dict[str, list[str]] = {}
    for name, text in (*card_kind(config).misfits(config), *_of_simulation(config)):
        axes_by_text.setdefault(text, []).append(name.upper())
    return tuple(
        joined("", (", ".join(names), ": ", text, ".")) for text, names in axes_by_text.items()
    )


def described(config: Config) -> str:
    """What the card is by its tables, a sentence; empty where it has none."""
    return card_kind(config).described(config)


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
        if not card_kind(config).divides and config.simulation.own(true.name).microsteps:
            yield (
                true.name,
                phrase(
                    "microsteps in simulation.axes has no effect: no drive makes the steps"
                    " on {kind}",
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
