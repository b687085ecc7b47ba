"""Measurements judged: nothing here depends on how fast this machine is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fraese import doctor
from fraese.doctor.findings import State
from fraese.doctor.timing import (
    EDGES_US,
    Conditions,
    Timing,
    advice,
    duty_of,
    judge,
    limit_hz,
    rates_to_try,
)
from fraese.motor.cards.stepdir import StepDirCard
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.measure import Lateness, Rung, smc_duty
from fraese.motor.realtime.setup import RealtimeOptions
from tests.doctor.ward import by_name, sound_machine
from tests.helpers import STEPDIR, configured

DUTY = smc_duty(5000.0)
ON_TIME = np.full(10_000, 2.0)
QUARTER_US = 50.0


def with_late(number: int, late_us: float = 400.0) -> Lateness:
    """So many of ten thousand ticks are late."""
    late = ON_TIME.copy()
    late[:number] = late_us
    return Lateness(DUTY, late, 4999.0, 0, 0, ())


def timing(quiet: Lateness, busy: Lateness, *rungs: Rung) -> Timing:
    runs = (Conditions("quiet", 0, quiet), Conditions("busy", 2, busy))
    return Timing(DUTY, runs, rungs or (Rung(5000.0, 4.0, 5000.0),))


def test_punctual_steps_are_fine() -> None:
    found = by_name(judge(timing(with_late(0), with_late(9))))
    assert {finding.state for finding in found.values()} == {State.OK}
    assert "9 of 10000 are later than the quarter" in found["timing, busy"].found
    assert found["highest rate"].found == "5000 ticks/s hold; more is not asked of this card."


def test_one_tick_in_five_hundred_is_too_many() -> None:
    found = by_name(judge(timing(with_late(20), with_late(20))))
    assert (found["timing, quiet"].state, found["timing, busy"].state) == (State.BAD, State.WARN)
    assert "max_rate_hz" in found["timing, quiet"].change


def test_a_loop_that_is_too_slow_says_how_slow() -> None:
    slow = replace(with_late(0), played_hz=3000.0)
    finding = by_name(judge(timing(slow, with_late(0))))["timing, quiet"]
    assert finding.state is State.BAD
    assert "Only 3000 ticks/s were made." in finding.found


@pytest.mark.parametrize(
    ("rungs", "state", "said"),
    [
        ([Rung(5000.0, 4, 5000), Rung(7000.0, 90, 7000)], State.OK, "5000 ticks/s hold, 7000 do"),
        ([Rung(2000.0, 4, 2000), Rung(5000.0, 90, 5000)], State.BAD, "Configured: 5000."),
        ([Rung(500.0, 900, 500)], State.BAD, "Not even 500 ticks/s hold."),
    ],
)
def test_the_highest_rate_is_the_last_that_held(rungs: list[Rung], state: State, said: str) -> None:
    finding = by_name(judge(timing(with_late(0), with_late(0), *rungs)))["highest rate"]
    assert finding.state is state
    assert said in finding.found


def test_advice_names_a_core_of_ones_own_where_delays_are_long(tmp_path: Path) -> None:
    facts = kernel_facts(50, sound_machine(tmp_path))
    long = timing(with_late(1), with_late(1))
    assert "isolcpus=1" in advice(long, facts)[0]
    assert advice(long, replace(facts, isolated=(1,))) == []
    assert advice(timing(with_late(0), with_late(0)), facts) == []


def test_advice_tells_who_delays_the_steps(tmp_path: Path) -> None:
    facts = kernel_facts(50, sound_machine(tmp_path))
    assert "Other programs" in advice(timing(with_late(0), with_late(50)), facts)[-1]
    fast = replace(
        timing(with_late(50), with_late(50)), duty=replace(DUTY, card=StepDirCard(motors=3))
    )
    assert "bridge" in advice(fast, facts)[-1]


def test_what_is_measured_is_what_is_configured() -> None:
    config = configured(**STEPDIR, axes={"y": {"max_rate_hz": 6000}})
    duty = duty_of(StepDirCard(motors=3), RealtimeOptions(6000.0, core=1))
    assert (duty.rate_hz, duty.motors, duty.options.core) == (6000.0, 3, 1)
    assert limit_hz(config) == 20_000
    rates = rates_to_try(limit_hz(config), duty.rate_hz)
    assert rates == sorted(set(rates))
    assert {6000.0, 20_000.0} <= set(rates)
    assert max(rates) == 20_000


def test_bins_touch_and_cover_everything() -> None:
    assert (EDGES_US[0], EDGES_US[-1]) == (0, np.inf)
    assert np.all(np.diff(EDGES_US) > 0)
    assert with_late(3, 1e7).histogram(EDGES_US).sum() == 10_000


def test_nothing_is_bad_about_a_simulated_mill(monkeypatch: pytest.MonkeyPatch) -> None:
    terrible = timing(with_late(9000), with_late(9000), Rung(500.0, 900, 5))
    monkeypatch.setattr(doctor.timing, "take", lambda *_: terrible)
    simulated = doctor.examine(configured(), 1.0, True, lambda _: None)
    assert simulated.ok
    assert by_name(list(simulated.findings))["timing, quiet"].state is State.WARN
    metal = doctor.examine(
        configured(port={"kind": "ppdev", "device": "/dev/no-such-port0"}),
        1.0,
        True,
        lambda _: None,
    )
    assert not metal.ok
