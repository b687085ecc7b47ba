"""Five inputs behind the real firmware: a reference run, and which end was met on a diagonal."""

from typing import Any

import pytest

from fraese.assembly import assemble, drivers
from fraese.assembly.drivers import Made, Order, on_metal
from fraese.assembly.simulation import simulated_mill
from fraese.config.file import from_table
from fraese.control.state import Status
from fraese.kinds.card import card_kind
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.ports.recorder import Recorder
from fraese.motor.seams import End
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import Chip, ChipLine
from tests.control.test_switchlines import FIVE
from tests.helpers import merged

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

SMALL: dict[str, Any] = {
    "axes": {name: {"travel_mm": 6} for name in "xyz"},
    "homing": {"pull_off_mm": 1},
    "port": {"kind": "bridge"},
}


def test_ends_are_found_and_named_by_their_inputs(monkeypatch: pytest.MonkeyPatch) -> None:
    config = from_table(merged(FIVE, SMALL), "test")
    chip = Chip("x4step")
    chip.twin.simulated = mill = simulated_mill(config, chip._twin_clock)
    chip.twin.port = Recorder(mill, chip._twin_clock)

    def on_chip(order: Order) -> Made:
        facts = card_kind(config).facts(order.card, config.card.kind)
        driver = BridgeDriver(
            lambda: ChipLine(chip), order.card, chip, switch=order.switch, facts=facts
        )
        chip.begin()
        return on_metal(driver, chip)

    monkeypatch.setattr(drivers, "DRIVERS", {"bridge": on_chip})
    plant = assemble(config)
    controller = plant.controller
    controller.home()
    assert controller.run() is Status.OK, controller.state().message
    assert mill.mill.lost_steps() == (0, 0, 0)
    # A millimetre from the ends of X and Y, and from the switch of Z, a millimetre before its end.
    assert mill.mill.carriages_steps() == pytest.approx((200, 200, 800), abs=3)

    def press() -> None:
        if controller.state().position_mm[0] > 1.5:
            mill.press(End(1, 1))

    controller.set_break_key(press)
    controller.move_to({"x": 3, "y": 3})
    assert controller.run() is Status.ERROR
    assert controller.state().ends == ("ymax",)
    plant.close()
