"""A busy program says that it lives, for a while, and nothing while it looks at the line itself."""

import pytest

from fraese.errors import PortError
from fraese.motor.bridge.lifesign import EVERY_S, LifeSign
from tests.helpers import configured


class Driver:
    def __init__(self, unattended_s: float | None, lost: bool = False) -> None:
        self._unattended_s = unattended_s
        self._lost = lost
        self.signs = 0

    def unattended_s(self) -> float | None:
        return self._unattended_s

    def sign_of_life(self) -> None:
        self.signs += 1
        if self._lost:
            raise PortError("the line is gone")


@pytest.mark.parametrize(
    ("unattended_s", "signs"),
    [(0.0, 0), (EVERY_S / 2, 0), (EVERY_S, 1), (1.4, 1), (1.5, 0), (60.0, 0)],
)
def test_it_speaks_while_nobody_else_does_and_not_for_ever(unattended_s: float, signs: int) -> None:
    driver = Driver(unattended_s)
    assert LifeSign(driver, busy_s=1.5).turn()
    assert driver.signs == signs


def test_a_lost_line_is_not_its_business_and_a_closed_driver_its_end() -> None:
    assert LifeSign(Driver(0.5, lost=True), 1.5).turn()
    assert not LifeSign(Driver(None), 1.5).turn()


@pytest.mark.parametrize(
    ("given", "silence_s", "busy_s"),
    [
        ({}, 0.5, 1.5),
        ({"silent_s": 5}, 5, 0),
        ({"silent_s": 0.2}, 0.2, 0),
        ({"bridge_silent_s": 0.3}, 0.3, 1.7),
        ({"silent_s": 1, "bridge_silent_s": 4}, 4, 0),
        ({"silent_s": 3, "bridge_silent_s": 1}, 1, 2),
    ],
)
def test_older_configurations_keep_their_meaning(
    given: dict[str, float], silence_s: float, busy_s: float
) -> None:
    realtime = configured(realtime=given).realtime
    assert realtime.silence_of_bridge_s == silence_s
    assert realtime.busy_s == busy_s


@pytest.mark.parametrize(("lease_ns", "signs"), [(0, 1), (1000, 1), (999, 0)])
def test_it_speaks_no_longer_than_the_lease(lease_ns: int, signs: int) -> None:
    driver = Driver(0.5)
    sign = LifeSign(driver, 1.5, lambda: 1000)
    sign.lease(lease_ns)
    assert sign.turn()
    assert driver.signs == signs
