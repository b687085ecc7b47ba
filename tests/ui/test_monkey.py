"""A monkey at the app, for a moment; ``make monkey`` lets it stay for most of an hour."""

import random
from collections import deque

import pytest

from fraese.control.state import Status
from tests.helpers import homed
from tests.ui.monkey import Found, Watch, lives

EVENTS = 300


def test_whatever_a_monkey_does_the_machine_is_where_it_says() -> None:
    assert [done for _, done in lives(20, EVENTS)][-1] == EVENTS


def test_the_watch_sees_a_carriage_that_is_not_where_it_counts() -> None:
    plant, told = homed(), deque[str]()
    watch = Watch(plant, told.append)
    watch.at_rest()
    assert not watch.found
    assert plant.port is not None
    plant.port.mill.rotors[1].place(plant.port.mill.rotors[1].position_steps + 3)
    watch.at_rest()
    assert "y counts" in watch.found


def test_the_watch_sees_an_axis_beyond_its_limits() -> None:
    plant, told = homed(), deque[str]()
    watch = Watch(plant, told.append)
    plant.controller.move_to({"x": 5.0}, machine_coordinates=True)
    assert plant.controller.run() is Status.OK
    watch.look()
    assert not watch.found
    where = plant.controller.position
    where.position_steps = (-1, *where.position_steps[1:])
    watch.look()
    assert "x is 1 steps outside" in watch.found


def test_a_failure_says_how_to_have_it_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def find(watch: Watch) -> None:
        watch.found = "broken on purpose"

    monkeypatch.setattr(Watch, "at_rest", find)
    seed = random.randrange(100)
    with pytest.raises(Found, match=rf"(?s)broken on purpose.*--seed {seed} --life 0"):
        list(lives(seed, 30))
