"""The log: what the original wrote, and no more than that."""

import contextlib
import logging
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from fraese.assembly import Plant, assemble
from fraese.control.state import Status
from fraese.errors import ConfigError, LimitError
from fraese.log import LogFile, write

from .helpers import configured, program, run_program


@pytest.fixture
def made(tmp_path: Path) -> Iterator[Plant]:
    plant = assemble(configured(log={"file": str(tmp_path / "new" / "fraese.log")}))
    yield plant
    plant.close()


def lines(plant: Plant) -> list[str]:
    assert plant.controller.log is not None
    path = plant.controller.log.path
    return path.read_text("utf-8").splitlines() if path.exists() else []


def test_off_at_the_start_and_switched_at_run_time(made: Plant) -> None:
    controller = made.controller
    controller.jog("x", 1)
    controller.run()
    assert lines(made) == []
    assert not controller.state().log_on
    controller.switch_log(True)
    controller.switch_log(True)
    assert controller.state().log_on
    controller.jog("x", 1)
    controller.run()
    controller.switch_log(False)
    written = lines(made)
    controller.jog("x", 1)
    controller.run()
    assert lines(made) == written
    assert len(written) > 4


def test_a_line_has_time_module_procedure_place_and_text(made: Plant) -> None:
    made.controller.switch_log(True)
    made.controller.jog("y", -1.5)
    entry = next(line for line in lines(made) if " jog " in line)
    date, clock, module, procedure, place, *text = entry.split()
    assert (module, procedure, place) == ("COMMANDS", "jog", "entry")
    assert " ".join(text) == "'y', -1.5"
    assert len(date) == 10
    assert len(clock) == 12


def test_entries_have_parameters_and_exits_results_or_the_error(made: Plant) -> None:
    made.controller.switch_log(True)
    with pytest.raises(LimitError):
        made.controller.jog("x", 1000)
    assert any("jog" in line and "error" in line and "1000 mm" in line for line in lines(made))
    made.controller.home()
    assert made.controller.run() is Status.OK
    run = [line for line in lines(made) if " run " in line]
    assert "reference Z X Y" in run[0]
    assert "OK X 0.000" in run[1]


def test_it_is_appended_and_has_no_ring(made: Plant) -> None:
    for number in range(3):
        made.controller.switch_log(True)
        write("test", "here", "place", f"number {number}\nsecond line")
        made.controller.switch_log(False)
    assert sum("log on" in line for line in lines(made)) == 3
    assert sum("log off" in line for line in lines(made)) == 3


def test_a_long_job_does_not_drown_in_its_log(made: Plant, tmp_path: Path) -> None:
    made.controller.switch_log(True)
    text = "G91\n" + "G1 X0.1 F2000\nX-0.1\n" * 400 + "M2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert len(lines(made)) < 20


def test_on_from_the_start_where_so_configured(tmp_path: Path) -> None:
    path = tmp_path / "fraese.log"
    made = assemble(configured(log={"file": str(path), "enabled": True}))
    made.close()
    assert "log on" in path.read_text()
    assert not logging.getLogger("fraese").isEnabledFor(logging.INFO)


def test_without_a_name_it_lies_beside_the_state(tmp_path: Path) -> None:
    made = assemble(configured(), state=tmp_path)
    assert made.controller.log is not None
    assert made.controller.log.path == tmp_path / "fraese.log"


@pytest.mark.parametrize("bad", ["", "file/below"])
def test_a_file_that_cannot_be_written_is_said(tmp_path: Path, bad: str) -> None:
    (tmp_path / "file").write_text("")
    log = LogFile(tmp_path / bad if bad else tmp_path)
    with pytest.raises(ConfigError, match="the log cannot be written"):
        log.switch(True)
    assert not log.is_on


def test_a_full_disk_does_not_disturb_the_machine(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    made = assemble(configured(log={"file": str(tmp_path / "the.log"), "enabled": True}))
    assert made.controller.log is not None
    handler = made.controller.log._handler
    assert handler is not None
    with open("/dev/full", "a", encoding="utf-8") as full:
        before = handler.setStream(full)
        assert before is not None
        before.close()
        made.controller.jog("x", 1)
        assert made.controller.run() is Status.OK
        made.close()
        with contextlib.suppress(OSError):
            full.close()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("kind", ["fifo", "device", "folder"])
def test_a_log_that_is_no_file_is_refused_at_once(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "the.log"
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "device":
        path = Path("/dev/null")
    else:
        path.mkdir()
    with pytest.raises(ConfigError, match="the log cannot be written"):
        assemble(configured(log={"file": str(path), "enabled": True}))


def test_the_log_is_nobody_elses(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "the.log")
    log.switch(True)
    log.switch(False)
    assert (tmp_path / "the.log").stat().st_mode & 0o777 == 0o600


def test_a_logged_line_is_one_plain_line(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "the.log")
    log.switch(True)
    write("mod", "proc", "entry", "a\nb\x1b]0;x\x07\u202e\udc80")
    log.switch(False)
    lines = (tmp_path / "the.log").read_text().splitlines()
    assert len(lines) == 3
    assert lines[1].endswith("a\\nb\\x1b]0;x\\x07\\u202e\\udc80")
