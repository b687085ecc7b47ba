"""The record of the phase-current cards SMC800 and SMC1500; their tables as configured."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from fraese.config import Config
from fraese.config.wiring import CardConfig
from fraese.errors import ConfigError
from fraese.kinds.card import CardKind, Stepping
from fraese.kinds.lines import axis_names, output_pins, wired
from fraese.motor.bridge.fromcard import smc_facts
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.electronics import SmcElectronics
from fraese.motor.meaning import CoilCurrents
from fraese.motor.mill import Mill
from fraese.motor.phases import (
    FULL_STEPS_PER_REV,
    LEVEL_MAPS,
    PHASE_TABLES,
    describe_table,
    fault_of_table,
    sense_of_table,
    steps_per_rev,
)
from fraese.motor.seams import Clock
from fraese.phrases import phrase

#: A phase card follows no faster; the field's programs reach 5 kHz.
_LIMIT_HZ: Final = 20_000.0
#: Bits of the data byte, from pin 2 on.
_PHASE_BITS: Final = ("a_code0", "a_code1", "a_negative", "b_code0", "b_code1", "b_negative")
_SOCKET_BITS: Final = ("socket0", "socket1")


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


def _make(config: Config) -> SmcCard:
    return SmcCard(
        table=checked_table(config.card),
        holding_percent=config.card.holding_percent,
        levels=LEVEL_MAPS[config.card.levels],
        outputs=output_pins(config),
        sockets=config.axes.sockets,
    )


def _electronics(
    mill: Mill, clock: Clock, config: Config, sockets: Sequence[int]
) -> SmcElectronics:
    rest = phase_table(config.card.table)[0]
    return SmcElectronics(mill, clock, LEVEL_MAPS[config.card.levels], rest, sockets)


def _stepping(config: Config, _name: str) -> Stepping:
    table = phase_table(config.card.table)
    return Stepping(len(table), sense_of_table(table, LEVEL_MAPS[config.card.levels]))


def _turn_steps(config: Config) -> tuple[int, ...]:
    return (len(checked_table(config.card)),) * len(config.axes.table)


def _limit_hz(_config: Config) -> float:
    return _LIMIT_HZ


def _pins(config: Config) -> Mapping[int, str]:
    data = {2 + bit: word for bit, word in enumerate((*_PHASE_BITS, *_SOCKET_BITS))}
    return data | {1: "nstrobe"} | wired(config)


def _decoder(config: Config) -> CoilCurrents:
    return CoilCurrents(axis_names(config), LEVEL_MAPS[config.card.levels])


def _word(config: Config) -> str:
    return config.card.table


def _misfits(config: Config) -> Iterator[tuple[str, str]]:
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


def _described(config: Config) -> str:
    return phrase(
        "card.table: {describe_table}.", describe_table=describe_table(checked_table(config.card))
    )


CARD: Final = CardKind(
    about=phrase("phase-current card (SMC800, SMC1500), one to three motors"),
    sockets=3,
    make=_make,
    electronics=_electronics,
    stepping=_stepping,
    limit_hz=_limit_hz,
    pins=_pins,
    bridge=smc_facts,
    taken_pins=frozenset({1}),
    turn_steps=_turn_steps,
    decoder=_decoder,
    word=_word,
    misfits=_misfits,
    described=_described,
)
