"""Outputs and lines as configured, for the records of cards."""

from collections.abc import Mapping

from fraese.config import Config
from fraese.config.outputs import LaserConfig, OutputConfig
from fraese.motor.cards.control import OutputPin
from fraese.motor.cards.stepdir import ACTIVE_PIN, BOOST_PIN
from fraese.motor.pins import STATUS_PINS


def output_pins(config: Config) -> list[OutputPin]:
    """Configured outputs in the order of their bits."""
    return [
        OutputPin(output.pin, output.active_high, _pulses_hz(output))
        for _, output in config.outputs.configured()
    ]


def _pulses_hz(output: OutputConfig) -> float:
    return output.pwm_hz if isinstance(output, LaserConfig) and output.pwm else 0.0


def axis_names(config: Config) -> dict[int, str]:
    """Name of the axis in each socket."""
    return dict(zip(config.axes.sockets, config.axes.names, strict=True))


def wired(config: Config) -> dict[int, str]:
    """What the configuration says of the pins of outputs and inputs."""
    pins = dict.fromkeys(STATUS_PINS, "input")
    pins |= {output.pin: name for name, output in config.outputs.configured()}
    if config.probe.pin is not None:
        pins[config.probe.pin] = "probe"
    return pins | {
        line.pin: f"switch_{line.name}" if line.name else "switches" for line in config.switch_lines
    }


def step_direction_pins(names: Mapping[int, str]) -> dict[int, str]:
    """What hangs on the pins of step/direction drives.

    Args:
        names: of the axis in each socket; empty: none.
    """
    pins = {BOOST_PIN: "boost", ACTIVE_PIN: "active"}
    for socket, name in names.items():
        pins |= {2 + 2 * socket: f"{name}_direction", 3 + 2 * socket: f"{name}_clock"}
    return pins
