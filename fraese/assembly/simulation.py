"""The simulated mill: rotors, carriages, switches, and electronics for its card.

Other electronics are a class like ``SmcElectronics``, in the record of their card.
"""

from fraese.assembly.solids import feeler_of
from fraese.assembly.switchboard import own_lines, wiring
from fraese.assembly.trueaxis import true_axes
from fraese.config import Config
from fraese.kinds.card import card_kind
from fraese.motor.mill import Mill
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import Clock


def simulated_mill(config: Config, clock: Clock) -> SimulatedMill:
    """The mill that a configuration describes, with its electronics and its switches."""
    simulation, axes = config.simulation, true_axes(config)
    mill = Mill(
        [axis.slide(simulation.snaps_to_pole) for axis in axes],
        lag_s=simulation.lag_ms / 1000,
        bounce_readings=simulation.bounce_readings,
        own_lines=own_lines(config, axes),
    )
    sockets = [axis.socket for axis in axes]
    electronics = card_kind(config).electronics(mill, clock, config, sockets)
    return SimulatedMill(mill, electronics, clock, wiring(config, axes), feeler_of(config))
