"""Half-steps of a simulated motor and places of the machine, as the true switches make them."""

from fractions import Fraction

from fraese.assembly.trueaxis import TrueAxis
from fraese.config import Config
from fraese.config.axis import AxisConfig


def true_way(axis: TrueAxis, half_steps: float) -> Fraction:
    """From the lower end of the travel, or from where an endless axis began, mm or degrees."""
    way = Fraction(half_steps) / axis.half_steps_per_unit
    return way if axis.sign > 0 else (axis.travel or 0) - way


def reference_mm(config: Config) -> Fraction:
    """How far before the end of the travel a switch for referencing closes."""
    return Fraction(str(config.simulation.reference_mm))


def true_zero(axis: TrueAxis, config: Config, configured: AxisConfig) -> Fraction:
    """Where machine zero lies, seen likewise."""
    if not axis.has_switches or axis.travel is None:
        return true_way(axis, axis.slide(snaps_to_pole=False).middle_steps)
    pull_off = Fraction(str(config.pull_off(configured)))
    home = axis.name + configured.home_end
    if any(home in line.ends for line in config.switch_lines if not line.stops):
        pull_off += reference_mm(config)
    return pull_off if configured.home_end == "min" else axis.travel - pull_off
