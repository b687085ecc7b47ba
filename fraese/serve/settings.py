"""``$$``: grbl's settings, as far as this machine has them.

    mapped     a key of the configuration: shown as it is in force; written into the file
    fixed      what this machine always does: shown, any other value is refused
    stored     what a sender wants for itself: kept, and what is asked of it is done

Rule 1: a value that is in force already changes nothing: who "restores" settings writes no file.
Rule 2: a key that counts at once does; any other counts from the next start, which is told.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Final

from fraese.config import Config
from fraese.config.axis import AxisConfig
from fraese.config.edit import Change
from fraese.machine import Axis, Machine

#: Of the axes that a sender knows, in its order; others follow.
_FIRST: Final = "xyz"
#: ``$1``: motors always on.
_ALWAYS_ON: Final = 255
_MS_PER_S: Final = 1000
_S_PER_MIN: Final = 60

Changes = Mapping[str, Change]


@dataclass(frozen=True, slots=True)
class _Row:
    """A setting of the machine.

    Attributes:
        read: its value.
        change: keys of the configuration that make it so; None: it is fixed.
    """

    read: Callable[[Config, Machine], float]
    change: Callable[[Config, float], Changes] | None = None


@dataclass(frozen=True, slots=True)
class _AxisRow:
    """A setting of each axis."""

    read: Callable[[Axis], float]
    change: Callable[[Config, str, float], Changes]


#: What is kept for a sender, with what it is before anybody has said.
STORED: Final[Mapping[int, float]] = {
    0: 10, 2: 0, 4: 0, 6: 0, 10: 1, 11: 0.01, 13: 0, 26: 25, 31: 0,
}  # fmt: skip
REPORT_MASK: Final = 10
INCHES: Final = 13


def by_letter(names: tuple[str, ...]) -> list[str]:
    """Axes in the order of a sender's numbers."""
    return [*(n for n in _FIRST if n in names), *(n for n in names if n not in _FIRST)]


def _mask(config: Config, said: Callable[[AxisConfig], bool]) -> float:
    table = config.axes.table
    bits = enumerate(by_letter(config.axes.names))
    return sum(1 << bit for bit, name in bits if said(table[name]))


def _by_bit(config: Config, mask: float, key: str, values: tuple[Change, Change]) -> Changes:
    bits = enumerate(by_letter(config.axes.names))
    return {f"axes.{name}.{key}": values[int(mask) >> bit & 1] for bit, name in bits}


def _idle_ms(config: Config, _machine: Machine) -> float:
    ms = config.standstill.delay_s * _MS_PER_S
    return _ALWAYS_ON if config.standstill.current == "hold" else min(ms, _ALWAYS_ON - 1)


def _set_idle(_config: Config, ms: float) -> Changes:
    if ms >= _ALWAYS_ON:
        return {"standstill.current": "hold"}
    return {"standstill.current": "off", "standstill.delay_s": ms / _MS_PER_S}


_ROWS: Final[Mapping[int, _Row]] = {
    1: _Row(_idle_ms, _set_idle),
    3: _Row(
        lambda config, _: _mask(config, lambda axis: axis.inverted),
        lambda config, mask: _by_bit(config, mask, "inverted", (False, True)),
    ),
    5: _Row(
        lambda config, _: config.switches.closed_reads,
        lambda _, value: {"switches.closed_reads": int(value)},
    ),
    12: _Row(
        lambda config, _: config.planner.chord_tolerance_mm,
        lambda _, value: {"planner.chord_tolerance_mm": value},
    ),
    20: _Row(lambda _, __: 1),
    21: _Row(lambda config, _: config.switches.mode == "stop"),
    22: _Row(lambda _, machine: any(axis.has_switches for axis in machine.axes)),
    23: _Row(
        lambda config, _: _mask(config, lambda axis: axis.home_end == "min"),
        lambda config, mask: _by_bit(config, mask, "home_end", ("max", "min")),
    ),
    24: _Row(
        lambda config, _: config.homing.slow_mm_min,
        lambda _, value: {"homing.slow_mm_min": value},
    ),
    25: _Row(
        lambda config, _: config.homing.approach_mm_min,
        lambda _, value: {"homing.approach_mm_min": value},
    ),
    27: _Row(
        lambda config, _: config.homing.pull_off_mm,
        lambda _, value: {"homing.pull_off_mm": value},
    ),
    30: _Row(
        lambda config, _: config.outputs.laser.power_max_s if config.outputs.laser else 1000,
        lambda config, value: {"outputs.laser.power_max_s": value} if config.outputs.laser else {},
    ),
    32: _Row(lambda config, _: config.outputs.laser is not None),
}


def _pitch(config: Config, name: str, steps_per_mm: float) -> Changes:
    axis = config.axes.table[name]
    exact = Fraction(axis.steps_per_rev) * Fraction(axis.gear) / Fraction(steps_per_mm)
    pitch = round(Decimal(exact.numerator) / Decimal(exact.denominator), 9).normalize()
    return {f"axes.{name}.pitch_{axis.key_unit}": pitch}


def _rate(key: str, per: float) -> Callable[[Config, str, float], Changes]:
    def change(config: Config, name: str, value: float) -> Changes:
        steps = float(config.axes.table[name].steps_per_unit())
        return {f"axes.{name}.{key}": round(value / per * steps, 3)}

    return change


def _travel(config: Config, name: str, usable: float) -> Changes:
    axis = config.axes.table[name]
    whole = round(Decimal(usable + 2 * config.pull_off(axis)), 6).normalize()
    return {f"axes.{name}.travel_{axis.key_unit}": whole}


#: By the hundred and ten: 100 is X, 101 Y ...
_AXIS_ROWS: Final[Mapping[int, _AxisRow]] = {
    100: _AxisRow(lambda axis: float(axis.steps_per_mm), _pitch),
    110: _AxisRow(
        lambda axis: axis.max_rate_hz * axis.step_mm * _S_PER_MIN,
        _rate("max_rate_hz", _S_PER_MIN),
    ),
    120: _AxisRow(
        lambda axis: axis.acceleration_hz_s * axis.step_mm, _rate("acceleration_hz_s", 1.0)
    ),
    130: _AxisRow(lambda axis: 0.0 if axis.is_endless else axis.high_mm - axis.low_mm, _travel),
}


def shown(config: Config, machine: Machine, stored: Mapping[int, float]) -> dict[int, float]:
    """Every setting with its value, in the order of their numbers."""
    values = {number: float(row.read(config, machine)) for number, row in _ROWS.items()}
    for first, row in _AXIS_ROWS.items():
        for place, name in enumerate(by_letter(machine.names)):
            values[first + place] = float(row.read(machine.axes[machine.index(name)]))
    return dict(sorted({**STORED, **stored, **values}.items()))


def changes(config: Config, machine: Machine, number: int, value: float) -> Changes | None:
    """Keys of the configuration that make a setting so; None: it is fixed, or there is none.

    Args:
        config: as the file says.
        machine: its axes.
        number: behind the ``$``; none of ``STORED``.
        value: wanted.
    """
    row = _ROWS.get(number)
    if row is not None:
        return None if row.change is None else row.change(config, value)
    first, place = number // 10 * 10, number % 10
    names = by_letter(machine.names)
    axis_row = _AXIS_ROWS.get(first)
    if axis_row is None or place >= len(names) or value <= 0:
        return None
    return axis_row.change(config, names[place], value)


def written(value: float) -> str:
    """As grbl prints it: whole numbers whole, others with three digits."""
    return f"{value:.0f}" if value == int(value) and abs(value) < 1e9 else f"{value:.3f}"
