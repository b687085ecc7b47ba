"""The view Bench: what is on the wires, and a motor turned step by step."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest

from fraese.assembly import assemble
from fraese.control.benchfacts import Access, MotorFacts
from fraese.control.slowmotion import turn_slowly
from fraese.errors import LimitError, StateError
from fraese.motor.seams import DATA
from fraese.ui import FraeseApp
from fraese.ui.widgets import lamps
from fraese.ui.widgets.fact import Paragraph
from tests.helpers import configured, look, plant
from tests.ui.helpers import Bench, open_nothing, play


@asynccontextmanager
async def opened(size: tuple[int, int] = (120, 40), **sections: Any) -> AsyncIterator[Bench]:
    made = assemble(configured(**sections))
    app = FraeseApp(made.controller, open_program=open_nothing, hand=made.press, bench=made.bench)
    async with app.run_test(size=size) as pilot:
        b = Bench(app, made, pilot)
        await b.press("f5")
        await b.settled()
        yield b


def seen(b: Bench) -> str:
    return b.app.view.query_one("#bench-text", Paragraph).text


async def done(b: Bench, *keys: str) -> None:
    for key in keys:
        await b.press(key)
        await b.settled()


def test_a_single_step_there_and_back_and_a_turn_in_slow_motion() -> None:
    async def scene() -> None:
        async with opened() as b:
            assert "▶ X  0/8 1B" in seen(b)
            assert "table motrun  [0:03]  1:09" in seen(b)
            await done(b, "right", "right", "right")
            assert "[3:29]" in seen(b)
            assert b.moved_steps == (3, 0, 0)
            await done(b, "left", "down", "pageup", "s", "s", "left")
            assert b.moved_steps == (2, 7, 0)
            assert "slow motion 2 steps/s" in seen(b)
            assert "▶ Y  7/8" in seen(b)
            assert "accesses in" in seen(b), "the lines as they were played"
            assert b.mill.look().lost_steps == (0, 0, 0)
            await b.press("f2")
            await b.wait(lambda: not b.plant.controller._driver.run.wires.is_tapped)  # type: ignore[attr-defined]

    play(scene)


def test_hands_at_the_simulated_mill() -> None:
    async def scene() -> None:
        async with opened((80, 24)) as b:
            await done(b, "x")
            assert "xmin pressed" in seen(b)
            await b.wait(lambda: b.drawn.switch_closed)
            await done(b, "x", "b")
            assert "HELD" in seen(b)
            await done(b, "pageup")
            assert b.moved_steps == (0, 0, 0)
            assert b.drawn.lost_steps[0] == 8
            await done(b, "b", "p")
            assert "driven by field-60" in b.app.view.said[0]
            await done(b, "pageup")
            assert "table field-60" in seen(b)
            assert b.moved_steps == (8, 0, 0), "the same steps by the other table"
            view = b.app.view
            assert view.query_one("#bench").max_scroll_y == 0, "all of it is seen at 80x24"

    play(scene)


@pytest.mark.parametrize("size", [(200, 60), (80, 24), (20, 5)])
def test_drives_of_their_own_at_every_size(size: tuple[int, int]) -> None:
    async def scene() -> None:
        async with opened(size, card={"kind": "stepdir"}) as b:
            await done(b, "right", "p")
            assert "phase tables of their own" in seen(b)
            assert "card.table in the configuration" in b.app.view.said[0]
            assert ("○ field   ● rotor" in seen(b)) == (size[1] > 40)

    play(scene)


def test_without_a_bench_it_says_so() -> None:
    async def scene() -> None:
        made = plant()
        app = FraeseApp(made.controller, open_program=open_nothing)
        async with app.run_test() as pilot:
            b = Bench(app, made, pilot)
            await done(b, "f5", "x", "b", "p")
            assert "not open" in seen(b)
            assert "card.table" in app.view.said[0]

    play(scene)


class TestWorkbench:
    def test_bytes_are_those_on_the_pins_and_currents_those_of_the_coils(self) -> None:
        made = plant(standstill={"delay_s": 100})
        bench = made.bench
        assert bench is not None
        turn_slowly(made.controller, "y", 3, 50)
        made.controller.run()
        facts = bench.look()
        assert (facts.data, facts.is_seen) == (0x69, True)
        y = facts.motors[1]
        assert (y.phase, y.latched, y.a_percent, y.b_percent) == (3, 0x69, 60, -60)
        assert y.field == y.rotor == 3 / 8
        assert look(made).currents[1] == (60, -60)

    def test_listening_costs_nothing_before_and_after(self) -> None:
        made = plant()
        bench = made.bench
        assert bench is not None
        wires = made.controller._driver.run.wires  # type: ignore[attr-defined]
        before = wires.access
        turn_slowly(made.controller, "x", 2, 50)
        made.controller.run()
        assert bench.lines() == ()
        assert bench.listen(True)
        turn_slowly(made.controller, "x", 2, 50)
        made.controller.run()
        played = [each.value for each in bench.lines() if each.register == DATA]
        assert played[-5:-3] == [0x29, 0x27], "then the current goes off"
        bench.listen(False)
        assert bench.lines() == ()
        assert wires.access == before

    def test_another_table_goes_on_at_the_nearest_entry(self) -> None:
        made = plant()
        bench = made.bench
        assert bench is not None
        assert bench.tables == ("motrun", "field-60", "field-20")
        for name in ("field-60", "field-20", "motrun"):
            for steps in (5, -3, 16):
                turn_slowly(made.controller, "x", steps, 50)
                made.controller.run()
            bench.choose_table(name)
        assert made.controller.state().position_steps[0] == 54
        assert look(made).carriages_steps[0] == 30_000 + 54
        assert look(made).lost_steps == (0, 0, 0)
        with pytest.raises(StateError, match=r"card\.table in the configuration"):
            bench.choose_table("full-step")

    def test_slow_motion_keeps_to_the_limits(self) -> None:
        made = plant(axes={"x": {"travel_mm": 20}})
        for steps, rate_hz in ((0, 10), (1, 0), (10_000, 10)):
            with pytest.raises(LimitError):
                turn_slowly(made.controller, "x", steps, rate_hz)


def test_lamps_bars_and_waves() -> None:
    motor = MotorFacts("x", 3, 0x29, -60, 100, 0.5, 0.25)
    assert lamps.bar(-60, 5) == "  ███│     "
    assert lamps.bar(100, 5) == "     │█████"
    assert lamps.bar(0, 2) == "  │  "
    assert "A -60" in lamps.motor_line(motor, 8, True, 80)
    assert "field ← rotor ↑" in lamps.motor_line(motor, 8, True, 80)
    assert lamps.dial(motor)[0].strip() == "●"
    assert lamps.dial(motor)[2].startswith("○")
    heard = [Access(n * 100, DATA, n & 1) for n in range(9)]
    *_, d0, _, _ = lamps.waves(heard, 13, 11)
    assert d0.startswith("D0  ")
    assert set(d0[5:]) <= set("│▒▁▔")
    assert lamps.waves([], 80, 9)[0].startswith("Nothing was played")
