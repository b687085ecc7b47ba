"""Commands on a parallel port that are ended in the middle of a move, from whatever side.

    program --dies, hangs, is told to end--> step process --> motors off
    step process --dies, hangs-------------> program -------> motors off
    port ---goes away----------------------> step process --> program says so

Afterwards: what stands on the pins, within what time, and what the person is told.
"""

import errno
import os
import signal
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from fraese.assembly.survivors import KNOWN
from tests.rigs.lpt.fakeport import Event, missing, writes
from tests.rigs.lpt.shop import Answer, Shop, child_of, is_alive
from tests.rigs.lpt.steps import check_motors_off, data_bytes

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

#: The promise is 0.1 s, to whoever has a processor of his own; the tests share theirs.
SOON_S = 1.0


def check_off_within(shop: Shop, since_ns: int, limit_s: float) -> list[Event]:
    """Motors off and the port given back; what happened after that time."""
    after = [event for event in shop.fake.events() if event.at_ns > since_ns]
    check_motors_off(writes(after))
    last = [event for event in after if event.what == "W"][-1]
    assert last.at_ns - since_ns < limit_s * 1e9
    assert after[-1].what == "X"
    return after


def check_alarm(answer: Answer, *sentences: str) -> None:
    """The program ended with an alarm that says all this, and knows that it knows nothing."""
    assert answer.code == 1
    result = answer.result
    assert result["status"] == "alarm"
    for sentence in sentences:
        assert sentence in result["message"]
    assert not any(result["referenced"].values())
    assert result["blocks"] > 0


@pytest.mark.parametrize(
    ("port", "number"),
    [("ppdev", signal.SIGINT), ("devport", signal.SIGTERM), ("ppdev", signal.SIGHUP)],
)
def test_a_signal_brakes_and_switches_off(
    tmp_path: Path, port: str, number: signal.Signals
) -> None:
    shop = Shop(tmp_path, port)
    with shop.begun("run", "long.ngc", "--json") as command:
        told_ns = time.monotonic_ns()
        command.send_signal(number)
        answer = shop.end(command)
    assert answer.code == 130
    assert answer.result["status"] == "cancelled"
    check_off_within(shop, told_ns, SOON_S)
    # It braked with ramp: the position is known, to the step, and kept.
    position_steps = tuple(answer.result["position_steps"].values())
    assert position_steps == shop.travelled_steps() == tuple(shop.kept()["position_steps"])
    # The spindle is off too: pin 14 is high where bit 1 is clear.
    assert not shop.fake.control & 0x02


def test_a_killed_program_leaves_the_motors_off(tmp_path: Path) -> None:
    """kill -9: the step process sees it, brakes, switches off, and ends."""
    shop = Shop(tmp_path, "devport")
    with shop.begun("run", "long.ngc") as command:
        child = child_of(command.pid)
        killed_ns = time.monotonic_ns()
        command.kill()
        shop.fake.wait_for(lambda: not is_alive(child))
    after = check_off_within(shop, killed_ns, SOON_S)
    assert {event.pid for event in after} == {child}
    # It has braked: no tick was given up half-way, both axes made the same steps.
    x_steps, y_steps, _ = shop.travelled_steps()
    assert x_steps == y_steps
    # The motors are where the last record says that they are, and the step process knows better.
    check_within(shop)
    answer = shop.command("where", "--json")
    assert KNOWN in answer.noted
    assert claimed_steps(answer) == shop.travelled_steps()
    assert shop.kept()["motion"] is not None
    # The next command that drives takes the place over, with the phases: no step is lost.
    answer = shop.command("move", "X0.1", "--relative", "--json")
    assert KNOWN in answer.noted
    assert claimed_steps(answer) == shop.travelled_steps()
    assert tuple(shop.kept()["position_steps"]) == shop.travelled_steps()
    assert shop.kept()["motion"] is None


def claimed_steps(answer: Answer) -> tuple[int, ...]:
    """Where the machine is said to be, to the step."""
    assert answer.result["doubt"] is None
    return tuple(answer.result["position_steps"].values())


def check_within(shop: Shop) -> None:
    """The bounds of the record in force hold."""
    motion = shop.kept()["motion"]
    between = zip(motion["low_steps"], shop.travelled_steps(), motion["high_steps"], strict=True)
    for low, at, high in between:
        assert low <= at <= high


