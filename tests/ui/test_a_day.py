"""The app in a real terminal, from its start to its end, and where the simulated mill stands then.

A terminal is read as it is drawn: what is waited for is words on it. What counts is what the mill
says at the end: its carriages against what the program believes, and no step lost.
"""

import json
import os
import sys
from pathlib import Path

import pytest

pytest.importorskip("pty")

from tests.terminals import Pty

#: The app as the command line makes it, and at its end a look at the mill.
SCRIPT = """
import json
from pathlib import Path
from fraese.cli.shared import Drive
from fraese.cli.theapp import make_app
on = Drive(config=Path("fraese.toml"), state=Path("state"))
plant = on.plant("paced")
app = make_app(plant, None, on)
app.run()
seen, state = plant.port.look(), plant.controller.state()
with open("end.json", "w") as file:
    json.dump({
        "code": app.exit_code,
        "position": plant.controller.position.position_steps,
        "referenced": state.referenced,
        "carriages_mm": state.carriages_mm,
        "position_mm": state.position_mm,
        "lost": seen.lost_steps,
        "currents": [(c.a_percent, c.b_percent) for c in seen.currents],
    }, file)
"""
#: Small, so that a reference run is short; slow in the program, so that a hold falls into a move.
MILL = """
[axes.x]
travel_mm = 12
[axes.y]
travel_mm = 12
[axes.z]
travel_mm = 12
"""
PART = "G21 G90\nG1 X8 F60\nG1 Y8 F60\nG1 X0 Y0 F600\nM2\n"
RIGHT, UP, SPACE, ENTER, ESCAPE, CTRL_C = b"\x1b[C", b"\x1b[A", b" ", b"\r", b"\x1b", b"\x03"


@pytest.mark.alone
def test_a_day_at_the_machine(tmp_path: Path) -> None:
    (tmp_path / "app.py").write_text(SCRIPT)
    (tmp_path / "fraese.toml").write_text(MILL)
    (tmp_path / "part.ngc").write_text(PART)
    environment = {
        **os.environ,
        "TERM": "xterm-256color",
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_STATE_HOME": str(tmp_path / "home"),
        "PYTHONPATH": os.environ.get("PYTHONPATH") or str(Path(__file__).parents[2]),
    }
    pty = Pty([sys.executable, "app.py"], tmp_path, environment, size=(40, 120))
    try:
        # It starts, and jogs: 1 mm to the right, and one up.
        pty.read_until(b"motors off")
        for key in (RIGHT, UP):
            pty.type(key)
            pty.read_until(b"machine     1.000")
        # It references all axes, when the last jog is over.
        pty.read_until(b"motors off")
        pty.type(b"r")
        pty.read_until(b"Reference: run")
        pty.type(ENTER)
        pty.read_until(b"Referenced:")
        # It opens a program, and starts it from its dialog.
        pty.type(b"o")
        pty.read_until(b"Open a program")
        pty.type(b"part.ngc")
        pty.read_until(b"part.ngc")
        pty.type(ENTER)
        pty.read_until(b"Start it with")
        pty.type(b"s")
        pty.read_until(b"Start part.ngc")
        pty.type(ENTER)
        pty.read_until(b"line 2/5")
        # It is held, goes on, is stopped in the second line that moves.
        pty.type(SPACE)
        pty.read_until(b"standing")
        pty.type(SPACE)
        pty.read_until(b"line 3/5")
        pty.type(CTRL_C)
        pty.read_until(b"Cancelled at")
        pty.type(b"q")
        assert pty.end(reading=True) == 0
    finally:
        pty.close()
    seen = json.loads((tmp_path / "end.json").read_text())
    assert seen["code"] == 0
    assert seen["referenced"] == [True, True, True]
    assert seen["lost"] == [0, 0, 0]
    assert all(current == [0, 0] for current in seen["currents"])
    # X is where its line led to, Y was stopped on its way, Z stands where it was referenced.
    x_mm, y_mm, z_mm = seen["position_mm"]
    assert (x_mm, z_mm) == (8, 0)
    assert 0 < y_mm < 8
    assert seen["carriages_mm"] == pytest.approx(seen["position_mm"], abs=0.02)
