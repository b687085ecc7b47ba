"""What a program meets when it opens a port: configuration, clock, keyboard.

    environment              says
    FRAESE_CONFIG            configuration file; else as for every other command
    FRAESE_X4STEP_CLOCK      paced (default) or virtual: how time passes on a simulated port
    FRAESE_X4STEP_PINS       inputs of simulated ports, as in 15=low,10=high
    FRAESE_X4STEP_KEYS       where keys come from: auto, kitty, plain, evdev, evdev:DEVICE,DEVICE
    FRAESE_TRACE             waveform file; that of the next port gets -2, and so on

A test puts its own surroundings in their place: see ``fraese.x4step.testing``.
"""

import importlib.util
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final, Literal, NamedTuple, get_args

from fraese.assembly import state_folder
from fraese.assembly.drivers import CLOCKS, ClockName
from fraese.config import Config
from fraese.config.file import load
from fraese.config.x4step import KeysName, X4StepConfig
from fraese.errors import ConfigError
from fraese.log import LogFile
from fraese.motor.pins import STATUS_PINS
from fraese.motor.seams import Clock
from fraese.phrases import phrase
from fraese.x4step.complaints import complain
from fraese.x4step.keys import Keyboard, NoKeys, ToldKeys
from fraese.x4step.lpt import Opened, Wanted, open_lpt, port_config

CONFIG_VARIABLE: Final = "FRAESE_CONFIG"
CLOCK_VARIABLE: Final = "FRAESE_X4STEP_CLOCK"
PINS_VARIABLE: Final = "FRAESE_X4STEP_PINS"
KEYS_VARIABLE: Final = "FRAESE_X4STEP_KEYS"
TRACE_VARIABLE: Final = "FRAESE_TRACE"

_LEVELS: Final = {"low": False, "high": True, "0": False, "1": True}


@dataclass(frozen=True)
class Surroundings:
    """What a program meets.

    Attributes:
        open: opens a port, by its number.
        keyboard: what is typed.
        is_lockstep: time is virtual: it passes when the caller asks.
    """

    open: Callable[[int], Opened]
    keyboard: Keyboard
    is_lockstep: bool


class WantedKeys(NamedTuple):
    """Where keys are to come from.

    Attributes:
        layout: where characters lie.
        source: auto, kitty, plain or evdev.
        devices: keyboards, for evdev; none: all that may be read.
    """

    layout: str
    source: KeysName = "auto"
    devices: tuple[str, ...] = ()


def wanted_keys(
    config: X4StepConfig, named: str | None = None, environment: Mapping[str, str] = os.environ
) -> WantedKeys:
    """Where keys are to come from: as a flag says, else the environment, else the configuration.

    Args:
        config: what stands there.
        named: the flag; "evdev:" and paths, with commas, names the keyboards too.
        environment: as for a flag; a terminal that is "dumb" is not asked.

    Raises:
        ConfigError: if there is no such source.
    """
    said, where = (named, "--keys") if named else (environment.get(KEYS_VARIABLE), KEYS_VARIABLE)
    source, _, paths = (said or config.keys).partition(":")
    names: tuple[KeysName, ...] = get_args(KeysName)
    known = next((name for name in names if name == source), None)
    if known is None or (paths and known != "evdev"):
        raise ConfigError(
            phrase(
                '{where}: "{said}" is no source of keys; say auto, kitty, plain, evdev, or'
                " evdev:/dev/input/event3.",
                where=where,
                said=said,
            )
        )
    if known == "auto" and environment.get("TERM") == "dumb":
        known = "plain"
    devices = tuple(paths.split(",")) if paths else config.event_devices
    return WantedKeys(config.keyboard, known, devices)


@cache
def terminal_keyboard(wanted: WantedKeys) -> Keyboard:
    """The keyboard of a program that was started in a terminal; one for the whole program."""
    if not can_read_keys():
        complain(
            phrase(
                "Keys cannot be read on this system, so neither ESC nor any other key"
                " brakes; Ctrl-C ends the program."
            )
        )
    return Keyboard(program_keys(wanted))


def can_read_keys() -> bool:
    """Terminals here are those of Unix."""
    return importlib.util.find_spec("termios") is not None


