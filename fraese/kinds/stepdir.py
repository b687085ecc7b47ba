"""The record of step/direction drives."""

from collections.abc import Mapping, Sequence
from typing import Final

from fraese.config import Config
from fraese.errors import ConfigError
from fraese.kinds.card import CardKind, Stepping
from fraese.kinds.lines import axis_names, output_pins, step_direction_pins, wired
from fraese.motor.bridge.fromcard import stepdir_facts
from fraese.motor.cards.stepdir import ACTIVE_PIN, BOOST_PIN, STEPDIR_PROFILES, StepDirCard
from fraese.motor.electronics import StepDirElectronics
from fraese.motor.mill import Mill
from fraese.motor.phases import FULL_STEPS_A_TURN
from fraese.motor.seams import Clock
from fraese.phrases import phrase

#: What the switches of drives can be set to.
MICROSTEPS: Final = (1, 2, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 64, 100, 125, 128, 200, 250, 256)


def _make(config: Config) -> StepDirCard:
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
        outputs=output_pins(config),
        enable=config.outputs.bit("enable"),
        sockets=config.axes.sockets,
    )


def _electronics(
    mill: Mill, clock: Clock, config: Config, sockets: Sequence[int]
) -> StepDirElectronics:
    card = config.card
    return StepDirElectronics(mill, clock, card.clock_idles_high, card.forward_high, sockets)


def _stepping(config: Config, name: str) -> Stepping:
    motor = config.simulation.motor_of(name)
    wanted = config.axes.table[name].steps_per_rev / motor.full_steps_per_rev
    nearest = min(MICROSTEPS, key=lambda known: abs(known - wanted))
    return Stepping(FULL_STEPS_A_TURN * (config.simulation.own(name).microsteps or nearest))


def _limit_hz(config: Config) -> float:
    return float(STEPDIR_PROFILES[config.card.profile].max_rate_hz)


def _pins(config: Config) -> Mapping[int, str]:
    return step_direction_pins(axis_names(config)) | wired(config)


CARD: Final = CardKind(
    about=phrase("step and direction drives, one to four motors"),
    sockets=4,
    make=_make,
    electronics=_electronics,
    stepping=_stepping,
    limit_hz=_limit_hz,
    pins=_pins,
    bridge=stepdir_facts,
    taken_pins=frozenset({BOOST_PIN, ACTIVE_PIN}),
    divides=True,
)
