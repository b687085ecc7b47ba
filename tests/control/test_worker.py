"""The thread that owns a controller: nothing lost, nothing late, nothing left over."""

import threading
import time
from collections.abc import Callable, Iterator

import pytest

from fraese.assembly import Plant, assemble
from fraese.blocks import Block
from fraese.config import Config
from fraese.control.jobs import Ask, Job
from fraese.control.lines import axis_line
from fraese.control.state import Status
from fraese.control.worker import Worker
from fraese.errors import PortError, ProbeError
from fraese.motor.seams import End


class Rig:
    def __init__(self) -> None:
        self.plant: Plant = assemble(Config(), clock="virtual")
        self.controller = self.plant.controller
        self.refused: list[str] = []
        self.worker = Worker(self.controller, self.refused.append, lambda: None)
        self.worker.start()

    def wait(self, condition: Callable[[], bool] | None = None) -> None:
        until = time.monotonic() + 5
        while self.worker.busy if condition is None else not condition():
            assert time.monotonic() < until
            time.sleep(0.002)


@pytest.fixture
def rig() -> Iterator[Rig]:
    rig = Rig()
    yield rig
    rig.worker.close()


def test_a_command_is_done_and_run(rig: Rig) -> None:
    assert rig.worker.submit(lambda: rig.controller.jog("x", 1))
    rig.wait()
    assert rig.controller.position.position_steps == (200, 0, 0)


def test_a_refusal_is_said_and_nothing_moves(rig: Rig) -> None:
    rig.worker.submit(lambda: rig.controller.jog("x", 1000))
    rig.wait()
    assert "at most 50 mm" in rig.refused[0]
    assert rig.controller.position.position_steps == (0, 0, 0)


def test_only_one_of_the_same_group_waits(rig: Rig) -> None:
    go = threading.Event()
    assert rig.worker.submit(lambda: go.wait(5), "jog")
    rig.wait(lambda: rig.worker.busy and rig.worker.submit(lambda: None, "jog"))
    assert not rig.worker.submit(lambda: None, "jog")
    go.set()
    rig.wait()


def test_nothing_waits_behind_another_group(rig: Rig) -> None:
    go = threading.Event()
    begun = threading.Event()

    def program() -> None:
        begun.set()
        go.wait(5)

    rig.worker.submit(program)
    begun.wait(5)
    assert not rig.worker.submit(lambda: rig.controller.jog("x", 1), "jog")
    assert not rig.worker.submit(lambda: rig.controller.jog("x", 1))
    go.set()
    rig.wait()
    assert rig.controller.position.position_steps == (0, 0, 0)


def test_a_cancel_counts_for_a_command_that_has_not_yet_started(rig: Rig) -> None:
    taken, go = threading.Event(), threading.Event()

    def command() -> None:
        taken.set()
        go.wait(5)
        rig.controller.jog("x", 10)

    rig.worker.submit(command)
    taken.wait(5)
    rig.worker.cancel()
    go.set()
    rig.wait()
    assert rig.controller.position.position_steps == (0, 0, 0)
    assert rig.controller.status is Status.OK
    assert "Cancelled" in rig.controller.state().message


def test_a_cancel_at_standstill_leaves_no_hold(rig: Rig) -> None:
    rig.worker.cancel()
    time.sleep(0.12)
    assert not rig.controller.state().held


@pytest.mark.parametrize("late", [False, True])
def test_after_a_surprise_the_machine_is_free_again(rig: Rig, late: bool) -> None:
    def job() -> Job:
        yield from [] if late else ()
        raise ZeroDivisionError("oops")
        yield Block

    def command() -> None:
        if late:
            rig.controller.start("odd", job())
        else:
            raise ZeroDivisionError("oops")

    rig.worker.submit(command)
    rig.wait()
    assert "ZeroDivisionError" in rig.refused[0]
    assert rig.controller.status is Status.OK
    assert rig.worker.submit(lambda: rig.controller.jog("x", 1))
    rig.wait()
    assert rig.controller.position.position_steps == (200, 0, 0)


def test_a_hold_does_not_spin() -> None:
    plant = assemble(Config(), clock="paced")
    worker = Worker(plant.controller, lambda _: None, lambda: None)
    rounds: list[int] = []
    plant.controller.set_show_pos(lambda: rounds.append(1))
    worker.start()
    worker.submit(lambda: plant.controller.jog("x", 50))
    until = time.monotonic() + 5
    while not plant.controller.state().running and time.monotonic() < until:
        time.sleep(0.01)
    plant.controller.hold()
    while not plant.controller.state().held and time.monotonic() < until:
        time.sleep(0.01)
    before = len(rounds)
    time.sleep(0.3)
    assert len(rounds) - before < 30
    worker.close()


