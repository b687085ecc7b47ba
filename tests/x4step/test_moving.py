"""Motions on a simulated port, judged by the lines that were recorded."""

from collections.abc import Callable, Iterator
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.x4step import (
    SIGNAL1OFF,
    SIGNAL1ON,
    SIGNAL2OFF,
    SIGNAL2ON,
    X4Brake,
    X4BrakeCodes,
    X4ClearTimer,
    X4GetIn,
    X4GetState,
    X4GetSteps,
    X4GetTimer,
    X4Init,
    X4LastBrakeCode,
    X4Load,
    X4MoveNeg,
    X4MovePos,
    X4ReInit,
    X4SetOut,
    X4Start,
    X4Step,
    X4Stop,
)
from fraese.x4step.testing import (
    ACTIVE_PIN,
    BOOST_PIN,
    INPUT_BITS,
    Lab,
    clock_pin,
    direction_pin,
    simulation,
)

AXES = (1, 2, 3, 4)
MS = 1_000_000
US = 1_000
CYCLE_NS = 63
Way = tuple[int, int, int, int]


@pytest.fixture
def lab() -> Iterator[Lab]:
    with simulation() as lab:
        assert X4Init(2) == 0
        yield lab
        X4Stop()
        X4ReInit()


def wait() -> None:
    while X4GetState():
        pass


def drive(way: Way, freq: int, ramp: int) -> None:
    assert X4Load(*way, freq, ramp) == 0
    assert X4Start() == 0
    assert X4GetState() > 0
    wait()


def counted() -> tuple[int, ...]:
    return tuple(X4GetSteps(axis) for axis in AXES)


def on_lines(lab: Lab) -> tuple[int, ...]:
    lines = lab.lines()
    return tuple(lines.steps(axis) for axis in AXES)


def gaps_ns(lab: Lab, axis: int) -> list[int]:
    return [b - a for a, b in pairwise(lab.lines().rises(clock_pin(axis)))]


# --- paths ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("leader", AXES)
def test_the_longest_axis_leads_with_the_rate_asked_for(lab: Lab, leader: int) -> None:
    way = [700, -500, 300, -100]
    way[leader - 1] = 1000
    drive((way[0], way[1], way[2], way[3]), 2000, 50)
    assert on_lines(lab) == tuple(way) == counted()
    fastest = min(gaps_ns(lab, leader))
    assert fastest == pytest.approx(1e9 / 2000, rel=0.002)
    assert all(min(gaps_ns(lab, axis)) >= fastest for axis in AXES)


def test_all_start_and_stop_together_on_the_line(lab: Lab) -> None:
    drive((1000, 800, -600, 1), 1000, 50)
    lines = lab.lines()
    ticks = lines.rises(clock_pin(1))
    made = dict.fromkeys(AXES, 0)
    rises = {axis: set(lines.rises(clock_pin(axis))) for axis in AXES}
    for done, at_ns in enumerate(ticks, 1):
        for axis, total in zip(AXES, (1000, 800, 600, 1), strict=True):
            made[axis] += at_ns in rises[axis]
            assert abs(made[axis] - total * done / 1000) <= 1
    assert set().union(*rises.values()) == set(ticks)


def test_preloaded_there_and_back(lab: Lab) -> None:
    assert X4Load(1000, 800, 600, 400, 1000, 50) == 0
    assert X4Start() == 0
    assert X4Load(-1000, -800, -600, -400, 1000, 50) == 0
    wait()
    assert counted() == (1000, 800, 600, 400)
    assert X4Start() == 0
    wait()
    assert counted() == (-1000, -800, -600, -400)
    assert on_lines(lab) == (0, 0, 0, 0)


def test_a_preloaded_path_begins_at_once(lab: Lab) -> None:
    drive((100, 0, 0, 0), 1000, 0)
    X4Load(100, 0, 0, 0, 1000, 0)
    start_ns = lab.now_ns()
    X4Start()
    wait()
    first_ns = next(at for at in lab.lines().rises(clock_pin(1)) if at > start_ns)
    assert first_ns - start_ns <= max(100 * US, MS)


