"""Motors off by the host, whatever the child was doing when it died."""

import pytest

from fraese.motor.realtime.rescue import switch_off
from fraese.motor.seams import CONTROL, DATA
from tests.motor.workbench import Workbench


@pytest.mark.parametrize("written", range(8))
def test_a_child_may_die_between_any_two_writes(written: int) -> None:
    bench = Workbench("smc")
    write = {DATA: bench.port.write_data, CONTROL: bench.port.write_control}
    full = bench.card.energise()
    for register, value in (*full, *full[:written]):
        write[register](value)
    assert all(current != (0, 0) for current in bench.currents())
    switch_off(lambda: bench.port, bench.card)
    assert set(bench.currents()) == {(0, 0)}


@pytest.mark.parametrize("wiring", ["smc", "x4step"])
def test_every_output_goes_off_though_the_host_never_saw_it_on(wiring: str) -> None:
    child = Workbench(wiring, outputs=True)
    child.core.set_outputs(0b11, 0b11)
    assert child.outputs_on() == {0, 1}
    host = Workbench(wiring, outputs=True)
    switch_off(lambda: child.port, host.card)
    assert child.outputs_on() == set()
