"""Who may speak when: what is marked for any thread sets flags, and constructors are silent."""

import inspect
import threading
from collections.abc import Callable
from typing import Any

import pytest

from fraese.anythread import MARK
from fraese.control.controller import Controller
from fraese.control.endswitches import EndSwitches
from fraese.control.handling import Handling
from fraese.control.motionqueue import MotionQueue
from fraese.control.position import Position
from fraese.control.recorder import Recorder
from fraese.control.runloop import RunLoop
from fraese.control.runner import Runner
from fraese.control.state import Status
from fraese.machine import Machine
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.core import MotorCore
from fraese.motor.requests import Requests
from fraese.motor.run import Run
from fraese.motor.seams import StepDriver
from fraese.motor.ticks import Ticks
from fraese.motor.track import Track
from tests.helpers import after_slices, configured, plant

#: Everything that a marked method may set, by the class that owns it.
FLAGS = {
    ("Handling", "_word_q8"),
    ("Handling", "feed"),
    ("Handling", "may_be_over"),
    ("Handling", "rapid"),
    ("Handling", "single_block"),
    ("Requests", "brake_wanted"),
    ("Requests", "calm"),
    ("Requests", "override_q8"),
    ("Requests", "stop_wanted"),
    ("Runner", "_answered"),
    ("Runner", "_cancel"),
    ("Runner", "_held"),
    ("Runner", "_resume"),
    ("Runner", "_stop"),
}
OWNERS = (
    Controller, EndSwitches, Handling, MotionQueue, Position, RunLoop, Runner,
    MotorCore, Requests, Run, Ticks, Track,
)  # fmt: skip
ARGUMENTS: dict[str, tuple[object, ...]] = {
    "set_feed": (1.5,), "set_rapid": (0.5,), "switch": ("single_block",), "switch_log": (False,),
}  # fmt: skip
#: In this order a job is held, lifted, and brought to its end.
LAST = ("hold", "resume", "cancel", "stop")


def is_any_thread(function: object) -> bool:
    """Whether a function, or the getter of a property, is marked."""
    if isinstance(function, property):
        function = function.fget
    return MARK in getattr(function, "__dict__", {})


def marked(kind: type) -> list[str]:
    names = [name for name, member in vars(kind).items() if is_any_thread(member)]
    return sorted(names, key=lambda name: LAST.index(name) if name in LAST else -1)


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, str, str]]:
    """Every attribute that is set, with the thread that sets it."""
    seen: list[tuple[int, str, str]] = []

    def spied(kind: type) -> Callable[[object, str, object], None]:
        def spy(self: object, name: str, value: object) -> None:
            seen.append((threading.get_ident(), kind.__name__, name))
            object.__setattr__(self, name, value)

        return spy

    for kind in OWNERS:
        monkeypatch.setattr(kind, "__setattr__", spied(kind), raising=False)
    return seen


def test_what_is_marked_sets_flags_and_nothing_else(written: list[tuple[int, str, str]]) -> None:
    made = plant()
    controller = made.controller
    called: list[str] = []
    strangers: list[int] = []

    def call_all() -> None:
        strangers.append(threading.get_ident())
        for owner in (controller, controller.handling):
            for name in marked(type(owner)):
                member = getattr(owner, name)
                if callable(member):
                    member(*ARGUMENTS.get(name, ()))
                called.append(name)

    def from_another_thread() -> None:
        thread = threading.Thread(target=call_all)
        thread.start()
        thread.join()

    controller.move_to({"x": 100, "y": 30})
    after_slices(controller, 5, from_another_thread)
    assert controller.run() is Status.CANCEL
    assert {"cancel", "stop", "hold", "resume", "answer", "state", "status"} <= set(called)
    # Without a question there is nothing to answer.
    by_stranger = {(kind, name) for thread, kind, name in written if thread in strangers}
    assert by_stranger == FLAGS - {("Runner", "_answered")}


def test_an_answer_is_a_flag_too(written: list[tuple[int, str, str]]) -> None:
    made = plant()
    runner = made.controller._loop.runner
    runner.question = "Go on?"
    del written[:]
    made.controller.answer()
    assert {(kind, name) for _, kind, name in written} == {("Runner", "_answered")}


@pytest.mark.parametrize(
    ("driver", "more"),
    [(MotorCore, []), (BridgeDriver, ["sign_of_life", "unattended_s"])],
)
def test_the_drivers_mark_what_the_seam_marks(driver: type, more: list[str]) -> None:
    assert marked(StepDriver) == ["brake", "set_override", "stop"]
    assert sorted(marked(driver)) == sorted([*marked(StepDriver), *more])


def test_the_child_s_driver_too() -> None:
    driver = pytest.importorskip("fraese.motor.realtime.driver")
    assert sorted(marked(driver.RealtimeDriver)) == sorted([*marked(StepDriver), "lease"])


def test_every_method_of_the_controller_is_one() -> None:
    """None is an attribute that was put there while it was made: each has its own docstring."""
    controller = plant().controller
    hung_on = [name for name, value in vars(controller).items() if callable(value)]
    assert hung_on == []
    for name, member in inspect.getmembers(Controller, inspect.isfunction):
        assert name.startswith("_") or member.__doc__, name


def test_while_it_is_made_nobody_speaks_to_the_driver() -> None:
    class Silent:
        """A driver that nobody has opened yet."""

        def __getattribute__(self, name: str) -> Any:
            raise AssertionError(f"{name} was called")

    config = configured()
    driver: Any = Silent()
    position = Position(Machine.from_config(config))
    switches = EndSwitches(config, position, driver)
    queue = MotionQueue(driver, position, switches, Recorder())
    for part in (switches, queue):
        with pytest.raises(AssertionError, match="was called"):
            part.open()