def test_close_brakes_and_switches_off() -> None:
    plant = assemble(Config(), clock="paced")
    worker = Worker(plant.controller, lambda _: None, lambda: None)
    worker.start()
    worker.submit(lambda: plant.controller.jog("x", 50))
    until = time.monotonic() + 5
    while not plant.controller.state().running and time.monotonic() < until:
        time.sleep(0.01)
    worker.close()
    worker.close()
    state = plant.controller.state()
    assert not plant.port.electronics.currents(0).a_percent  # type: ignore[union-attr]
    assert 0 < state.position_steps[0] < 10_000
    assert not worker.submit(lambda: None)


def test_trouble_between_commands_is_told_once_and_the_thread_lives_on(rig: Rig) -> None:
    def gone(elapsed_s: float) -> None:
        raise PortError("The port went away.")

    rig.controller.idle = gone  # type: ignore[assignment]
    rig.wait(lambda: bool(rig.refused))
    time.sleep(0.12)
    assert rig.refused == ["The port went away."]
    assert rig.worker.submit(lambda: rig.controller.jog("x", 1))
    rig.wait()
    assert rig.controller.position.position_steps == (200, 0, 0)


def test_an_error_that_waits_is_not_acknowledged_by_a_refusal(rig: Rig) -> None:
    rig.plant.port.press(End(0, 1))  # type: ignore[union-attr]
    rig.worker.submit(lambda: rig.controller.move_to({"x": 1}))
    rig.wait(lambda: len(rig.refused) == 1)
    rig.plant.port.let_go(End(0, 1))  # type: ignore[union-attr]
    rig.worker.submit(lambda: rig.controller.start("odd", failing()))
    rig.wait()
    assert rig.controller.status is Status.ERROR
    rig.worker.submit(lambda: rig.controller.jog("x", 1))
    rig.wait(lambda: len(rig.refused) == 2)
    assert "Acknowledge" in rig.refused[1]
    rig.wait()
    assert rig.controller.status is Status.ERROR


def failing() -> Job:
    yield from ()
    raise ProbeError("never touched")


def asking(rig: Rig) -> None:
    """A job that asks, moves, and is over."""

    def job() -> Job:
        yield Ask("Well?")
        yield from axis_line(rig.controller.position, 0, 200, None, None)

    rig.worker.submit(lambda: rig.controller.start("asks", job()))
    rig.wait(lambda: rig.controller.question == "Well?")


def test_while_a_job_asks_commands_are_done_and_refused(rig: Rig) -> None:
    asking(rig)
    controller = rig.controller
    assert rig.worker.submit(lambda: controller.jog("y", 1))
    rig.wait(lambda: controller.position.position_steps == (0, 200, 0))
    rig.wait(lambda: controller.question == "Well?")
    assert rig.worker.submit(lambda: controller.home(["x"]))
    rig.wait(lambda: bool(rig.refused))
    assert "The machine runs" in rig.refused[0]
    assert controller.question == "Well?"
    controller.answer()
    rig.wait()
    assert controller.position.position_steps == (200, 200, 0)


def test_a_stop_ends_what_is_done_meanwhile_first(rig: Rig) -> None:
    asking(rig)
    rig.worker.submit(lambda: rig.controller.jog("y", 50))
    rig.wait(lambda: rig.controller.state().running)
    rig.worker.cancel()
    rig.wait(lambda: rig.controller.question == "Well?")
    assert 0 < rig.controller.position.position_steps[1] < 10_000
    rig.worker.cancel()
    rig.wait()
    assert rig.controller.status is Status.OK


def test_who_closes_waits_for_no_answer_and_no_guest(rig: Rig) -> None:
    asking(rig)
    rig.worker.submit(lambda: rig.controller.jog("y", 50))
    rig.wait(lambda: rig.controller.state().running)
    since = time.monotonic()
    rig.worker.close()
    assert time.monotonic() - since < 5
    assert rig.controller.status is not Status.RUN


def test_a_mistake_of_a_guest_stops_everything(rig: Rig) -> None:
    asking(rig)
    rig.worker.submit(lambda: 1 / 0)
    rig.wait()
    assert "ZeroDivisionError" in rig.refused[0]
