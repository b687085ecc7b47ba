"""Cards as configured: one function and one row for each.

Another card is a class like ``SmcCard``, and a row in ``CARDS``.
"""

from collections.abc import Callable, Mapping
from typing import Final

from fraese.config import Config
from fraese.config.wiring import CardConfig, LaserConfig, OutputConfig
from fraese.errors import ConfigError
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.cards.stepdir import STEPDIR_PROFILES, StepDirCard
from fraese.motor.phases import (
    FULL_STEPS_A_TURN,
    FULL_STEPS_PER_REV,
    LEVEL_MAPS,
    PHASE_TABLES,
    describe_table,
    fault_of_table,
)
from fraese.motor.seams import Card
from fraese.phrases import phrase


def phase_table(name: str) -> bytes:
    """A drive table by name, or from its bytes in hex.

    Raises:
        ConfigError: if it is neither.
    """
    if name in PHASE_TABLES:
        return PHASE_TABLES[name]
    try:
        table = bytes.fromhex(name)
    except ValueError:
        table = b""
    if not 2 <= len(table) <= 32 or any(byte > 0x3F for byte in table):
        raise ConfigError(
            phrase(
                "card.table: {name} is neither one of {phase_tables} nor 2 to 32 bytes in"
                " hex, each 00 to 3F.",
                name=repr(name),
                phase_tables=", ".join(PHASE_TABLES),
            )
        )
    return table


def checked_table(card: CardConfig) -> bytes:
    """The drive table as configured.

    Raises:
        ConfigError: if there is no such table, or a motor cannot turn by it.
    """
    table = phase_table(card.table)
    fault = fault_of_table(table, LEVEL_MAPS[card.levels])
    if fault:
        raise ConfigError(
            phrase(
                "card.table ({describe_table}): {fault}, with card.levels {levels}; every"
                " entry must turn the field the same way, once round.",
                describe_table=describe_table(table),
                fault=fault,
                levels=card.levels,
            )
        )
    return table


def _pins(config: Config) -> list[OutputPin]:
    """Configured outputs in the order of their bits."""
    return [
        OutputPin(output.pin, output.active_high, _pulses_hz(output))
        for _, output in config.outputs.configured()
    ]


def _pulses_hz(output: OutputConfig) -> float:
    return output.pwm_hz if isinstance(output, LaserConfig) and output.pwm else 0.0


def _smc_card(config: Config) -> Card:
    return SmcCard(
        table=checked_table(config.card),
        holding_percent=config.card.holding_percent,
        levels=LEVEL_MAPS[config.card.levels],
        outputs=_pins(config),
        sockets=config.axes.sockets,
    )


def _stepdir_card(config: Config) -> Card:
    profile = STEPDIR_PROFILES[config.card.profile]
    for name, axis in config.axes.table.items():
        rate_hz = axis.max_rate_hz
        if rate_hz > profile.max_rate_hz:
            raise ConfigError(
                phrase(
                    "axes.{name}.max_rate_hz: {rate_hz:g} is above the {max_rate_hz} steps/s"
                    " of card.profile {profile}.",
                    name=name,
                    rate_hz=rate_hz,
                    max_rate_hz=profile.max_rate_hz,
                    profile=config.card.profile,
                )
            )
    return StepDirCard(
        profile=profile,
        clock_idles_high=config.card.clock_idles_high,
        forward_high=config.card.forward_high,
        outputs=_pins(config),
        enable=config.outputs.bit("enable"),
        sockets=config.axes.sockets,
    )


def _by_table(config: Config) -> tuple[int, ...]:
    return (len(checked_table(config.card)),) * len(config.axes.table)


def _by_drive(config: Config) -> tuple[int, ...]:
    """A drive that was switched off too may begin anew anywhere in its electrical turn.

    What motor it turns is not known: taken is the one with the shorter turns.
    """
    a_rev = max(FULL_STEPS_PER_REV) // FULL_STEPS_A_TURN
    return tuple(axis.steps_per_rev // a_rev for axis in config.axes.table.values())


def turn_steps(config: Config) -> tuple[int, ...]:
    """Per axis, steps of the card in one electrical turn of its motor, or fewer."""
    return _TURNS[config.card.kind](config)


_TURNS: Final[Mapping[str, Callable[[Config], tuple[int, ...]]]] = {
    "smc1500": _by_table,
    "stepdir": _by_drive,
}
CARDS: Final[Mapping[str, Callable[[Config], Card]]] = {
    "smc1500": _smc_card,
    "stepdir": _stepdir_card,
}
