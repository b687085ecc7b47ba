"""The app in a terminal, on the fake parallel port with a machine on it."""

import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.rigs.lpt.fakeport import missing
from tests.rigs.lpt.shop import STEPS_PER_MM, Shop, child_of
from tests.rigs.lpt.steps import check_motors_off

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

if not missing():
    from tests.rigs.lpt.terminal import Terminal


@pytest.fixture
def shop(tmp_path: Path) -> Shop:
    return Shop(tmp_path, "ppdev")


@pytest.fixture
def terminal(shop: Shop) -> "Iterator[Terminal]":
    terminal = Terminal([sys.executable, "-m", "fraese"], shop.folder, shop.environment)
    try:
        terminal.wait_for("Hold")
        yield terminal
    finally:
        terminal.close()


def jogged_steps(shop: Shop) -> int:
    return shop.travelled_steps()[0]


def test_jogs_arrive_the_stop_key_brakes_and_quitting_switches_off(
    shop: Shop, terminal: "Terminal"
) -> None:
    terminal.press("right")
    shop.fake.wait_for(lambda: jogged_steps(shop) == STEPS_PER_MM)
    terminal.press("5", "right")
    shop.fake.wait_for(lambda: jogged_steps(shop) > 3 * STEPS_PER_MM)
    terminal.press("escape")
    terminal.wait_for("Cancelled at")
    stood_steps = jogged_steps(shop)
    assert stood_steps < 11 * STEPS_PER_MM
    check_motors_off(shop.fake.writes())
    terminal.press("q")
    assert terminal.wait_for_end() == 0
    check_motors_off(shop.fake.writes())
    assert shop.fake.events()[-1].what == "X"
    assert shop.kept()["position_steps"] == [stood_steps, 0, 0]
    assert jogged_steps(shop) == stood_steps


def test_after_the_death_of_the_step_process_the_app_goes_on_with_another(
    shop: Shop, terminal: "Terminal"
) -> None:
    terminal.press("5", "right")
    shop.fake.wait_for(shop.is_under_way)
    first = child_of(terminal.process.pid)
    os.kill(first, signal.SIGKILL)
    terminal.wait_for("The step process died")
    check_motors_off(shop.fake.writes())
    terminal.press("enter")
    stood_steps = jogged_steps(shop)
    until_s = time.monotonic() + 20
    while jogged_steps(shop) == stood_steps:
        # Another one is started in a moment; until then keys are refused.
        assert time.monotonic() < until_s
        terminal.press("left")
        time.sleep(0.2)
    assert child_of(terminal.process.pid) != first
    terminal.process.send_signal(signal.SIGTERM)
    assert terminal.wait_for_end() == 128 + signal.SIGTERM
    check_motors_off(shop.fake.writes())
