"""Ports as configured, from files and from the environment; what cannot be opened is 6."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer import Exit

from fraese.cli.scancodes import scancodes
from fraese.errors import ConfigError, PortError
from fraese.x4step import X4GetIn, X4GetState, X4Init, X4Load, X4ReInit, X4Start, X4Step
from fraese.x4step.surroundings import (
    clock_named,
    from_environment,
    log_of,
    pin_levels,
    terminal_keyboard,
)
from fraese.x4step.testing import clock_pin, simulation
from tests.helpers import configured


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty working folder, an empty home, and a virtual clock."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "none"))
    monkeypatch.setenv("FRAESE_X4STEP_CLOCK", "virtual")
    yield tmp_path
    X4ReInit()


def test_without_a_configuration_all_four_are_simulated(folder: Path) -> None:
    for lpt in (1, 2, 3, 4):
        assert X4Init(lpt) == 0
    with X4Step(4) as motors:
        motors.load((5, 0, 0, 0), 1000, 0)
        motors.start()
        motors.wait()
        assert motors.steps(1) == 5


@pytest.mark.parametrize(("lpt", "code"), [(1, 6), (2, 0), (3, 6), (4, 6)])
def test_with_a_table_only_that_port_is_there(
    folder: Path, lpt: int, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "fraese.toml").write_text("[x4step.lpt2]\n", "utf-8")
    assert X4Init(lpt) == code
    said = capsys.readouterr().err
    assert said == (f"x4step: LPT{lpt} is not configured; there is LPT2.\n" if code else "")


@pytest.mark.parametrize("kind", ["bridge", "ppdev"])
def test_a_port_that_cannot_be_opened(
    folder: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    (folder / "fraese.toml").write_text(
        f'[x4step.lpt1]\nkind = "{kind}"\ndevice = "/dev/there-is-none"\n', "utf-8"
    )
    assert X4Init(1) == 6
    assert "/dev/there-is-none" in capsys.readouterr().err
    with pytest.raises(PortError, match="/dev/there-is-none"):
        X4Step(1)
    assert X4Load(1, 0, 0, 0, 1000, 0) == 9
    assert X4ReInit() == 9


def test_the_reason_is_in_the_log(folder: Path) -> None:
    log = folder / "x.log"
    (folder / "fraese.toml").write_text(
        f'[log]\nenabled = true\nfile = "{log}"\n[x4step.lpt2]\n', "utf-8"
    )
    assert X4Init(3) == 6
    log_of(str(log)).switch(False)
    assert "LPT3 is not configured" in log.read_text("utf-8")


def test_a_wrong_configuration_is_said(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "fraese.toml").write_text("[x4step.lpt5]\n", "utf-8")
    assert X4Init(1) == 6
    assert "unknown key x4step.lpt5" in capsys.readouterr().err


def test_another_configuration_file(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = folder / "other.toml"
    other.write_text("[x4step.lpt4]\nlow_pins = [15]\n", "utf-8")
    monkeypatch.setenv("FRAESE_CONFIG", str(other))
    assert X4Init(4) == 0
    assert X4GetIn() == 0b11110
    assert X4Init(1) == 6


def test_pins_of_the_environment(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "fraese.toml").write_text("[x4step.lpt1]\nlow_pins = [10, 15]\n", "utf-8")
    monkeypatch.setenv("FRAESE_X4STEP_PINS", "15=high, 11=low")
    assert X4Init(1) == 0
    assert X4GetIn() == 0b00111


@pytest.mark.parametrize(
    ("text", "levels"),
    [("", {}), ("15=low", {15: False}), ("10=1 11=0", {10: True, 11: False}),
     ("12=HIGH,13=Low", {12: True, 13: False})],
)  # fmt: skip
def test_levels_as_written(text: str, levels: dict[int, bool]) -> None:
    assert pin_levels(text) == levels


@pytest.mark.parametrize("text", ["15", "2=low", "15=middle", "=low", "x=1"])
def test_levels_that_are_none(text: str) -> None:
    with pytest.raises(ConfigError, match="FRAESE_X4STEP_PINS"):
        pin_levels(text)


def test_a_clock_that_is_none() -> None:
    with pytest.raises(ConfigError, match="FRAESE_X4STEP_CLOCK"):
        clock_named("sundial")
    with pytest.raises(ConfigError, match="no such configuration file"):
        from_environment({"FRAESE_CONFIG": "/there-is-none.toml"})


def test_wiring_of_the_other_kind() -> None:
    config = configured(x4step={"lpt1": {"clock_idles_high": True, "forward_high": False}})
    with simulation(config=config) as lab, X4Step(1) as motors:
        motors.load((10, -10, 0, 0), 1000, 0)
        motors.start()
        motors.wait()
        lines = lab.lines()
        assert len(lines.falls(clock_pin(1))) == 10
        assert lines.level(clock_pin(1))
        assert (lines.level(2), lines.level(4)) == (False, True)
        assert lab.mill().look().carriages_steps == (10, -10, 0, 0)


def test_two_ports_at_once() -> None:
    with simulation() as lab, X4Step(1) as one, X4Step(3) as other:
        one.load((100, 0, 0, 0), 1000, 50)
        one.start()
        other.move_negative(2, 500, 0)
        one.wait()
        other.pass_time(0.1)
        lab.press(1)
        other.wait()
        assert one.steps(1) == lab.lines(1).steps(1) == 100
        assert other.steps(2) == lab.lines(3).steps(2) < -40
        assert other.last_brake_code == 1


def test_init_again_begins_anew(folder: Path) -> None:
    assert X4Init(1) == 0
    assert X4Load(1, 0, 0, 0, 1000, 0) == 0
    assert X4Init(2) == 0
    assert X4Start() == 11


def test_a_waveform_of_the_lines(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRAESE_TRACE", str(folder / "lines.vcd"))
    for steps in (30, 7):
        assert X4Init(2) == 0
        assert X4Load(steps, -10, 0, 0, 1000, 0) == 0
        assert X4Start() == 0
        assert X4ReInit() == 0
    for name, steps in (("lines.vcd", 1), ("lines-2.vcd", 1)):
        text = (folder / name).read_text("ascii")
        assert "$timescale 1 ns $end" in text
        assert "$scope module lpt2 $end" in text
        wires = dict(re.findall(r"\$var wire 1 (\S+) (\S+) \$end", text))
        by_name = {wire: key for key, wire in wires.items()}
        assert {"pin03_clock1", "pin04_direction2", "pin16_boost", "pin17_active"} <= set(by_name)
        assert {"pin01_signal1", "pin14_signal2", "pin11_input", "pin15_input"} <= set(by_name)
        assert len(by_name) == 17
        # Braked at once by X4ReInit: at most a step.
        rises = re.findall(rf"^1{re.escape(by_name['pin03_clock1'])}$", text, re.MULTILINE)
        assert len(rises) <= steps


def test_a_waveform_that_cannot_be_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FRAESE_TRACE", str(folder / "none" / "lines.vcd"))
    assert X4Init(2) == 6
    assert "the waveform cannot be written" in capsys.readouterr().err


@pytest.fixture
def no_unix(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A system whose terminals cannot be read, as Windows."""
    for name in ("termios", "fcntl"):
        monkeypatch.setitem(sys.modules, name, None)
    for name in ("terminal", "evdev"):
        monkeypatch.delitem(sys.modules, f"fraese.x4step.{name}", raising=False)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    terminal_keyboard.cache_clear()
    yield
    terminal_keyboard.cache_clear()


@pytest.mark.usefixtures("no_unix")
def test_where_keys_cannot_be_read_it_is_said_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        assert X4Init(2) == 0
        assert X4Load(5, 0, 0, 0, 1000, 0) == 0
        assert X4Start() == 0
        while X4GetState():
            pass
        assert X4ReInit() == 0
    assert capsys.readouterr().err == (
        "x4step: Keys cannot be read on this system, so neither ESC nor any other key brakes; "
        "Ctrl-C ends the program.\n"
    )


@pytest.mark.usefixtures("no_unix")
def test_scancodes_of_a_terminal_that_cannot_be_read(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(Exit) as left:
        scancodes()
    assert left.value.exit_code == 2
    assert capsys.readouterr().err.startswith(
        "fraese: The keys of a terminal cannot be read on this system; those of a file can"
    )
