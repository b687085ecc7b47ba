"""Whole programs on the bridge: commands, serial port, firmware, simulated mill. Time is real here,
so that only order, counts and sentences are looked at."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from fraese.assembly.survivors import KNOWN
from tests.bridge.device import reason_to_skip
from tests.bridge.stack import PATIENCE_S, SETTINGS, Stack, until_moving

pytestmark = [
    pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip()),
    pytest.mark.skipif(sys.platform != "linux", reason="a pty takes the serial port's place"),
]


@pytest.fixture
def stack(tmp_path: Path) -> Iterator[Stack]:
    stack = Stack(tmp_path)
    with stack.mill:
        yield stack


def test_homing_and_a_program_end_where_they_should(stack: Stack) -> None:
    homed = stack.run("home", "--json")
    assert homed.returncode == 0, homed.stdout + homed.stderr
    assert all(json.loads(homed.stdout)["referenced"].values())
    zero = stack.mill.carriages_steps()
    program = stack_file(
        stack, "G21 G90\nG0 X3 Y2\nG1 X3.5 Y2.5 Z-1 F600\nG2 X3.5 Y2.5 I-1 J0\nG0 X1 Y1\n"
    )
    ran = stack.run("run", str(program), "--json")
    assert ran.returncode == 0, ran.stdout + ran.stderr
    result = json.loads(ran.stdout)
    assert result["status"] == "done"
    end = stack.mill.carriages_steps()
    moved = [b - a for a, b in zip(zero, end, strict=True)]
    told = (zero, end, stack.mill.lost_steps(), homed.stdout, ran.stdout)
    assert moved == [200, 200, -200], told
    assert stack.mill.lost_steps() == (0, 0, 0)
    assert stack.mill.currents() == {(0, 0)}


def stack_file(stack: Stack, text: str) -> Path:
    path = Path(stack.device).with_name("part.ngc")
    path.write_text(text)
    return path


def test_an_interrupt_brakes_and_keeps_the_position(stack: Stack) -> None:
    process = stack.start("move", "X6", "--relative", "--feed", "300", "--json")
    until_moving(stack, 50)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, err
    result = json.loads(out)
    assert 0 < result["position_mm"]["x"] < 6
    assert stack.mill.lost_steps() == (0, 0, 0)
    assert stack.mill.currents() == {(0, 0)}


def test_a_killed_program_leaves_motors_that_brake_and_a_bridge_that_knows(stack: Stack) -> None:
    before = stack.mill.carriages_steps()
    process = stack.start("move", "X6", "--relative", "--feed", "120")
    until_moving(stack, 50)
    process.kill()
    process.communicate(timeout=PATIENCE_S)
    deadline_s = time.monotonic() + PATIENCE_S
    while stack.mill.currents() != {(0, 0)}:
        assert time.monotonic() < deadline_s, "the current stays on"
        time.sleep(0.02)
    where = stack.run("where")
    assert "the program ended while the machine moved, between X" in where.stderr
    again = stack.run("move", "Y1", "--relative", "--json")
    assert again.returncode == 0, again.stderr
    assert KNOWN in again.stderr
    result = json.loads(again.stdout)
    assert tuple(result["position_steps"].values()) == tuple(
        at - began for began, at in zip(before, stack.mill.carriages_steps(), strict=True)
    )
    assert stack.mill.lost_steps() == (0, 0, 0)
    assert KNOWN not in stack.run("move", "Y0", "--relative").stderr


def test_unplugged_in_the_middle_it_says_so_and_where(stack: Stack) -> None:
    process = stack.start("move", "X6", "--relative", "--feed", "120")
    until_moving(stack, 50)
    stack.mill.host.unplug()
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert f"{stack.device} is gone" in err
    assert "motor 1 " in err
    assert "Traceback" not in err
    stack.mill.host.plug_in()
    again = stack.run("where", "--json")
    assert again.returncode == 0, again.stderr
    assert not any(json.loads(again.stdout)["referenced"].values())


def test_a_wrong_rate_is_named_and_the_right_one_too(stack: Stack) -> None:
    said = stack.bridge("info", "--baud", "115200")
    assert said.returncode == 1
    assert "speaks 250000 baud, not 115200: write baud = 250000" in said.stderr


def test_somebody_else_has_the_port(stack: Stack) -> None:
    process = stack.start("move", "X3", "--relative", "--feed", "15")
    until_moving(stack, 20)
    said = stack.bridge("info")
    assert said.returncode == 1
    assert f"{stack.device} is in use by another program" in said.stderr
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=PATIENCE_S) is not None
    assert process.returncode == 130


def test_the_bridge_looked_at_and_tried_out(stack: Stack) -> None:
    facts = json.loads(stack.bridge("info", "--json").stdout)
    assert (facts["board"], facts["baud"], facts["protocol"]) == ("uno", 250_000, 3)
    assert facts["queue_bytes"] > 500
    assert 0 < facts["answer_ms"] <= facts["slowest_ms"]
    before = stack.mill.carriages_steps()
    tried = stack.bridge("test", "--json", "--move", "60")
    checks = {check["name"]: check["ok"] for check in json.loads(tried.stdout)}
    del checks["answers"]
    assert set(checks) >= {"greeting", "damage", "inputs", "queue", "motor X", "motor Z"}
    assert all(checks.values()), tried.stdout
    assert stack.mill.carriages_steps() == before


def test_what_a_trial_moves_is_drawn(stack: Stack) -> None:
    file = Path(stack.device).with_name("trial.vcd")
    tried = stack.bridge("test", "--move", "60", "--trace", str(file))
    # How soon it answers depends on what else this machine does.
    failed = [said for said in tried.stdout.splitlines() if said.startswith("failed")]
    assert all("answers" in said for said in failed), tried.stdout + tried.stderr
    assert tried.returncode == bool(failed)
    assert tried.stderr.startswith(f"{file}: waveform of ")
    shown = stack.fraese("trace", str(file), "--json")
    lines = json.loads(shown.stdout)["lines"]
    # Sixty half-steps there and back, and off again: seven and a half turns of the field.
    for axis in "xyz":
        assert lines[f"{axis}_coil_a"]["least"] == -100
        assert lines[f"{axis}_coil_a"]["changes"] == 120
    before = file.read_bytes()
    refused = stack.bridge("test", "--trace", str(file))
    assert refused.returncode == 2
    assert refused.stderr == ("fraese: --trace draws what --move moves: say --move STEPS too.\n")
    assert file.read_bytes() == before


def test_a_port_that_says_nothing_is_no_bridge(tmp_path: Path) -> None:
    ours, theirs = os.openpty()
    config = tmp_path / "fraese.toml"
    config.write_text(SETTINGS.format(device=os.ttyname(theirs)))
    command = [sys.executable, "-m", "fraese", "bridge", "info", "--config", str(config)]
    said = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
    os.close(ours)
    os.close(theirs)
    assert said.returncode == 1
    assert "Nobody answers on /dev/pts/" in said.stderr
    assert said.stderr.count("\n") == 1


FOUR_AXES = """
[port]
kind = "bridge"
device = "{device}"
[card]
kind = "stepdir"
[axes]
names = ["x", "y", "z", "a"]
[axes.x]
travel_mm = 8
motor = 3
[axes.y]
travel_mm = 8
inverted = true
motor = 4
[axes.z]
travel_mm = 8
motor = 1
[axes.a]
gear = "10"
motor = 2
[simulation.axes.y]
inverted = true
[simulation.axes.a]
gear = "10"
"""


def test_four_axes_whose_motors_are_swapped(tmp_path: Path) -> None:
    stack = Stack(tmp_path, FOUR_AXES)
    with stack.mill:
        zero = stack.mill.carriages_steps()
        moved = stack.run("move", "X1", "Y2", "Z-1.5", "A-90", "--json")
        assert moved.returncode == 0, moved.stdout + moved.stderr
        assert json.loads(moved.stdout)["status"] == "done"
        steps = [b - a for a, b in zip(zero, stack.mill.carriages_steps(), strict=True)]
        # The reset of the board may give a drive a stray pulse or two.
        assert steps == pytest.approx([200, -400, -300, -1000], abs=2)
