"""docs/extending.md: its examples, as they stand there."""

import re
import socket
import threading
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from fraese.assembly import Plant, assemble
from fraese.cli import app
from fraese.config import Config
from fraese.config import file as configuration
from fraese.control.state import Status
from fraese.doctor import admit
from fraese.errors import ConfigError, PortError, ProgramError
from fraese.kinds.card import card_of
from fraese.kinds.port import port_opener
from fraese.motor.pins import CONTROL_PINS
from fraese.motor.seams import CONTROL, DATA, STATUS
from fraese.planner.lines import plan_line
from fraese.program.program import open_program
from tests.beside import install
from tests.planner.motion import check_limits

PAGE = Path(__file__).parents[2] / "docs/extending.md"
_FILE = re.compile(r"^`([\w./]+)`:\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: What is read where no end switch is pressed.
AT_REST = 0xF8


@pytest.fixture
def files(tmp_path: Path) -> Mapping[str, Path]:
    """Every file of the page, written down."""
    found = {}
    for name, text in _FILE.findall(PAGE.read_text("utf-8")):
        path = found[name] = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return found


def go_round(plant: Plant) -> None:
    """Reference, and a way that every axis takes part in."""
    plant.controller.home()
    assert plant.controller.run() is Status.OK, plant.controller.state().message
    plant.controller.move_to({"x": 20.125, "y": 10.25, "z": -5.5})
    assert plant.controller.run() is Status.OK
    state = plant.controller.state()
    assert state.lost_steps == (0, 0, 0)
    assert state.carriages_mm == pytest.approx((20.125, 10.25, -5.5), abs=0.005)
    plant.close()


@pytest.mark.parametrize(("name", "steps"), [("quarter.toml", 800), ("eighth.toml", 1600)])
def test_a_machine_of_the_page_does_what_it_is_told(
    files: Mapping[str, Path], name: str, steps: int
) -> None:
    config = configuration.load(files[name])
    assert {axis.steps_per_rev for axis in config.axes.table.values()} == {steps}
    plant = assemble(config)
    assert plant.notes == ()
    go_round(plant)


def test_the_inputs_of_the_page_find_every_end(files: Mapping[str, Path]) -> None:
    plant = assemble(configuration.load(files["inputs.toml"]))
    go_round(plant)


def test_the_bytes_of_the_page_are_those_of_its_currents() -> None:
    rows = re.findall(r"^\| (A|B|byte) \| (.*) \|$", PAGE.read_text("utf-8"), re.MULTILINE)
    a, b, byte = (row.split(" | ") for _, row in rows)
    codes = {100: 0, 60: 1, 20: 2, 0: 3}

    def bits(percent: int) -> int:
        return (4 if percent < 0 else 0) | codes[abs(percent)]

    made = [bits(int(q)) << 3 | bits(int(p)) for p, q in zip(a, b, strict=True)]
    assert [f"{each:02X}" for each in made] == byte


def test_the_keys_of_the_page_are_taken(files: Mapping[str, Path]) -> None:
    assert configuration.load(files["keys.toml"]).keys["go_to"] == ("f8",)


def test_the_macro_of_the_page_parks_the_machine(files: Mapping[str, Path], tmp_path: Path) -> None:
    config = configuration.load(files["park.toml"])
    (macro,) = config.macros
    plant = assemble(config)
    plant.controller.home()
    plant.controller.run()
    part = tmp_path / "part.ngc"
    part.write_text("\n".join(macro.lines))
    program = open_program(part)
    program.start(plant.controller, program.check(plant.controller))
    assert plant.controller.run() is Status.OK
    assert plant.controller.state().position_mm == (10, 190, -1)
    plant.close()


def installed(
    files: Mapping[str, Path], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Config:
    """A package of the page, installed; its configuration."""
    folder = files[f"{name}/pyproject.toml"].parent
    install(folder, monkeypatch, tmp_path / "site-packages")
    return configuration.load(folder / "fraese.toml")


def test_the_ramp_of_the_page_keeps_the_limits_and_loses_nothing(
    files: Mapping[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = installed(files, "parabola", tmp_path, monkeypatch)
    plant = assemble(config)
    machine = plant.controller.machine
    block = plan_line(machine, (4000, 3000, 0))
    assert block is not None
    check_limits(machine.axes, [block])
    go_round(plant)


@pytest.fixture
def far_end() -> Iterator[SimpleNamespace]:
    """Somebody at the other end of the line: registers as they are written, inputs at rest."""
    server = socket.create_server(("localhost", 0))
    seen = SimpleNamespace(port=server.getsockname()[1], writes=[], registers={})

    def serve() -> None:
        while True:
            try:
                line, _ = server.accept()
            except OSError:
                return
            with line:
                while (access := line.recv(2, socket.MSG_WAITALL)) and len(access) == 2:
                    register, value = access
                    if register == STATUS:
                        line.sendall(bytes((AT_REST,)))
                    else:
                        seen.writes.append((register, value))
                        seen.registers[register] = value

    thread = threading.Thread(target=serve)
    thread.start()
    yield seen
    server.shutdown(socket.SHUT_RDWR)
    server.close()
    thread.join()


def reached(config: Config, far_end: SimpleNamespace) -> Config:
    port = config.port.model_copy(update={"device": f"localhost:{far_end.port}"})
    return config.model_copy(update={"port": port})


def test_the_port_of_the_page_is_three_registers(
    files: Mapping[str, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    far_end: SimpleNamespace,
) -> None:
    config = installed(files, "tcp", tmp_path, monkeypatch)
    with closing(port_opener(reached(config, far_end))()) as port:
        port.write_data(0xA5)
        port.write_control(0x0B)
        assert port.read_status() == AT_REST
    assert far_end.writes == [(DATA, 0xA5), (CONTROL, 0x0B)]
    with pytest.raises(ConfigError, match="must be host:port, such as mill:4711, not /dev/lp0"):
        configuration.from_table({"port": {"kind": "tcp", "device": "/dev/lp0"}}, "test")


def test_the_doctor_shows_what_it_does_with_the_port_of_the_page(
    files: Mapping[str, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    far_end: SimpleNamespace,
) -> None:
    config = reached(installed(files, "tcp", tmp_path, monkeypatch), far_end)
    patient = admit(config, card_of(config), trace=tmp_path / "doctor.vcd")
    assert patient.opening.error == ""
    assert patient.opening.pins
    waveform = (tmp_path / "doctor.vcd").read_text()
    assert "pin01_nstrobe" in waveform
    assert waveform.count("#") >= 2
    result = CliRunner().invoke(app, ["doctor", "--trace", str(tmp_path / "no.vcd")])
    assert result.exit_code == 2
    assert "a port of the kind simulation" in result.output


@pytest.mark.alone
def test_the_port_of_the_page_drives_motors(
    files: Mapping[str, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    far_end: SimpleNamespace,
) -> None:
    """In a process of its own, over the line; at the end motors and outputs are off."""
    config = installed(files, "tcp", tmp_path, monkeypatch)
    plant = assemble(reached(config, far_end))
    plant.controller.jog("x", 0.5)
    assert plant.controller.run() is Status.OK, plant.controller.state().message
    assert plant.controller.state().position_steps[0] == 100
    plant.close()
    bytes_of_x = {value for register, value in far_end.writes if register == DATA and value < 64}
    assert len(bytes_of_x) >= 8
    assert far_end.registers[DATA] & 0x3F == 0x1B
    with pytest.raises(PortError, match="cannot be reached: Connection refused"):
        assemble(config)


def test_the_word_of_the_page_opens_its_valve_and_closes_it(
    files: Mapping[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant = assemble(installed(files, "blast", tmp_path, monkeypatch))
    bit, opened = CONTROL_PINS[16].bit, list[bool]()
    mill = plant.port
    assert mill is not None
    plant.controller.set_show_pos(lambda: opened.append(bool(mill.electronics.pins[1] & bit)))
    part = tmp_path / "part.ngc"
    part.write_text("G1 X1 F600\nM110 P0.5\nX2\nM2\n")
    program = open_program(part)
    program.start(plant.controller, program.check(plant.controller))
    assert plant.controller.run() is Status.OK
    assert True in opened
    assert opened[0] is opened[-1] is False
    part.write_text("M110\n")
    with pytest.raises(ProgramError, match="M110 needs a P word"):
        open_program(part).check(plant.controller)
    plant.close()
