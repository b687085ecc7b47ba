"""The app on a simulated mill, driven by keys."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import textual.app
import textual.pilot
from textual._wait import wait_for_idle
from textual.message import Message
from textual.pilot import Pilot

from fraese.assembly import Plant, assemble
from fraese.assembly.drivers import ClockName
from fraese.config import Config
from fraese.control.about import About
from fraese.control.controller import Controller
from fraese.control.jobs import Job
from fraese.control.state import MachineState
from fraese.errors import ProgramError
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import End
from fraese.planner.lines import plan_line
from fraese.program.byhand import ByHand
from fraese.program.check import Complaint
from fraese.program.wants import Wants
from fraese.ui import FraeseApp
from fraese.ui.dialogs.start import StartDialog
from fraese.ui.room import HEIGHTS
from fraese.ui.views.machine import MachineView
from fraese.ui.widgets.fact import Fact

#: How long a test waits for what must come. Only a failing test takes so long, or a machine that is
#: busy with something else.
_PATIENCE_S = 60.0
#: X is so long that no move on it ends by itself while a test is still pressing keys.
_LONG_MM = 30_000
LONG_MOVE_MM = 0.8 * _LONG_MM
LONG = Config.model_validate({"axes": {"x": {"travel_mm": _LONG_MM}}})


#: A key has been heard by then. A machine in its own time leaves the process no idle moment, and
#: Textual would wait for one for two seconds a key.
_HEARD_S = 0.1


async def _until_heard(min_sleep: float = 0.02, max_sleep: float = _HEARD_S) -> None:
    await wait_for_idle(min_sleep, min(max_sleep, _HEARD_S))


textual.app.wait_for_idle = _until_heard  # type: ignore[attr-defined]
textual.pilot.wait_for_idle = _until_heard  # type: ignore[attr-defined]


@dataclass(frozen=True)
class FakeFacts:
    low_mm: tuple[float, ...] = (0.0, 0.0, 0.0)
    high_mm: tuple[float, ...] = (1.0, 1.0, 1.0)
    duration_s: float = 2.0
    length_mm: float = 4.0
    blocks: int = 4
    warnings: tuple[str, ...] = ()
    errors: tuple[Complaint, ...] = ()
    outside: tuple[Complaint, ...] = ()
    notes: tuple[Complaint, ...] = ()
    wants: Wants = field(default_factory=Wants)
    outline: None = None


@dataclass
class FakeProgram:
    """Moves X to and fro, one line a move."""

    lines: Sequence[str]
    distance_mm: float = 1.0
    name: str = "fake.nc"
    facts: FakeFacts = field(default_factory=FakeFacts)
    started: int = 0
    looked: int = 0
    stage: None = None
    map_words: str = ""
    #: Called in the machine's thread just before it starts.
    at_the_gate: Callable[[], object] = lambda: None

    def bend_to(self, path: Path | None) -> None:
        self.map_words = "" if path is None else path.name
        self.looked = 0

    def parts(self, line: str) -> list[tuple[str, str]]:
        return [("plain", line)]

    def news(self) -> str:
        return ""

    def question(self, controller: Controller) -> object | None:
        return None if self.looked else "how does it stand?"

    def look(self, question: object) -> FakeFacts:
        self.looked += 1
        return self.facts

    def give_up(self) -> None:
        pass

    def close(self) -> None:
        pass

    def stands(self, controller: Controller) -> str:
        return "so"

    def way_lines(self, stands: object, from_line: int, given_up: Callable[[], bool]) -> list[str]:
        return [f"fake.nc from line {from_line}:"]

    def drive_frame(self, controller: Controller) -> None:
        raise ProgramError("has no frame.", file=self.name)

    def start(self, controller: Controller, *, from_line: int = 0) -> None:
        self.at_the_gate()
        self.started += 1
        job = self._job(controller)
        about = About(lines=len(self.lines), expected_s=self.facts.duration_s)
        controller.start(self.name, job, about)

    def _job(self, controller: Controller) -> Job:
        machine = controller.machine
        step = machine.axes[0].to_steps(self.distance_mm)
        for number in range(1, len(self.lines) + 1):
            block = plan_line(machine, (step if number % 2 else -step, 0, 0), 600.0, tag=number)
            assert block is not None
            yield block


class Bench:
    """App, mill and pilot of one test."""

    def __init__(self, app: FraeseApp, plant: Plant, pilot: Pilot[None]) -> None:
        self.app = app
        self.plant = plant
        self.pilot = pilot
        assert isinstance(plant.port, SimulatedMill)
        self.mill = plant.port
        self._start_steps = self.mill.look().carriages_steps

    @property
    def view(self) -> MachineView:
        """The view below whatever is open."""
        view = self.app.view
        assert isinstance(view, MachineView)
        return view

    @property
    def moved_steps(self) -> tuple[float, ...]:
        """How far the carriages have come from where they stood."""
        at = self.mill.look().carriages_steps
        return tuple(a - b for a, b in zip(at, self._start_steps, strict=True))

    def text(self, selector: str) -> str:
        """What a field of the view shows."""
        return self.view.query_one(selector, Fact).text

    @property
    def drawn(self) -> MachineState:
        """The state last drawn."""
        return self.app._state

    async def show_view(self, name: str) -> None:
        """Change to this one, as an app with several does."""
        await self.app.switch_mode(name)
        self.app._draw(self.drawn)

    async def press(self, *keys: str) -> None:
        await self.pilot.press(*keys)

    def tell(self, message: Message) -> None:
        """As the terminal tells of it."""
        driver = self.app._driver
        assert driver is not None
        driver.process_message(message)

    async def type(self, text: str) -> None:
        await self.pilot.press(*("space" if char == " " else char for char in text))

    async def wait(self, condition: Callable[[], bool]) -> None:
        """Until it holds."""
        until = time.monotonic() + _PATIENCE_S
        while not condition():
            assert time.monotonic() < until, "this did not come about in time"
            await self.pilot.pause(0.01)

    async def settled(self) -> None:
        """Until the machine's thread has nothing to do, and that has been drawn."""
        controller = self.plant.controller
        await self.wait(lambda: not self.app.busy and self.drawn == controller.state())
        await self.pilot.pause()

    async def start(self) -> None:
        """Start the program that is loaded, by its dialog."""
        await self.ask_to_start()
        await self.press("enter")

    async def ask_to_start(self) -> StartDialog:
        """The dialog before a start, drawn."""
        await self.press("s")
        await self.wait(lambda: isinstance(self.app.screen, StartDialog))
        dialog = self.app.screen
        assert isinstance(dialog, StartDialog)
        await self.wait(lambda: dialog.focused is not None)
        # It knows by then how much room there is: nothing in it moves any more.
        await self.wait(lambda: any(dialog.has_class(name) for _, name in HEIGHTS))
        await self.pilot.pause()
        return dialog

    async def long_move(self) -> None:
        """X sets out on a way of twenty minutes, and has reached its speed.

        A way of some seconds would be over before a look at it, on a machine that is busy with
        something else.
        """
        self.app.link.order(lambda: self.plant.controller.move_to({"x": LONG_MOVE_MM}))
        await self.wait(lambda: self.plant.controller.state().speed_mm_min > 1100)

    async def jog(self, *keys: str) -> None:
        for key in keys:
            await self.press(key)
            await self.settled()

    def hand(self, name: str, pressed: bool) -> None:
        end = End("xyz".index(name[0]), 1 if name.endswith("max") else -1)
        (self.mill.press if pressed else self.mill.let_go)(end)


def open_nothing(path: Path) -> FakeProgram:
    raise ProgramError("cannot be read: there is no such file", file=str(path))


@asynccontextmanager
async def bench(
    size: tuple[int, int] = (80, 24),
    clock: ClockName = "virtual",
    config: Config | None = None,
    notifications: bool = False,
    **options: Any,
) -> AsyncIterator[Bench]:
    """The app in a terminal of this size. Where a second is a second, X is very long."""
    plant = assemble(config or (LONG if clock == "paced" else Config()), clock=clock)
    options.setdefault("open_program", open_nothing)
    options.setdefault("tools", ByHand())
    app = FraeseApp(plant.controller, machine_name="simulated mill", **options)
    async with app.run_test(size=size, notifications=notifications) as pilot:
        yield Bench(app, plant, pilot)


def play(scene: Callable[[], Awaitable[None]]) -> None:
    """Run a coroutine as a plain test."""

    async def run() -> None:
        await scene()

    asyncio.run(run())