def test_steps_are_those_since_the_last_start(lab: Lab) -> None:
    drive((10, -20, 0, 0), 1000, 0)
    X4Load(0, 0, 0, 30, 1000, 0)
    assert counted() == (10, -20, 0, 0)
    assert X4Start() == 0
    assert counted() == (0, 0, 0, 0)
    assert X4Start() == 10
    wait()
    assert counted() == (0, 0, 0, 30)
    assert X4Start() == 11
    assert counted() == (0, 0, 0, 30)
    assert X4MovePos(1, 1000, 0) == 0
    assert counted() == (0, 0, 0, 0)


def test_steps_and_state_are_those_of_the_lines_at_every_moment(lab: Lab) -> None:
    X4Load(300, -200, 0, 7, 1000, 50)
    X4Start()
    last = 0
    while True:
        state, steps = X4GetState(), counted()
        lines = lab.lines()
        assert bool(state) == lines.level(ACTIVE_PIN)
        assert steps == tuple(lines.steps(axis) for axis in AXES)
        assert steps[0] >= last
        last = steps[0]
        if not state:
            break
    assert last == 300


@given(
    way=st.tuples(*[st.integers(-40, 40)] * 4).filter(any),
    freq=st.integers(10, 20_000),
    ramp=st.integers(0, 60),
    after_ms=st.floats(0, 60),
    end=st.sampled_from([X4Brake, X4Stop, None]),
)
def test_what_is_counted_was_made_however_it_ends(
    way: Way, freq: int, ramp: int, after_ms: float, end: Callable[[], int] | None
) -> None:
    with simulation() as lab, X4Step(1) as motors:
        motors.load(way, freq, min(ramp, freq))
        motors.start()
        if end:
            cut = motors.brake if end is X4Brake else motors.stop

            def act() -> None:
                if motors.facts.moving:
                    cut()

            lab.at_ms(after_ms, act)
        motors.wait()
        assert on_lines(lab) == motors.facts.steps
        lines = lab.lines()
        assert not any(lines.level(pin) for pin in (BOOST_PIN, ACTIVE_PIN))
        assert not any(lines.level(clock_pin(axis)) for axis in AXES)
        if end is None:
            assert motors.facts.steps == way
        # Nothing of it is left: the next path is driven whole.
        motors.load((3, 0, 0, 0), 1000, 0)
        motors.start()
        motors.wait()
        assert motors.facts.steps == (3, 0, 0, 0)


