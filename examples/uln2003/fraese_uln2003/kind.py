"""The record: all that fraese asks of the card. The entry point in pyproject.toml names it."""

from collections.abc import Mapping, Sequence

from fraese.config import Config
from fraese.kinds.card import CardKind, Stepping
from fraese.kinds.lines import axis_names, output_pins, wired
from fraese.motor.mill import Mill
from fraese.motor.seams import Clock
from fraese_uln2003.card import TABLE, UlnCard
from fraese_uln2003.electronics import UlnElectronics


def _make(config: Config) -> UlnCard:
    return UlnCard(output_pins(config), config.axes.sockets)


def _electronics(
    mill: Mill, clock: Clock, _config: Config, sockets: Sequence[int]
) -> UlnElectronics:
    return UlnElectronics(mill, clock, sockets)


def _stepping(_config: Config, _axis: str) -> Stepping:
    return Stepping(len(TABLE))


def _turn_steps(config: Config) -> tuple[int, ...]:
    return (len(TABLE),) * len(config.axes.names)


def _limit_hz(_config: Config) -> float:
    # A 28BYJ-48 follows 1000 half-steps a second; its board more than any motor.
    return 5_000.0


def _pins(config: Config) -> Mapping[int, str]:
    coils = {
        2 + 4 * socket + bit: f"{name}_coil_{coil}"
        for socket, name in axis_names(config).items()
        for bit, coil in enumerate("abcd")
    }
    return coils | wired(config)


CARD = CardKind(
    about="two ULN2003 boards with unipolar motors, on eight data bits",
    sockets=2,
    make=_make,
    electronics=_electronics,
    stepping=_stepping,
    limit_hz=_limit_hz,
    pins=_pins,
    bridge=None,
    turn_steps=_turn_steps,
)
