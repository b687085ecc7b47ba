"""The simulated mill as configured: rotors, carriages, switches, and electronics for its card.

Other electronics are a class like ``SmcElectronics``, and a row in ``ELECTRONICS`` and
``HALF_STEPS``.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Final

from fraese.assembly.cards import phase_table
from fraese.config import Config
from fraese.control.endswitches import contact_bits
from fraese.machine import Machine
from fraese.motor.electronics import Electronics, SmcElectronics, StepDirElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.phases import LEVEL_MAPS, TURN_STEPS
from fraese.motor.ports.sim import SimulatedMill, Wiring
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import Clock


def _smc_electronics(mill: Mill, clock: Clock, config: Config) -> Electronics:
    rest = phase_table(config.card.table)[0]
    return SmcElectronics(mill, clock, LEVEL_MAPS[config.card.levels], rest, config.axes.sockets)


def _stepdir_electronics(mill: Mill, clock: Clock, config: Config) -> Electronics:
    card = config.card
    return StepDirElectronics(
        mill, clock, card.clock_idles_high, card.forward_high, config.axes.sockets
    )


ELECTRONICS: Final[Mapping[str, Callable[[Mill, Clock, Config], Electronics]]] = {
    "smc1500": _smc_electronics,
    "stepdir": _stepdir_electronics,
}


#: What the simulated mill counts in one step of the card: half-steps, pulses.
HALF_STEPS: Final[Mapping[str, Callable[[Config], Fraction]]] = {
    "smc1500": lambda config: Fraction(TURN_STEPS, len(phase_table(config.card.table))),
    "stepdir": lambda config: Fraction(1),
}


def simulated_mill(config: Config, machine: Machine, clock: Clock) -> SimulatedMill:
    """The mill that a configuration describes, with its electronics and its switches."""
    simulation = config.simulation
    limits = RotorLimits(
        max_rate_hz=simulation.max_rate_hz,
        jump_hz=simulation.jump_hz,
        acceleration_hz_s=simulation.acceleration_hz_s,
        snaps_to_pole=simulation.snaps_to_pole,
    )
    scale = HALF_STEPS[config.card.kind](config)
    mill = Mill(
        [
            Slide(
                axis.travel_steps * float(scale),
                limits,
                round(axis.to_steps(simulation.overrun_mm) * scale),
                round(axis.to_steps(simulation.backlash_mm) * scale),
                has_switches=axis.has_switches,
            )
            for axis in machine.axes
        ],
        lag_s=simulation.lag_ms / 1000,
        bounce_readings=simulation.bounce_readings,
    )
    wiring = Wiring(*contact_bits(config.switches))
    return SimulatedMill(mill, ELECTRONICS[config.card.kind](mill, clock, config), clock, wiring)