@given(st.integers(1, 30), st.integers(10, 20_000), st.integers(0, 1000))
def test_no_pulse_and_no_pause_is_shorter_than_25_us(steps: int, freq: int, ramp: int) -> None:
    with simulation() as lab, X4Step(1) as motors:
        for sign in (1, -1):
            motors.load((sign * steps, steps // 2, 0, 0), freq, min(ramp, freq))
            motors.start()
            motors.wait()
        for axis in (1, 2):
            edges = lab.lines().edges(clock_pin(axis))[1:]
            assert all(b.at_ns - a.at_ns >= 25 * US for a, b in pairwise(edges))


def test_directions_stand_100_us_before_the_first_step_and_until_the_end(lab: Lab) -> None:
    for way in ((20, -10, 0, 5), (-20, 10, -3, -5)):
        begin_ns = lab.now_ns()
        drive(way, 20_000, 0)
        lines = lab.lines()
        first_ns = next(at for at in lines.rises(clock_pin(1)) if at > begin_ns)
        for axis, steps in zip(AXES, way, strict=True):
            if steps:
                assert lines.level(direction_pin(axis)) == (steps > 0)
                changed = [e.at_ns for e in lines.edges(direction_pin(axis)) if e.at_ns >= begin_ns]
                assert all(at <= first_ns - 100 * US for at in changed)


def test_active_is_high_once_a_motion_from_before_the_first_step_to_the_last(lab: Lab) -> None:
    drive((50, 0, 0, 0), 1000, 20)
    lines = lab.lines()
    (up,), (down,) = lines.rises(ACTIVE_PIN), lines.falls(ACTIVE_PIN)
    assert up < lines.rises(clock_pin(1))[0]
    assert down >= lines.falls(clock_pin(1))[-1]


# --- endless, brake, stop ------------------------------------------------------------------------


@pytest.mark.parametrize(("move", "sign"), [(X4MovePos, 1), (X4MoveNeg, -1)])
@pytest.mark.parametrize("axis", AXES)
def test_an_endless_move(
    lab: Lab, move: Callable[[int, int, int], int], sign: int, axis: int
) -> None:
    assert move(axis, 1000, 50) == 0
    while abs(X4GetSteps(axis)) < 400:
        pass
    assert X4GetState() > 0
    assert X4Brake() == 0
    wait()
    made = X4GetSteps(axis)
    assert made == lab.lines().steps(axis)
    assert 415 < sign * made < 440
    assert [made if each == axis else 0 for each in AXES] == list(counted())


def test_braking_after_half_a_second_is_500_steps(lab: Lab) -> None:
    X4MovePos(1, 1000, 50)
    X4ClearTimer()
    while X4GetTimer() < 500:
        pass
    assert X4GetTimer() == pytest.approx(500, abs=1)
    assert X4Brake() == 0
    assert X4ReInit() == 0
    assert lab.lines().steps(1) == pytest.approx(500, abs=10)
    assert not any(lab.lines().level(pin) for pin in (1, 14, 16, 17))


@pytest.mark.parametrize(("freq", "ramp"), [(1000, 50), (1000, 1000), (5000, 200), (500, 500)])
def test_braking_is_a_ramp(lab: Lab, freq: int, ramp: int) -> None:
    X4MovePos(1, freq, ramp)
    while X4GetTimer() < ramp + 200:
        pass
    begin_ns = lab.now_ns()
    X4Brake()
    wait()
    lines = lab.lines()
    rises = [at for at in lines.rises(clock_pin(1)) if at >= begin_ns]
    gaps = [b - a for a, b in pairwise(rises)]
    # To the cycle, which a nanosecond is not.
    assert all(b >= a - CYCLE_NS for a, b in pairwise(gaps))
    assert 0.6 * ramp * MS < lines.falls(clock_pin(1))[-1] - begin_ns < 1.3 * ramp * MS
    assert X4GetSteps(1) == len(lines.rises(clock_pin(1)))


@pytest.mark.parametrize("freq", [10, 999, 1000, 1001, 20_000])
def test_braking_without_a_ramp_is_at_once(lab: Lab, freq: int) -> None:
    X4MovePos(1, freq, 0)
    while X4GetTimer() < 300:
        pass
    begin_ns = lab.now_ns()
    X4Brake()
    wait()
    assert len([at for at in lab.lines().rises(clock_pin(1)) if at >= begin_ns]) <= 1


def test_a_stop_is_without_a_ramp_and_cuts_no_pulse(lab: Lab) -> None:
    X4MovePos(1, 10_000, 100)
    while X4GetTimer() < 200:
        pass
    begin_ns = lab.now_ns()
    assert X4Stop() == 0
    wait()
    lines = lab.lines()
    assert lines.falls(clock_pin(1))[-1] - begin_ns <= 100 * US
    edges = lines.edges(clock_pin(1))[1:]
    assert min(b.at_ns - a.at_ns for a, b in pairwise(edges)) >= 25 * US
    assert not lines.level(ACTIVE_PIN)
    assert not lines.level(BOOST_PIN)
    assert X4Stop() == 7


def test_a_stop_is_at_once_also_after_ctrl_c(lab: Lab, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> list[int]:
        raise KeyboardInterrupt

    X4MovePos(1, 1000, 50)
    with monkeypatch.context() as patch:
        patch.setattr(lab.keys, "codes", interrupted)
        with pytest.raises(KeyboardInterrupt):
            wait()
    assert X4Stop() == 0
    assert X4GetState() == 0


def test_a_stop_while_braking(lab: Lab) -> None:
    X4MovePos(1, 1000, 1000)
    while X4GetTimer() < 1100:
        pass
    X4Brake()
    for _ in range(100):
        X4GetState()
    begin_ns = lab.now_ns()
    assert X4GetState() > 0
    assert X4Stop() == 0
    wait()
    assert lab.lines().falls(clock_pin(1))[-1] - begin_ns <= 2 * MS


@pytest.mark.parametrize("after_ms", [1003, 1010, 1025, 1040, 1045])
def test_a_brake_in_the_paths_own_ramp_changes_nothing(lab: Lab, after_ms: int) -> None:
    X4Load(1000, 0, 0, 0, 1000, 50)
    X4Start()
    lab.at_ms(after_ms, X4Brake)
    wait()
    assert X4GetSteps(1) == 1000
    drive((5, 0, 0, 0), 1000, 0)
    assert X4GetSteps(1) == 5


@pytest.mark.parametrize("end", [X4Brake, X4Stop])
def test_a_brake_before_the_first_step(lab: Lab, end: Callable[[], int]) -> None:
    X4Load(100, 0, 0, 0, 10, 0)
    X4Start()
    assert end() == 0
    wait()
    assert X4GetSteps(1) == lab.lines().steps(1) <= 1
    drive((5, 0, 0, 0), 1000, 0)
    assert X4GetSteps(1) == 5


@pytest.mark.parametrize("end", [X4Brake, X4Stop])
def test_a_loaded_path_outlives_what_ends_the_present_one(lab: Lab, end: Callable[[], int]) -> None:
    X4MovePos(1, 1000, 50)
    X4Load(0, 0, 77, 0, 1000, 50)
    assert end() == 0
    wait()
    assert X4Load(1, 0, 0, 0, 1000, 50) == 12
    assert X4Start() == 0
    wait()
    assert counted() == (0, 0, 77, 0)


def test_an_endless_move_does_not_stumble_at_a_seam(
    lab: Lab, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fraese.x4step.paths.ENDLESS_TICKS", 50)
    X4MovePos(1, 20_000, 0)
    while X4GetSteps(1) < 5000:
        pass
    X4Stop()
    assert set(gaps_ns(lab, 1)) == {50 * US}


def test_reinit_finishes_the_ramp_and_then_all_is_off(lab: Lab) -> None:
    X4SetOut(SIGNAL1ON)
    X4MovePos(1, 1000, 100)
    while X4GetTimer() < 300:
        pass
    assert X4ReInit() == 0
    lines = lab.lines()
    assert lines.falls(clock_pin(1))[-1] > 360 * MS
    assert not any(lines.level(pin) for pin in (1, 3, 14, 16, 17))


# --- keys ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("codes", "pressed", "told"),
    [([], [1], 1), ([28], [28], 28), ([28], [1], 1), ([28], [156, 57, 28], 28), ([203], [203], 203),
     ([28, 57], [57, 28], 57), ([28, 0, 57], [57, 1], 1)],
)  # fmt: skip
def test_keys_brake_and_the_first_one_is_told(
    lab: Lab, codes: list[int], pressed: list[int], told: int
) -> None:
    assert X4BrakeCodes(codes) == 0
    X4MovePos(1, 1000, 50)
    while X4GetTimer() < 200:
        pass
    assert X4LastBrakeCode() == 0
    for code in pressed:
        lab.press(code)
    wait()
    assert X4LastBrakeCode() == told
    assert lab.lines().falls(clock_pin(1))[-1] > 240 * MS
    X4MovePos(1, 1000, 50)
    assert X4LastBrakeCode() == 0


@pytest.mark.parametrize("code", [129, 28, 156, 57, 2])
def test_other_keys_do_not_brake(lab: Lab, code: int) -> None:
    X4MovePos(1, 1000, 50)
    lab.press(code)
    for _ in range(300):
        X4GetState()
    assert X4GetState() > 0


def test_a_new_list_replaces_the_old_one_and_a_refused_one_does_not(lab: Lab) -> None:
    X4BrakeCodes([28])
    X4BrakeCodes(bytes(range(100, 121)))
    X4MovePos(1, 1000, 50)
    lab.press(28)
    wait()
    assert X4LastBrakeCode() == 28
    X4BrakeCodes([57])
    X4MovePos(1, 1000, 50)
    lab.press(28)
    for _ in range(300):
        X4GetState()
    assert X4GetState() > 0


def test_no_key_is_told_after_a_brake_by_call(lab: Lab) -> None:
    X4MovePos(1, 1000, 50)
    for _ in range(100):
        X4GetState()
    X4Brake()
    lab.press(1)
    wait()
    assert X4LastBrakeCode() == 0


def test_what_was_pressed_before_the_start_brakes_nothing(lab: Lab) -> None:
    lab.press(1)
    drive((100, 0, 0, 0), 1000, 50)
    assert X4GetSteps(1) == 100


# --- timer, inputs, signals ----------------------------------------------------------------------


def test_the_timer_counts_in_motion_and_at_standstill(lab: Lab) -> None:
    assert X4GetTimer() == 0
    while X4GetTimer() < 50:
        pass
    assert lab.now_ns() == pytest.approx(50 * MS, abs=MS)
    X4MovePos(1, 1000, 50)
    while X4GetTimer() < 150:
        pass
    X4Stop()
    begin_ns = lab.now_ns()
    X4ClearTimer()
    assert X4GetTimer() == 0
    while X4GetTimer() < 70:
        pass
    assert (lab.now_ns() - begin_ns) // MS == 70


def test_the_timer_takes_no_notice_of_motions(lab: Lab) -> None:
    begin_ns = lab.now_ns()
    for end in (X4Brake, X4Stop):
        X4MovePos(1, 1000, 50)
        for _ in range(100):
            X4GetState()
        end()
        wait()
        drive((20, 0, 0, 0), 1000, 0)
        assert X4GetTimer() == pytest.approx((lab.now_ns() - begin_ns) / MS, abs=1)
    assert X4GetTimer() > 200


@pytest.mark.parametrize("freq", [0, 10, 1000, 20_000])
def test_inputs_are_the_levels_of_their_pins(lab: Lab, freq: int) -> None:
    """Thirty milliseconds after a change at the latest, however far apart the steps are."""
    if freq:
        X4MovePos(1, freq, 0)

    def settled() -> int:
        begin_ns = lab.now_ns()
        while lab.now_ns() < begin_ns + 29 * MS:
            X4GetIn()
        return X4GetIn()

    assert settled() == 31
    for value in (0, 31, 0b10101, 0b01010, *(1 << bit for bit in range(5))):
        lab.set_inputs(value)
        assert settled() == value
    for pin, bit in INPUT_BITS.items():
        lab.set_inputs(0)
        lab.set_pin(pin, True)
        assert settled() == 1 << bit


def test_inputs_stop_nothing(lab: Lab) -> None:
    X4Load(1000, 0, 0, 0, 2000, 50)
    X4Start()
    level = 0
    while X4GetState():
        level = 31 - level
        lab.set_inputs(level)
    assert counted() == (1000, 0, 0, 0)


@pytest.mark.parametrize("moving", [False, True])
def test_signals_are_the_programs_own(lab: Lab, moving: bool) -> None:
    if moving:
        X4MovePos(1, 1000, 50)
    for on, off, pin in ((SIGNAL1ON, SIGNAL1OFF, 1), (SIGNAL2ON, SIGNAL2OFF, 14)):
        other = 15 - pin
        assert X4SetOut(on) == 0
        assert lab.lines().level(pin)
        assert not lab.lines().level(other)
        assert X4SetOut(off) == 0
        assert not lab.lines().level(pin)


def test_motion_does_not_touch_the_signals(lab: Lab) -> None:
    X4SetOut(SIGNAL1ON)
    X4SetOut(SIGNAL2ON)
    drive((100, 0, 0, 0), 1000, 50)
    X4MovePos(1, 1000, 50)
    X4Brake()
    wait()
    X4MovePos(1, 1000, 50)
    X4Stop()
    wait()
    for pin in (1, 14):
        assert lab.lines().falls(pin) == []
        assert lab.lines().level(pin)


def test_a_signal_costs_no_step_its_time(lab: Lab) -> None:
    X4MovePos(1, 20_000, 0)
    for count in range(50):
        X4GetState()
        X4SetOut(1 + count % 2)
    X4Stop()
    assert set(gaps_ns(lab, 1)) == {50 * US}
    assert len(lab.lines().edges(1)) > 40


def test_init_writes_no_step_and_leaves_the_control_lines_low(lab: Lab) -> None:
    lines = lab.lines()
    assert not any(lines.rises(clock_pin(axis)) for axis in AXES)
    assert not any(lines.level(pin) for pin in (1, 14, 16, 17))
    assert [value for register, value in lab.recorder().writes() if register == 2][-1] == 0x0B
