"""What of a configuration counts at once, and what waits for the next start."""

import pytest

from fraese.assembly import assemble
from fraese.config import Config
from fraese.control.adopting import adopt, is_at_once
from fraese.control.state import Status
from fraese.errors import LimitError, StateError


def test_the_next_jog_has_the_new_bound() -> None:
    plant = assemble(Config())
    controller = plant.controller
    with pytest.raises(LimitError):
        controller.jog("x", 60)
    adopt(controller, Config.model_validate({"jog": {"max_mm": 70}}))
    controller.jog("x", 60)
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 60
    plant.close()


def test_what_the_machine_was_made_of_stays() -> None:
    plant = assemble(Config())
    before = plant.controller.config
    wanted = {
        "axes": {"x": {"pitch_mm": 4}},
        "homing": {"pull_off_mm": 3, "slow_mm_min": 30},
        "run": {"lead_s": 0.5, "default_feed_mm_min": 200},
        "tools": {"2": {"length_mm": 5}},
    }
    adopt(plant.controller, Config.model_validate(wanted))
    now = plant.controller.config
    assert now.axes == before.axes
    assert (now.homing.pull_off_mm, now.homing.slow_mm_min) == (2, 30)
    assert (now.run.lead_s, now.run.default_feed_mm_min) == (before.run.lead_s, 200)
    assert now.tools["2"].length_mm == 5
    plant.close()


def test_what_does_not_fit_yet_waits() -> None:
    """A safe height in a travel that the machine has from the next start only."""
    plant = assemble(Config())
    before = plant.controller.config
    wanted = {"axes": {"z": {"travel_mm": 200}}, "run": {"safe_z_mm": -150}}
    with pytest.raises(StateError, match="from the next start"):
        adopt(plant.controller, Config.model_validate(wanted))
    assert plant.controller.config is before
    plant.close()


def test_nothing_is_changed_under_a_job() -> None:
    plant = assemble(Config())
    plant.controller.move_to({"x": 10})
    with pytest.raises(StateError, match="The machine runs"):
        adopt(plant.controller, Config.model_validate({"jog": {"max_mm": 70}}))
    plant.close()


@pytest.mark.parametrize(
    ("key", "at_once"),
    [
        ("jog.max_mm", True), ("tools.3.length_mm", True), ("planner.window", True),
        ("homing.slow_mm_min", True), ("homing.pull_off_mm", False), ("run.lead_s", False),
        ("run.optional_stop", False), ("axes.x.pitch_mm", False), ("keys.go_to", False),
        ("language", False),
    ],
)  # fmt: skip
def test_which_keys_count_at_once(key: str, at_once: bool) -> None:
    assert is_at_once(key) is at_once
