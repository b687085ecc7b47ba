"""A laser on a free output: off whenever the motors stand, whoever makes the steps.

The pin is looked at where it leaves the computer or the bridge, after every slice of the run loop.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from fraese.assembly import Plant, assemble, drivers
from fraese.assembly.simulation import simulated_mill
from fraese.blocks import CYCLES_PER_S, Block
from fraese.control.jobs import line_of
from fraese.control.state import Status
from fraese.motor.bridge import line as serial_line
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.recorder import Recorder
from fraese.motor.realtime import child
from fraese.motor.realtime import driver as realtime
from fraese.motor.realtime.setup import Setup
from fraese.motor.seams import CONTROL
from fraese.planner.lines import mm_per_tick
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import Chip, ChipLine
from tests.bridge.lamp import share_of
from tests.helpers import configured, merged, program, record, run_program

LASER: dict[str, Any] = {"outputs": {"laser": {"pin": 14}}}
PULSED: dict[str, Any] = {"outputs": {"laser": {"pin": 14, "pwm": True, "power_max_s": 200}}}
#: Pin 14 is bit 1 of the control register, inverted on the plug.
PIN_14 = 0b0010
TEXT = "G21 G90\nM3 S1000\nG1 X4 F600\nG1 Y3\nM5\nG0 X0\nM2\n"


class Bench(NamedTuple):
    """A machine with a laser, and its pin."""

    plant: Plant
    is_on: Callable[[], bool]


def _last_control(recorder: Recorder) -> bool:
    written = [access.value for access in recorder.accesses if access.register == CONTROL]
    return not written[-1] & PIN_14


def _simulated(monkeypatch: pytest.MonkeyPatch) -> Bench:
    made = assemble(configured(**LASER))
    recorder = record(made)
    return Bench(made, lambda: _last_control(recorder))


def _stepped_by_a_process(monkeypatch: pytest.MonkeyPatch) -> Bench:
    """The core as the step process makes it from its set-up, here."""
    config, clock = configured(**merged(LASER, {"port": {"kind": "ppdev"}})), VirtualClock()
    recorder = Recorder(simulated_mill(config, clock), clock)

    def core(setup: Setup) -> Any:
        here: Any = clock
        memory: Any = None
        core: Any = child._core(replace(setup, open_port=lambda: recorder), here, memory)
        # Without a host that may die it needs no lease.
        core.lease = lambda until_ns: None
        return core

    monkeypatch.setattr(realtime, "RealtimeDriver", core)
    _on_metal_in(clock, monkeypatch)
    return Bench(assemble(config), lambda: _last_control(recorder))


def _stepped_by_a_bridge(monkeypatch: pytest.MonkeyPatch) -> Bench:
    """The real firmware on the other end of the serial line."""
    if reason := reason_to_skip():
        pytest.skip(reason)
    chip = Chip("smc")
    chip.begin()
    monkeypatch.setattr(serial_line, "SerialLine", lambda device, baud: ChipLine(chip))
    _on_metal_in(chip, monkeypatch)
    bridge = {"port": {"kind": "bridge", "device": "/dev/ttyACM0"}}
    return Bench(
        assemble(configured(**merged(LASER, bridge))), lambda: _last_control(chip.twin.port)
    )


def _pulsed_by_a_bridge(monkeypatch: pytest.MonkeyPatch) -> tuple[Plant, Callable[[], int]]:
    """The real firmware with a laser whose power S sets, and its share now, 1/256."""
    if reason := reason_to_skip():
        pytest.skip(reason)
    chip = Chip("smc")
    chip.begin()
    monkeypatch.setattr(serial_line, "SerialLine", lambda device, baud: ChipLine(chip))
    _on_metal_in(chip, monkeypatch)
    bridge = {"port": {"kind": "bridge", "device": "/dev/ttyACM0"}}
    pulsed = merged(PULSED, {"run": {"unreferenced_percent": 100}})
    return assemble(configured(**merged(pulsed, bridge))), lambda: share_of(chip.avr)


def _on_metal_in(clock: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is metal elsewhere is simulated here, and so is its time."""
    monkeypatch.setattr(drivers, "MonotonicClock", lambda: clock)
    monkeypatch.setattr(
        drivers,
        "on_metal",
        lambda driver, its_clock, trace=None, lease=None: drivers.Made(
            driver, its_clock, 0.02, trace=trace, lease=lease
        ),
    )