def test_a_killed_step_process_is_replaced_at_the_switch_off(tmp_path: Path) -> None:
    """kill -9: the program takes the port again, switches off, and says what happened."""
    shop = Shop(tmp_path, "ppdev")
    with shop.begun("run", "long.ngc", "--json") as command:
        child = child_of(command.pid)
        killed_ns = time.monotonic_ns()
        os.kill(child, signal.SIGKILL)
        answer = shop.end(command)
    check_alarm(answer, "The step process died (SIGKILL); the motors were switched off ")
    after = check_off_within(shop, killed_ns, SOON_S)
    assert {event.pid for event in after[-10:]} == {command.pid}
    # What the alarm says of the place is what is kept of it: a tick wide, and the truth is within.
    told, kept = answer.result["alarm"]["parameters"], shop.kept()
    assert kept["motion"] is None
    at_and_spans = zip(kept["position_steps"], kept["doubt"]["spans_steps"], strict=True)
    bounds = [(at - below, at + above) for at, (below, above) in at_and_spans]
    assert bounds == list(zip(told["low_steps"], told["high_steps"], strict=True))
    assert all(
        low <= at <= high <= low + 1
        for (low, high), at in zip(bounds, shop.travelled_steps(), strict=True)
    )


@pytest.mark.parametrize("dies", [True, False], ids=["step process killed", "port away"])
def test_the_next_current_pulls_the_rotors_to_where_they_are_counted(
    tmp_path: Path, dies: bool
) -> None:
    """Whatever the last report said: the motors had gone on since then."""
    shop = Shop(tmp_path, "devport")
    with shop.begun("run", "long.ngc", "--json") as command:
        if dies:
            os.kill(child_of(command.pid), signal.SIGKILL)
        else:
            shop.fake.refuse("access", errno.EIO)
        shop.end(command)
    shop.fake.refuse("access", 0)
    stood_steps = shop.travelled_steps()
    answer = shop.command("move", "X0.1", "--relative", "--json")
    doubt = answer.result["doubt"]
    for axis, low in doubt["low_steps"].items():
        at = shop.travelled_steps()["xyz".index(axis)]
        assert low <= at <= doubt["high_steps"][axis] <= low + 1
    moved = [b - a for a, b in zip(stood_steps, shop.travelled_steps(), strict=True)]
    assert abs(moved[0] - 20) <= 1
    assert abs(moved[1]) <= 1


def test_a_hung_step_process_is_killed_and_the_motors_switched_off(tmp_path: Path) -> None:
    shop = Shop(tmp_path, "devport")
    with shop.begun("run", "long.ngc", "--json") as command:
        hung_ns = time.monotonic_ns()
        os.kill(child_of(command.pid), signal.SIGSTOP)
        answer = shop.end(command)
    check_alarm(answer, "did not answer for 1 s and was killed; the motors were switched off ")
    check_off_within(shop, hung_ns, 1 + SOON_S)


def test_a_hung_program_is_not_waited_for(tmp_path: Path) -> None:
    """It holds minutes of motion in the queue, and looks after none of it."""
    shop = Shop(tmp_path, "ppdev", lead_s=10)
    with shop.begun("run", "long.ngc", "--json") as command:
        hung_ns = time.monotonic_ns()
        command.send_signal(signal.SIGSTOP)
        shop.fake.wait_for(lambda: data_bytes(shop.fake.writes()[-9:])[-3:] == [0x1B, 0x5B, 0x9B])
        assert time.monotonic_ns() - hung_ns > 0.9e9
        stood_steps = shop.travelled_steps()
        command.send_signal(signal.SIGCONT)
        answer = shop.end(command)
    check_silence(answer, stood_steps)
    check_off_within(shop, hung_ns, 1 + 2 * SOON_S)
    assert shop.travelled_steps() == stood_steps


def check_silence(answer: Answer, stood_steps: Sequence[int]) -> None:
    """The program was told that it had been silent, and knows where the machine stands."""
    assert answer.code == 1
    assert "did not look after the motors for too long" in answer.result["message"]
    assert tuple(answer.result["position_steps"].values()) == tuple(stood_steps)


def test_a_second_program_is_refused_and_the_first_goes_on(tmp_path: Path) -> None:
    shop = Shop(tmp_path, "ppdev")
    with shop.begun("run", "long.ngc", "--json") as command:
        second = shop.command("move", "X1", "--json")
        assert second.code == 1
        assert (
            f"is driven by fraese run long.ngc --json (process {command.pid})"
            in (second.result["message"])
        )
        assert f"fraese: {second.result['message']}\n" in second.noted
        # Whoever only looks is answered.
        assert shop.command("where").code == 0
        seen = shop.fake.count()
        shop.fake.wait_for(lambda: shop.fake.count() > seen + 1000)
        # Nobody but the first one's step process has written anything.
        pids = {event.pid for event in shop.fake.events() if event.what == "W"}
        assert pids == {child_of(command.pid)}


def test_a_port_that_goes_away_ends_the_job(tmp_path: Path) -> None:
    shop = Shop(tmp_path, "ppdev")
    with shop.begun("run", "long.ngc", "--json") as command:
        shop.fake.refuse("access", errno.EIO)
        answer = shop.end(command)
    check_alarm(
        answer,
        " does not answer any more: Input/output error; position and motor currents are unknown,"
        " switch the motors' supply off, then reference the machine again.",
    )
    assert answer.result["message"].count("Input/output error") == 1
