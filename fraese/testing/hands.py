"""What a person at the simulated machine sees and does, past everything that drives it.

Rule 1: ways are millimetres (degrees on a rotary axis), in the coordinates of the machine, by the
        names of its axes. What a program believes is in ``state``; where things are is here.
Rule 2: what is done here is done at once, also while the machine runs.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from decimal import Decimal
from pathlib import Path
from typing import Any, Final, TypeVar

import tomlkit

from fraese.assembly import Plant
from fraese.assembly.onlooker import MillOnlooker
from fraese.assembly.solids import feeler_of
from fraese.config import Config
from fraese.config.file import from_table, load
from fraese.config.solid import SimulatedSolid
from fraese.control.onlooker import Seen
from fraese.control.state import MachineState, Status
from fraese.motor.phases import Currents
from fraese.motor.ports.sim import SimulatedMill
from fraese.testing.failures import NoSuchName
from fraese.testing.lines import Lines

#: A configuration: built in, a file, its tables, or what was made of them.
Configuration = Config | Mapping[str, Any] | Path | str | None

_NS_PER_S: Final = 1_000_000_000
_SIDES: Final = ("min", "max")
Span = tuple[float, float]
_T = TypeVar("_T")


def configured(configuration: Configuration) -> Config:
    """The machine to be simulated; of one of metal the port is exchanged.

    Args:
        configuration: None: as built in; a path of a ``fraese.toml``; or its tables.

    Raises:
        ConfigError: one sentence with the key and what would be right.
    """
    if isinstance(configuration, str | Path):
        config = load(Path(configuration))
    elif isinstance(configuration, Config):
        config = configuration
    else:
        config = from_table(dict(configuration or {}), "configuration of the test")
    port = config.port.model_copy(update={"kind": "simulation"})
    return config.model_copy(update={"port": port})


def written(configuration: Configuration) -> str:
    """The same as text of a ``fraese.toml``, for what reads one."""
    if isinstance(configuration, str | Path):
        table = tomlkit.parse(Path(configuration).read_text("utf-8")).unwrap()
    elif isinstance(configuration, Config):
        table = configuration.model_dump(exclude_defaults=True)
    else:
        table = dict(configuration or {})
    table["port"] = {**table.get("port", {}), "kind": "simulation"}
    return tomlkit.dumps(_plain(table))


def _plain(value: Any) -> Any:
    """What TOML has a word for."""
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items() if each is not None}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return float(value) if isinstance(value, Decimal) else value


class Hands:
    """Sees and touches a simulated machine.

    Args:
        plant: the machine.

    Attributes:
        config: what it was made from.
    """

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self.config = plant.config
        self._solids = dict(plant.config.simulation.solids)

    # --- what is seen --------------------------------------------------------------------------

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes, in the order of the machine."""
        return tuple(self._plant.controller.machine.names)

    @property
    def now_s(self) -> float:
        """Machine time since the start."""
        return self._plant.clock.now_ns() / _NS_PER_S

    @property
    def state(self) -> MachineState:
        """What the controller believes and shows; everything in it is in the order of ``axes``."""
        return self._plant.controller.state()

    @property
    def carriages_mm(self) -> dict[str, float]:
        """Where the carriages really are."""
        return self._by_axis(self._seen().carriages_mm)

    @property
    def position_mm(self) -> dict[str, float]:
        """Where the controller believes that they are."""
        return self._by_axis(self.state.position_mm)

    @property
    def work_mm(self) -> dict[str, float]:
        """The same in work coordinates."""
        return self._by_axis(self.state.work_mm)

    @property
    def lost_steps(self) -> dict[str, float]:
        """Steps of this run, or of the last one, that were asked for and not made; signed."""
        return self._by_axis(self._seen().lost_steps)

    @property
    def lost_why(self) -> dict[str, str]:
        """Why, half a sentence; empty where none was lost."""
        return self._by_axis(self._seen().lost_why)

    @property
    def currents(self) -> dict[str, Currents]:
        """Per cent of the maximum in both coils of every motor: ``a_percent``, ``b_percent``."""
        return self._by_axis(self._port.look().currents)

    @property
    def pressed(self) -> frozenset[str]:
        """Names of the end switches that are pressed, by a carriage or by hand."""
        held = self._port.look().pressed
        return frozenset(name for name in self._ends() if self._onlooker.end(name) in held)

    def _seen(self) -> Seen:
        if self._plant.controller.status is not Status.RUN:
            # What a motor had to run on it has done by then.
            self._port.look()
        return self._onlooker.look()

    @property
    def _port(self) -> SimulatedMill:
        assert self._plant.port is not None
        return self._plant.port

    @property
    def _onlooker(self) -> MillOnlooker:
        assert self._plant.onlooker is not None
        return self._plant.onlooker

    def _by_axis(self, values: tuple[_T, ...]) -> dict[str, _T]:
        return dict(zip(self.axes, values, strict=True))

    # --- what is done --------------------------------------------------------------------------

    def press(self, end: str) -> None:
        """Press an end switch by hand and keep it so.

        Args:
            end: its name, such as "xmin".

        Raises:
            NoSuchName: there is none of that name.
        """
        self._plant.press(self._known(end, self._ends()), True)

    def release(self, end: str) -> None:
        """Let go of an end switch. As ``press``."""
        self._plant.press(self._known(end, self._ends()), False)

    def block(self, axis: str, blocked: bool = True) -> None:
        """Hold a carriage, or let it go: its motor loses the steps that it cannot make.

        Raises:
            NoSuchName: there is no such axis.
        """
        motor = self.axes.index(self._known(axis, self.axes))
        self._port.mill.block(motor, blocked)

    def cut_power(self) -> None:
        """Switch off the supply of the motors: coils without current, rotors free."""
        self._port.electronics.cut_power()

    def restore_power(self) -> None:
        """Switch it on again; what was asked for meanwhile is lost."""
        self._port.electronics.restore_power()

    def put_plate(
        self,
        name: str = "plate",
        *,
        x_mm: Span,
        y_mm: Span,
        top_mm: float,
        corners_mm: tuple[float, float, float, float] = (0, 0, 0, 0),
    ) -> None:
        """Put a touch plate, or another block, on the table: the tool that touches it is felt.

        Args:
            name: by which it can be taken away; one of that name is moved.
            x_mm: from where to where, low to high, machine coordinates,
            y_mm: likewise.
            top_mm: height of its top; it is solid below.
            corners_mm: how much higher it is at its corners, as in ``simulation.solids``.

        Raises:
            ConfigError: it is no block.
        """
        table = {"x_mm": x_mm, "y_mm": y_mm, "top_mm": top_mm, "corners_mm": corners_mm}
        made = from_table({"simulation": {"solids": {name: table}}}, "plate of the test")
        self._lay({**self._solids, **made.simulation.solids})

    def take_away(self, name: str = "plate") -> None:
        """Take it off the table.

        Raises:
            NoSuchName: nothing of that name lies there.
        """
        self._known(name, self._solids)
        self._lay({key: solid for key, solid in self._solids.items() if key != name})

    def _lay(self, solids: dict[str, SimulatedSolid]) -> None:
        self._solids = solids
        simulation = self.config.simulation.model_copy(update={"solids": solids})
        self._port.feel(feeler_of(self.config.model_copy(update={"simulation": simulation})))

    @contextmanager
    def record(self) -> Iterator[Lines]:
        """Record all lines between computer and card meanwhile; begun and ended at standstill."""
        lines = Lines(self._plant.clock.now_ns())
        assert self._plant.bench is not None
        with self._plant.bench.recorded(lines.note):
            yield lines

    def _ends(self) -> tuple[str, ...]:
        tables = self.config.axes.table
        return tuple(a + side for a in self.axes if tables[a].has_switches for side in _SIDES)

    @staticmethod
    def _known(name: str, known: Any) -> str:
        if name not in known:
            raise NoSuchName(name, known)
        return name