BENCHES = pytest.mark.parametrize(
    "bench", [_simulated, _stepped_by_a_process, _stepped_by_a_bridge]
)


@BENCHES
def test_off_while_a_program_is_held_and_on_again_when_it_goes_on(
    bench: Callable[[pytest.MonkeyPatch], Bench], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made, is_on = bench(monkeypatch)
    controller = made.controller
    seen: list[tuple[bool, bool]] = []

    def look() -> None:
        seen.append((controller.state().held, is_on()))
        if len(seen) == 5:
            controller.hold()
        if len([held for held, _ in seen if held]) == 3:
            controller.resume()

    controller.set_break_key(look)
    assert run_program(made, program(tmp_path, TEXT)) is Status.OK
    held_from = next(n for n, (held, _) in enumerate(seen) if held)
    assert seen[4] == (False, True)
    assert {on for held, on in seen if held} == {False}
    assert (False, True) in seen[held_from:]
    assert not is_on()


@BENCHES
@pytest.mark.parametrize("way", ["cancel", "stop"])
def test_off_after_a_program_was_broken_off_and_not_on_with_the_next_jog(
    bench: Callable[[pytest.MonkeyPatch], Bench],
    way: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    made, is_on = bench(monkeypatch)
    controller = made.controller
    seen: list[bool] = []

    def look() -> None:
        seen.append(is_on())
        if len(seen) == 5:
            getattr(controller, way)()

    controller.set_break_key(look)
    assert run_program(made, program(tmp_path, TEXT)) is Status.CANCEL
    assert seen[4]
    assert not is_on()
    controller.acknowledge()
    jogged: list[bool] = []
    controller.set_break_key(lambda: jogged.append(is_on()))
    controller.jog("y", 1)
    assert controller.run() is Status.OK
    assert set(jogged) == {False}


def test_off_on_the_way_to_a_line_and_on_from_there(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made, is_on = _simulated(monkeypatch)
    seen: list[tuple[tuple[float, ...], bool]] = []
    made.controller.set_show_pos(
        lambda: seen.append((made.controller.state().position_mm, is_on()))
    )
    text = "G21 G90\nG1 Z-2 F600\nM3 S1000\nG1 X4\nG1 Y3\nX8\nM5\nM2\n"
    assert run_program(made, program(tmp_path, text), from_line=6) is Status.OK
    on = [where for where, burns in seen if burns]
    assert min(x for x, _, _ in on) >= 4
    assert {(y, z) for _, y, z in on} == {(3, -2)}
    assert max(x for x, _, _ in on) > 7


def _burnt(
    made: Bench, folder: Path, text: str
) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Places at which it burnt, and at which it did not."""
    places: dict[bool, list[tuple[float, ...]]] = {True: [], False: []}

    def look() -> None:
        places[made.is_on()].append(made.plant.controller.state().position_mm)

    made.plant.controller.set_show_pos(look)
    status = run_program(made.plant, program(folder, text))
    assert status is Status.OK, made.plant.controller.state().message
    return places[True], places[False]


@BENCHES
def test_s0_is_off_and_so_is_a_rapid(
    bench: Callable[[pytest.MonkeyPatch], Bench], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = (
        "G21 G90\nM4 S0\nG0 X4\nG1 X8 S500 F600\nG0 X12\nG1 X16\nS0\nG1 X20\n"
        "S500\nG1 X24\nM5\nG1 X28\nM2\n"
    )
    on, off = _burnt(bench(monkeypatch), tmp_path, text)
    burnt = {int(x / 4) for x, _, _ in on if 1 < x % 4 < 3}
    dark = {int(x / 4) for x, _, _ in off if 1 < x % 4 < 3}
    assert burnt == {1, 3, 5}
    assert dark >= {0, 2, 4, 6}


def test_a_beam_without_any_s_word_is_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    on, _ = _burnt(_simulated(monkeypatch), tmp_path, "G21 G90\nM3\nG1 X9 F600\nM2\n")
    assert max(x for x, _, _ in on) > 8


def test_no_step_is_lost_where_a_beam_changes_among_merged_points(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made = _simulated(monkeypatch)
    lines = "".join(f"G1 X{n / 10} S{n % 2 * 9}\n" for n in range(1, 60))
    _burnt(made, tmp_path, f"G21 G90 G64 P0.1 F900\nM3 S9\n{lines}M2\n")
    assert made.plant.controller.state().position_mm[0] == 5.9


def test_a_spindle_with_s0_is_off(tmp_path: Path) -> None:
    made = assemble(configured(outputs={"spindle": {"pin": 14}}))
    recorder = record(made)
    bench = Bench(made, lambda: _last_control(recorder))
    text = "G21 G90\nM3 S0\nG1 X10 F1000\nS900\nG1 X20\nS800\nG1 X30\nS0\nG1 X40\nM2\n"
    on, off = _burnt(bench, tmp_path, text)
    assert {round(x) // 10 for x, _, _ in on if 1 < x % 10 < 9} == {1, 2}
    assert {round(x) // 10 for x, _, _ in off if 1 < x % 10 < 9} == {0, 3}


def test_s_sets_the_power_on_a_bridge(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """M3 and M4 as S says where the feed is reached; nothing along rapids and at the end."""
    plant, share = _pulsed_by_a_bridge(monkeypatch)
    controller = plant.controller
    seen: list[tuple[float, int]] = []
    controller.set_show_pos(lambda: seen.append((controller.state().position_mm[0], share())))
    text = (
        "G21 G90\nM3 S100\nG1 X8 F600\nS50\nG1 X16\nG0 X24\nM4 S400\nG1 X32\nS20\nG1 X40\nM5\n"
        "G1 X48\nM2\n"
    )
    assert run_program(plant, program(tmp_path, text)) is Status.OK, controller.state().message
    within = {
        part: {share for x, share in seen if part * 8 + 2 < x < part * 8 + 6} for part in range(6)
    }
    assert within[0] == {129}
    assert within[1] == {65}
    assert within[2] == {0}
    assert max(within[3]) > 250
    assert max(within[4]) == pytest.approx(26, abs=1)
    assert within[5] == {0}
    assert share() == 0


@pytest.mark.parametrize("word", ["M3", "M4"])
def test_what_is_planned_has_the_energy_of_its_millimetres(
    word: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """M4: whatever the ramps, every mm gets what it gets at F; M3: power times time."""
    made = assemble(configured(**PULSED))
    text = f"G21 G90\n{word} S100\nG1 X9 Y2 F700\nG3 X5 Y6 I-4 J0\nG1 X5.2\nG1 Y7 F90\nM5\nM2\n"
    pushed: list[Block] = []
    push = MotorCore.push

    def noted(core: MotorCore, block: Block) -> bool:
        pushed.append(block)
        return push(core, block)

    monkeypatch.setattr(MotorCore, "push", noted)
    assert run_program(made, program(tmp_path, text)) is Status.OK
    lit = [block for block in pushed if block.power.share]
    assert len(lit) > 4
    assert {block.power.share for block in lit} == {128}
    for block in lit:
        length_mm = mm_per_tick(block.weight) * block.ticks()
        if word == "M3":
            assert block.power.at_cycles == 0
            continue
        feed_mm_min = 90 if line_of(block.tag) == 6 else 700
        per_tick_s = length_mm / block.ticks() / (feed_mm_min / 60)
        assert block.power.at_cycles == pytest.approx(per_tick_s * CYCLES_PER_S, rel=0.01)


def test_without_an_s_word_there_is_no_power(tmp_path: Path) -> None:
    made = assemble(configured(outputs={"laser": {"pin": 14, "pwm": True}}))
    recorder = record(made)
    bench = Bench(made, lambda: _last_control(recorder))
    on, _ = _burnt(bench, tmp_path, "G21 G90\nM3\nG1 X9 F600\nS1\nG1 X18\nM2\n")
    assert min(x for x, _, _ in on) >= 9
    assert max(x for x, _, _ in on) > 17


@pytest.mark.parametrize(
    ("pwm", "told"),
    [(True, [(1, 50.0), (-1, 100.0), (0, 100.0)]), (False, [(1, None), (-1, None)])],
)
def test_it_is_told_how_much_of_its_power_it_has(
    pwm: bool, told: list[tuple[int, float | None]], tmp_path: Path
) -> None:
    made = assemble(configured(outputs={"laser": {"pin": 14, "pwm": pwm, "power_max_s": 200}}))
    seen: list[tuple[int, float | None]] = []

    def look() -> None:
        cutting = made.controller.state().cutting
        if cutting.is_laser:
            seen.append((cutting.direction, cutting.power_percent))

    made.controller.set_show_pos(look)
    text = "G21 G90\nM3 S100\nG1 X8 F600\nM4 S400\nG1 X16\nM5\nG1 X24\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert list(dict.fromkeys(seen))[: len(told)] == told