def program_keys(wanted: WantedKeys) -> ToldKeys | NoKeys:
    """Where the keys of a program come from that was started in a terminal."""
    if not can_read_keys():
        return NoKeys(sys.stdin)
    # Only where there are such terminals.
    from fraese.x4step.evdev import EvdevKeys, keyboards
    from fraese.x4step.terminal import keys_beside, keys_of

    terminal: Literal["auto", "kitty", "plain"] = (
        "plain" if wanted.source == "evdev" else wanted.source
    )
    program = keys_of(sys.stdin, wanted.layout, terminal) or keys_beside(
        sys.stdin, wanted.layout, terminal
    )
    if wanted.source != "evdev":
        return program
    found = keyboards(wanted.devices)
    if not found:
        complain(
            phrase(
                "No keyboard of {devices} can be read, so keys come from the terminal alone;"
                " members of the group input may read them.",
                devices=" or ".join(wanted.devices) or phrase("/dev/input"),
            )
        )
        return program
    said = ", ".join(str(path) for path, _ in found)
    return EvdevKeys(
        [device for _, device in found],
        program,
        phrase("{said}, heard in every window (evdev)", said=said),
    )


@cache
def log_of(file: str) -> LogFile:
    """The log, as configured; one for the whole program."""
    return LogFile(Path(file) if file else state_folder() / "fraese.log")


def from_environment(environment: Mapping[str, str] = os.environ) -> Surroundings:
    """The surroundings of a program that was just started.

    Raises:
        ConfigError: if a file or variable is wrong.
    """
    named = environment.get(CONFIG_VARIABLE)
    config = load(Path(named) if named else None)
    keyboard = terminal_keyboard(wanted_keys(config.x4step, environment=environment))
    return around(config, keyboard, "paced", environment)


def around(
    config: Config,
    keyboard: Keyboard,
    clock: ClockName,
    environment: Mapping[str, str] = os.environ,
    trace: Path | None = None,
) -> Surroundings:
    """Surroundings of a program that brings its own configuration and keyboard.

    Args:
        config: all of it.
        keyboard: what is typed.
        clock: of simulated ports, if the environment does not say.
        environment: says the clock, the levels of inputs, and a waveform file.
        trace: waveform file; None: as the environment says.

    Raises:
        ConfigError: if a variable is wrong.
    """
    if config.log.enabled:
        log_of(config.log.file).switch(True)
    name = clock_named(environment.get(CLOCK_VARIABLE) or clock)
    levels = pin_levels(environment.get(PINS_VARIABLE) or "")
    named = environment.get(TRACE_VARIABLE)
    return made(
        config,
        CLOCKS[name],
        levels,
        keyboard,
        is_lockstep=name == "virtual",
        trace=trace or (Path(named) if named else None),
    )


def made(
    config: Config,
    make_clock: Callable[[], Clock],
    levels: Mapping[int, bool],
    keyboard: Keyboard,
    *,
    is_lockstep: bool,
    record: bool = False,
    trace: Path | None = None,
) -> Surroundings:
    """Surroundings of these things."""

    def opened(lpt: int) -> Opened:
        port = port_config(config, lpt)
        low = {pin for pin in STATUS_PINS if not levels.get(pin, pin not in port.low_pins)}
        port = port.model_copy(update={"low_pins": tuple(sorted(low))})
        return open_lpt(Wanted(lpt, config, port, make_clock, record, trace and _next_file(trace)))

    return Surroundings(opened, keyboard, is_lockstep)


_traced: Counter[Path] = Counter()


def _next_file(path: Path) -> Path:
    """The file for the next port of this program."""
    _traced[path] += 1
    number = _traced[path]
    return path if number == 1 else path.with_stem(f"{path.stem}-{number}")


def clock_named(name: str) -> ClockName:
    """A clock, by its name.

    Raises:
        ConfigError: if there is none of that name.
    """
    names: tuple[ClockName, ...] = get_args(ClockName)
    found = next((clock for clock in names if clock == name), None)
    if found is None:
        raise ConfigError(
            phrase(
                '{clock_variable}: "{name}" is no clock; say paced or virtual.',
                clock_variable=CLOCK_VARIABLE,
                name=name,
            )
        )
    return found


def pin_levels(text: str) -> dict[int, bool]:
    """Levels of input pins, from ``15=low,10=high``.

    Raises:
        ConfigError: if a word is no pin with its level.
    """
    levels = {}
    for word in text.replace(",", " ").split():
        pin, _, level = word.partition("=")
        if pin not in map(str, STATUS_PINS) or level.lower() not in _LEVELS:
            raise ConfigError(
                phrase(
                    '{pins_variable}: "{word}" is no input with its level, as in 15=low,10=high.',
                    pins_variable=PINS_VARIABLE,
                    word=word,
                )
            )
        levels[int(pin)] = _LEVELS[level.lower()]
    return levels


_in_place: list[Surroundings] = []


def present() -> Surroundings:
    """The surroundings that hold now.

    Raises:
        ConfigError: if a file or variable is wrong.
    """
    return _in_place[-1] if _in_place else from_environment()


@contextmanager
def in_place(surroundings: Surroundings) -> Iterator[None]:
    """Have others hold for a while."""
    _in_place.append(surroundings)
    try:
        yield
    finally:
        _in_place.remove(surroundings)
