"""Who keeps the machine from sleeping: with a stand-in for ``systemd-inhibit``."""

import os
import sys
import time
from pathlib import Path

import pytest

from fraese.assembly import drivers
from fraese.assembly import plant as plant_module
from fraese.assembly.drivers import DRIVERS, Made, Order, on_metal
from fraese.config import Config
from fraese.motor.awake import Awake

if sys.platform != "linux":
    pytest.skip("the stand-in is a shell script", allow_module_level=True)

#: Notes its arguments, and for how long it is there; then does what the real one does.
GRANTING = """#!/bin/sh
echo "$@" > "$FOLDER/asked"
while [ "$1" != "--" ]; do shift; done
shift
"$@"
echo over > "$FOLDER/over"
"""
REFUSING = "#!/bin/sh\necho 'Failed to inhibit: Access denied' >&2\nexit 1\n"


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    return {"PATH": f"{tmp_path}:{os.environ['PATH']}", "FOLDER": str(tmp_path)}


def install(folder: Path, script: str) -> None:
    command = folder / "systemd-inhibit"
    command.write_text(script)
    command.chmod(0o755)


def happens(path: Path) -> bool:
    end_s = time.monotonic() + 10
    while not path.exists() and time.monotonic() < end_s:
        time.sleep(0.01)
    return path.exists()


def test_sleep_is_forbidden_until_it_is_let_go(tmp_path: Path, environment: dict[str, str]) -> None:
    install(tmp_path, GRANTING)
    awake = Awake(environment)
    assert awake.held
    assert awake.note == "the machine does not fall asleep"
    assert "--what=sleep:idle" in (tmp_path / "asked").read_text()
    assert not (tmp_path / "over").exists()
    awake.let_go()
    awake.let_go()
    assert happens(tmp_path / "over")
    assert not awake.held


def test_who_is_refused_says_why(tmp_path: Path, environment: dict[str, str]) -> None:
    install(tmp_path, REFUSING)
    awake = Awake(environment)
    assert not awake.held
    assert awake.note.endswith("systemd-inhibit: Failed to inhibit: Access denied")
    awake.let_go()


def test_where_nobody_can_be_asked_that_is_said(tmp_path: Path) -> None:
    awake = Awake({"PATH": str(tmp_path)})
    assert not awake.held
    assert awake.note == "the machine may fall asleep: there is no systemd-inhibit"


def test_with_metal_the_machine_sleeps_only_when_all_is_closed(
    tmp_path: Path, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, GRANTING)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)

    def metal(order: Order) -> Made:
        made = DRIVERS["simulation"](order)
        return on_metal(made.driver, made.clock)

    monkeypatch.setattr(drivers, "DRIVERS", {"bridge": metal})
    plant = plant_module.assemble(Config.model_validate({"port": {"kind": "bridge"}}))
    assert plant.awake is not None
    assert plant.awake.held
    plant.close()
    assert not plant.awake.held


def test_at_a_desk_it_may_sleep() -> None:
    plant = plant_module.assemble(Config())
    assert plant.awake is None
    plant.close()
