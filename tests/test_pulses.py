"""The paper's programs: what they print, and what the simulated motors did."""

import re
import runpy
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import pytest

from fraese.x4step.paths import path

FOLDER: Final = Path(__file__).parents[1] / "examples" / "pulses"
NAMES: Final = ("drives", "speeds")
PULSES: Final = 65_535
#: As printed: a delay of 48 passes, and one of 1568.
DUTY: Final = 48 / 1616


@pytest.fixture(autouse=True)
def folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Programs of the folder find each other, as when they are called."""
    monkeypatch.syspath_prepend(str(FOLDER))
    yield
    for name in NAMES:
        sys.modules.pop(name, None)


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    def call(name: str, *arguments: str) -> str:
        monkeypatch.setattr(sys, "argv", [name, *arguments])
        runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
        return capsys.readouterr().out

    return call


Call = Callable[..., str]


def module(name: str) -> ModuleType:
    __import__(name)
    return sys.modules[name]


def opened(**wishes: Any) -> AbstractContextManager[Any]:
    made: AbstractContextManager[Any] = module("drives").drives(**wishes)
    return made


# --- MOTOR.ASM ------------------------------------------------------------------------------------


def test_all_pulses_of_the_two_motor_program() -> None:
    """65,535 of each motor, one forward, one back: as bytes, and as motors that turned."""
    with opened(duty=DUTY) as port:
        port.play(path((PULSES, -PULSES), 10_000, 0))
        written = port.bytes_written()
        seen = port.mill.look()
    assert [value for _, value in written] == [0x0B, 0x01] * PULSES
    # Eight pulses a step, two half-steps a step.
    assert seen.carriages_steps == (PULSES / 4, -PULSES / 4)
    assert not any(seen.lost_steps)


def test_directions_come_with_the_first_pulse_in_one_write() -> None:
    """The byte before it has none of them."""
    with opened() as port:
        port.play(path((10, -10), 10_000, 0))
        port.play(path((-10, 10), 10_000, 0))
        values = [a.value for a in port.recorder.accesses if a.register == 0]
    first, back = values.index(0x0B), values.index(0x0E)
    assert values[first - 1] == 0x00
    assert values[back - 1] == 0x01
    assert values[back:] == [0x0E, 0x04] * 10


@pytest.mark.parametrize(
    ("rate_hz", "duty", "high_us", "low_us"),
    [(10_000, 0.5, 50, 50), (10_000, DUTY, 2.97, 97.03), (10_000, 0.9, 90, 10),
     (133_333, 0.5, 3.75, 3.75), (100_000, DUTY, 0.5, 9.5)],
)  # fmt: skip
def test_one_delay_is_half_and_two_are_any_share(
    rate_hz: int, duty: float, high_us: float, low_us: float
) -> None:
    """To a cycle of 1/16 us; never under the 0.5 us that the drives want."""
    with opened(duty=duty) as port:
        port.play(path((100, -100), rate_hz, 0))
        times = [at_ns for at_ns, _ in port.bytes_written()]
    for rise, fall, again in zip(times[::2], times[1::2], times[2::2], strict=False):
        assert (fall - rise) / 1000 == pytest.approx(high_us, abs=0.07)
        assert (again - fall) / 1000 == pytest.approx(low_us, abs=0.07)


def test_the_program_as_a_reader_calls_it(called: Call, tmp_path: Path) -> None:
    said = called("two_motors", "--pulses", "500", "--trace", str(tmp_path / "two.vcd"))
    assert said.splitlines()[0] == "bytes       0B 01 0B 01 0B 01 ... 01, 1000 in all"
    assert "motor 1     +500 pulses\nmotor 2     -500 pulses\n" in said
    text = (tmp_path / "two.vcd").read_text("ascii")
    names = dict(re.findall(r"\$var wire 1 (\S+) (\S+) \$end", text))
    wires = {name: key for key, name in names.items()}
    changes = text.partition("$enddefinitions $end")[2].split()
    for wire in ("pin03_motor1_clock", "pin05_motor2_clock"):
        assert changes.count(f"1{wires[wire]}") == 500


@pytest.mark.parametrize("wrong", [("--pulses", "0"), ("--rate", "133334"), ("--duty", "1")])
def test_what_cannot_be_is_refused(called: Call, wrong: tuple[str, str]) -> None:
    with pytest.raises(SystemExit) as ended:
        called("two_motors", *wrong)
    assert ended.value.code == 2


# --- table 3 --------------------------------------------------------------------------------------


def test_speeds(called: Call) -> None:
    said = called("speeds")
    assert said.splitlines()[0] == "step angle 1.8 degrees, 8 pulses for a step"
    assert "   5000.0    133333.3          7.50\n" in said
    assert len(said.splitlines()) == 2 + len(module("speeds").SPEEDS)
    said = called("speeds", "--angle", "0.9", "--subdivision", "16", "--rate", "20000")
    assert said.splitlines()[2].split() == ["187.5", "20000.0", "50.00"]
    assert "faster" in called("speeds", "--rate", "140000")


@pytest.mark.parametrize("speed", [1, 187.5, 1000, 5000])
@pytest.mark.parametrize("angle", [0.9, 1.8, 7.5])
@pytest.mark.parametrize("subdivision", [1, 2, 8, 256])
def test_speed_and_rate_are_each_other_s_inverse(
    speed: float, angle: float, subdivision: int
) -> None:
    speeds = module("speeds")
    rate = speeds.rate_hz(speed, angle, subdivision)
    assert speeds.rev_min(rate, angle, subdivision) == pytest.approx(speed)
    assert speeds.rev_min(133_333, 1.8, 8) == pytest.approx(5000, abs=0.02)


# --- acceleration ---------------------------------------------------------------------------------


def test_linear_acceleration_to_5000_rev_min(called: Call) -> None:
    said = called("acceleration", "--seconds", "0.6")
    rows = [list(map(float, line.split())) for line in said.splitlines()[1:11]]
    for _, rate, linear, _ in rows[:-1]:
        assert rate == pytest.approx(linear, rel=0.03)
    assert rows[-1][1] == pytest.approx(133_333, rel=0.01)
    assert rows[-1][3] == pytest.approx(5000, rel=0.01)
    given, turned = map(int, re.findall(r"ramps of 0.6 s: (\d+) pulses .* by (-?\d+) of", said)[0])
    assert given == turned
    given, turned = map(int, re.findall(r"no ramps: (\d+) pulses .* by (-?\d+) of", said)[0])
    assert turned < given / 100


@pytest.mark.alone
def test_real_time(called: Call) -> None:
    said = called("real_time", "5000", "--seconds", "0.3")
    rate, speed, made = map(float, said.splitlines()[1].split()[:3])
    assert (rate, speed) == (5000, 188)
    assert 2500 < made < 5100
