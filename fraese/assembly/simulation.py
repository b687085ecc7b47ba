"""The simulated mill: rotors, carriages, switches, and electronics for its card.

Other electronics are a class like ``SmcElectronics``, a row in ``ELECTRONICS``, and one in
``trueaxis.py``.
"""

from collections.abc import Callable, Mapping
from typing import Final

from fraese.assembly.cards import phase_table
from fraese.assembly.solids import feeler_of
from fraese.assembly.trueaxis import true_axes
from fraese.config import Config
from fraese.control.endswitches import contact_bits
from fraese.motor.electronics import Electronics, SmcElectronics, StepDirElectronics
from fraese.motor.mill import Mill
from fraese.motor.phases import LEVEL_MAPS
from fraese.motor.ports.sim import SimulatedMill, Wiring
from fraese.motor.seams import Clock


def _smc_electronics(mill: Mill, clock: Clock, config: Config, sockets: list[int]) -> Electronics:
    rest = phase_table(config.card.table)[0]
    return SmcElectronics(mill, clock, LEVEL_MAPS[config.card.levels], rest, sockets)


def _stepdir_electronics(
    mill: Mill, clock: Clock, config: Config, sockets: list[int]
) -> Electronics:
    card = config.card
    return StepDirElectronics(mill, clock, card.clock_idles_high, card.forward_high, sockets)


ELECTRONICS: Final[Mapping[str, Callable[[Mill, Clock, Config, list[int]], Electronics]]] = {
    "smc1500": _smc_electronics,
    "stepdir": _stepdir_electronics,
}


def simulated_mill(config: Config, clock: Clock) -> SimulatedMill:
    """The mill that a configuration describes, with its electronics and its switches."""
    simulation, axes = config.simulation, true_axes(config)
    mill = Mill(
        [axis.slide(simulation.snaps_to_pole) for axis in axes],
        lag_s=simulation.lag_ms / 1000,
        bounce_readings=simulation.bounce_readings,
    )
    sockets = [axis.socket for axis in axes]
    electronics = ELECTRONICS[config.card.kind](mill, clock, config, sockets)
    wiring = Wiring(*contact_bits(config.switches))
    return SimulatedMill(mill, electronics, clock, wiring, feeler_of(config))
