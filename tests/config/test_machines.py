"""The example machines: their files are whole, and each one moves as it is configured."""

from pathlib import Path

import pytest

from fraese.assembly import assemble
from fraese.config import Config, machines
from fraese.config.file import load
from fraese.config.wiring import PortConfig
from fraese.errors import UsageError
from fraese.motor.ports.sim import SimulatedMill
from fraese.program.program import open_program

EXAMPLES = Path(__file__).parents[2] / "examples" / "machines"


def test_every_example_machine_has_its_file() -> None:
    assert {file.stem for file in EXAMPLES.glob("*.toml")} == set(machines.names())


@pytest.mark.parametrize("name", machines.names())
def test_the_file_is_the_machine_with_every_key(name: str) -> None:
    file = EXAMPLES / f"{name}.toml"
    assert file.read_text("utf-8") == machines.whole(name), "fraese config init writes it anew"
    config = load(file)
    assert config == machines.config_of(name)
    assert not assemble(config, at_desk=True).notes
    assert len(machines.about(name)) > 40


@pytest.mark.parametrize("name", machines.names())
def test_each_references_and_runs_a_program(name: str, tmp_path: Path) -> None:
    config = machines.config_of(name).model_copy(update={"port": PortConfig()})
    plant = assemble(Config.model_validate(config.model_dump(exclude_unset=True)))
    controller = plant.controller
    linear = [axis for axis in config.axes.names if axis in "xyz"]
    way = " ".join(f"{axis.upper()}{5 if axis != 'z' else -5}" for axis in linear)
    turn = "G1 A90 F3600\n" if "a" in config.axes.names else ""
    part = tmp_path / "part.ngc"
    part.write_text(f"G21 G90\nM3 S500\nG1 {way} F600\n{turn}G2 X7 Y5 I1 J0\nM5\nG0 X10\nM2\n")
    controller.home()
    controller.run()
    program = open_program(part)
    question = program.question(controller)
    assert question is not None
    program.look(question)
    program.start(controller)
    controller.run()
    state = controller.state()
    at = dict(zip(state.axes, state.position_mm, strict=True))
    assert at["x"] == pytest.approx(10, abs=0.02)
    assert at["y"] == pytest.approx(5, abs=0.02)
    assert state.carriages_mm is not None
    assert state.carriages_mm == pytest.approx(state.position_mm, abs=0.02)
    assert isinstance(plant.port, SimulatedMill)
    assert not any(plant.port.look().lost_steps)
    plant.close()


def test_a_machine_that_there_is_not_is_refused_by_name() -> None:
    with pytest.raises(UsageError, match="no example machine nosuch; there are: paper-laser"):
        machines.whole("nosuch")
