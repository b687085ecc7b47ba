"""grbl's settings and this machine's configuration; what is kept for a sender."""

from pathlib import Path
from typing import Any

import pytest

from fraese.cli.serving import writer
from fraese.config.file import load
from tests.helpers import STEPDIR, homed, merged
from tests.serve.sender import Bench, bench


def _values(at: Bench) -> dict[str, str]:
    pairs = (line[1:].split("=") for line in at.say("$$") if line.startswith("$"))
    return dict(pairs)


def test_every_axis_is_shown_as_it_is_configured() -> None:
    values = _values(bench())
    machine = {name: values[name] for name in ("100", "110", "120", "130", "131", "132")}
    assert machine == {
        "100": "200", "110": "1200", "120": "100", "130": "296", "131": "196", "132": "56",
    }  # fmt: skip
    assert (values["20"], values["21"], values["22"], values["23"], values["32"]) == (
        "1", "1", "1", "3", "0",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("$110=600", {"axes.x.max_rate_hz": 2000.0}),
        ("$121=50", {"axes.y.acceleration_hz_s": 10000.0}),
        ("$102=400", {"axes.z.pitch_mm": 1}),
        ("$130=100", {"axes.x.travel_mm": 104}),
        ("$27=3", {"homing.pull_off_mm": 3.0}),
        ("$1=255", {"standstill.current": "hold"}),
        ("$1=25", {"standstill.current": "off", "standstill.delay_s": 0.025}),
        ("$3=1", {"axes.x.inverted": True, "axes.y.inverted": False, "axes.z.inverted": False}),
        ("$23=0", {"axes.x.home_end": "max", "axes.y.home_end": "max", "axes.z.home_end": "max"}),
        ("$110=1200", {}),
        ("$11=0.02", {}),
    ],
)
def test_a_setting_is_a_key_of_the_configuration(line: str, written: dict[str, Any]) -> None:
    at = bench()
    assert at.say(line) == ["ok"]
    assert at.written == written


@pytest.mark.parametrize("line", ["$20=0", "$21=0", "$22=0", "$32=1", "$30=500"])
def test_what_this_machine_always_does_cannot_be_chosen(line: str) -> None:
    at = bench()
    assert at.say(line)[-1] == "error:5"
    assert at.written == {}


def test_a_setting_is_written_and_counts(tmp_path: Path) -> None:
    file = tmp_path / "fraese.toml"
    file.write_text("# mine\n[homing]\nslow_mm_min = 50\n")
    at = Bench(homed())
    write = writer(file, at.controller)
    at.session._system._write = write
    assert at.say("$24=80") == ["ok"]
    assert at.controller.config.homing.slow_mm_min == 80
    said = at.say("$110=600")
    assert "it counts from the next start" in said[0]
    assert load(file).axes.table["x"].max_rate_hz == 2000
    assert file.read_text().startswith("# mine\n")
    assert at.say("$132=100000000")[-1] == "error:3"


def test_a_fourth_axis_follows_the_three() -> None:
    at = bench(**merged(STEPDIR, {"axes": {"names": ["x", "y", "z", "a"]}}))
    assert "|MPos:0.000,0.000,0.000,0.000|" in at.ask()
    assert _values(at)["133"] == "0"


def test_a_machine_of_two_axes_says_that_z_is_zero() -> None:
    at = bench(axes={"names": ["x", "y"]}, run={"retract_mm": 0})
    assert at.say("G0 X1 Y2") == ["ok"]
    assert "|MPos:1.000,2.000,0.000|" in at.ask()


def test_what_is_kept_for_a_sender_is_there_the_next_time(tmp_path: Path) -> None:
    store = tmp_path / "serve.json"
    at = Bench(homed(), store)
    assert at.say("$13=1", "$N0=G20", "$I=mill one") == ["ok"] * 3
    again = Bench(homed(), store)
    assert again.heard[-1] == ">G20:ok"
    assert again.say("$N", "$I", "$G") == [
        "$N0=G20", "$N1=", "ok",
        "[VER:1.1h.20190830:mill one]", "[OPT:VHM,15,128]", "ok",
        "[GC:G0 G54 G17 G20 G90 G94 M5 M9 T0 F0 S0]", "ok",
    ]  # fmt: skip
    assert again.say("$RST=#")[-1] == "error:5"
    assert again.say("$RST=$")[-1] == "ok"
    assert Bench(homed(), store).heard == ["Grbl 1.1h ['$' for help]"]


@pytest.mark.parametrize("kept", ["", "[]", "{", '{"settings": [1], "start_lines": 3}', "\0"])
def test_what_cannot_be_read_was_not_kept(kept: str, tmp_path: Path) -> None:
    (tmp_path / "serve.json").write_text(kept)
    assert _values(Bench(homed(), tmp_path / "serve.json"))["10"] == "1"


def test_a_probe_tells_where_it_touched() -> None:
    at = bench()
    at.when(lambda: at.at_mm[2] < -3, lambda: at.plant.press("zmin", True))
    heard = at.say("G38.3 Z-10 F60", "$#")
    found = [line for line in heard if line.startswith("[PRB:")]
    assert len(found) == 2
    assert found[0] == found[1]
    assert found[0].endswith(":1]")
    assert -4 < float(found[0].split(",")[2].split(":")[0]) < -3


def test_a_probe_that_never_touches_is_an_alarm() -> None:
    at = bench()
    assert "ALARM:5" in at.say("G38.2 Z-2 F100")
    assert at.say("$X")[-1] == "ok"
