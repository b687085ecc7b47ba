"""Free outputs: with the first tick of a block, and safe whenever the motors stand."""

import pytest

from fraese.blocks import Block, Outputs, dwell
from fraese.motor.seams import CONTROL, Ended, IdleLevel
from tests.motor.workbench import MAX_HZ, Workbench, end, line, steady

SPINDLE, LASER = 0b01, 0b10
BOTH_ON = Outputs(SPINDLE | LASER, SPINDLE | LASER)


@pytest.fixture(params=["smc", "x4step"])
def bench(request: pytest.FixtureRequest) -> Workbench:
    return Workbench(request.param, outputs=True, safe_outputs=LASER)


def test_both_on_while_moving_and_only_the_laser_off_at_the_end(bench: Workbench) -> None:
    bench.run_until_tick(10, steady(100, outputs=BOTH_ON))
    assert bench.outputs_on() == {0, 1}
    bench.run()
    assert bench.outputs_on() == {0}


def test_back_on_after_a_hold(bench: Workbench) -> None:
    bench.run_until_tick(1000, line(3000, outputs=BOTH_ON))
    bench.core.brake()
    bench.run()
    assert bench.outputs_on() == {0}
    bench.core.resume()
    bench.run_for(0.1)
    assert bench.outputs_on() == {0, 1}


@pytest.mark.parametrize("way", ["stop", "flush", "contact"])
def test_what_ended_early_does_not_switch_it_on_again(bench: Workbench, way: str) -> None:
    bench.run_until_tick(500, line(3000, outputs=BOTH_ON))
    if way == "stop":
        bench.core.stop()
    elif way == "flush":
        bench.core.brake()
        bench.run()
        bench.core.flush()
    else:
        bench.simulated.press(end("x+"))
    bench.run()
    bench.simulated.let_go(end("x+"))
    for _ in range(4):
        bench.report()
    bench.run_for(0.05, line(400))
    assert bench.outputs_on() == {0}


def test_a_safe_output_asked_for_at_standstill_waits_for_the_motors(bench: Workbench) -> None:
    mark = bench.mark()
    bench.core.set_outputs(SPINDLE | LASER, SPINDLE | LASER)
    assert bench.outputs_on() == {0}
    assert len([a for a in bench.accesses(mark) if a.register == CONTROL]) == 1
    bench.run_until_tick(5, steady(50))
    assert bench.outputs_on() == {0, 1}


def test_a_block_that_never_starts_changes_nothing(bench: Workbench) -> None:
    bench.simulated.press(end("x+"))
    report = bench.run(steady(100, outputs=BOTH_ON))
    assert report.ended is Ended.SWITCH
    bench.core.idle(IdleLevel.HOLD)
    bench.core.idle(IdleLevel.OFF)
    written = {a.value for a in bench.accesses() if a.register == CONTROL}
    off = 0b1010 if bench.wiring == "smc" else 0b0011
    assert all(value & off == off for value in written)


@pytest.mark.parametrize(
    "block", [dwell(3, 0), dwell(3, 0.5), Block((0, 0, 0), ())], ids=["no time", "dwell", "no tick"]
)
def test_alone_in_a_block(bench: Workbench, block: Block) -> None:
    report = bench.run(block._replace(outputs=Outputs(SPINDLE, SPINDLE)))
    assert report.ended is Ended.TARGET
    assert report.position_steps == (0, 0, 0)
    assert bench.outputs_on() == {0}


def test_at_full_rate_it_costs_no_time(bench: Workbench) -> None:
    plain = Workbench(bench.wiring, outputs=True)
    blocks = [line(600, exit_hz=MAX_HZ), line(600, entry_hz=MAX_HZ)]
    plain.run(*blocks)
    bench.run(blocks[0], blocks[1]._replace(outputs=BOTH_ON))
    assert bench.data_writes() == plain.data_writes()
    assert bench.clock.now_ns() == plain.clock.now_ns()


def test_all_off_at_close(bench: Workbench) -> None:
    bench.run_until_tick(10, steady(100, outputs=BOTH_ON))
    bench.core.close()
    assert bench.outputs_on() == set()
