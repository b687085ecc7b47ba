"""``fraese doctor`` as one types it."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from fraese.cli import app
from fraese.cli.histogram import bar, histogram

if sys.platform != "linux":
    pytest.skip("the doctor looks at a Linux kernel", allow_module_level=True)

SHORT = ("--seconds", "0.2")
#: A rate that everybody can play.
SLOW = "".join(f"[axes.{name}]\nmax_rate_hz = 200\nstart_rate_hz = 100\n" for name in "xyz")


def run(*words: object) -> Result:
    result = CliRunner().invoke(app, ["doctor", *map(str, words)])
    assert "Traceback" not in result.output
    return result


@pytest.fixture
def slow_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    path = tmp_path / "slow.toml"
    path.write_text(SLOW)
    return path


def test_people_get_checks_figures_and_a_picture(slow_machine: Path) -> None:
    result = run("--config", slow_machine, *SHORT)
    assert result.exit_code == 0
    assert "The simulated mill: it needs no port" in result.stdout
    assert "200 ticks/s on 3 axes" in result.stdout
    assert "█" in result.stdout
    assert result.stdout.rstrip().splitlines()[-1].startswith("Nothing is bad")
    assert "all cores kept busy" in result.stderr


def test_programs_get_one_object_on_the_last_line(slow_machine: Path) -> None:
    command = [sys.executable, "-m", "fraese", "doctor", "--config", str(slow_machine), "--json"]
    done = subprocess.run(
        [*command, "--no-load", *SHORT], capture_output=True, text=True, timeout=120, check=True
    )
    said: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    assert said["ok"] is True
    assert said["port"] == "simulation"
    assert {check["state"] for check in said["checks"]} <= {"ok", "warn"}
    timing = said["timing"]
    assert (timing["rate_hz"], timing["motors"], timing["quarter_us"]) == (200, 3, 1250)
    (quiet,) = timing["runs"]
    assert quiet["name"] == "quiet"
    assert quiet["edges"] == sum(timing["histogram"]["quiet"]) == pytest.approx(40, abs=1)
    assert 0 < quiet["median_us"] <= quiet["p99_us"] <= quiet["p999_us"] <= quiet["longest_us"]
    assert len(timing["histogram"]["edges_us"]) == len(timing["histogram"]["quiet"]) + 1
    assert timing["ladder"][0]["rate_hz"] == 200
    assert timing["highest_rate_hz"] in [0, *(rung["rate_hz"] for rung in timing["ladder"])]


@pytest.mark.parametrize(
    ("text", "said"),
    [("[port]\nkind = 'usb'\n", "port.kind"), ("[card]\ntable = 'zz'\n", "card.table")],
)
def test_a_wrong_configuration_is_refused(slow_machine: Path, text: str, said: str) -> None:
    slow_machine.write_text(text)
    result = run("--config", slow_machine, *SHORT)
    assert result.exit_code == 2
    assert said in result.stderr


@pytest.mark.parametrize("seconds", [0, -1, 1e6, "nan"])
def test_a_measurement_has_a_length(slow_machine: Path, seconds: object) -> None:
    result = run("--config", slow_machine, "--seconds", seconds, "--json")
    assert result.exit_code == 2
    assert json.loads(result.stdout)["status"] == "refused"


def test_a_missing_port_is_bad(slow_machine: Path) -> None:
    slow_machine.write_text(f'[port]\nkind = "ppdev"\ndevice = "/dev/no-such-port0"\n{SLOW}')
    result = run("--config", slow_machine, *SHORT, "--no-load")
    assert result.exit_code == 1
    assert "BAD   device                /dev/no-such-port0 does not exist." in result.stdout
    assert "-> Load the drivers with sudo modprobe -a parport_pc ppdev." in result.stdout


# --- the histogram -------------------------------------------------------------------------------


def test_one_is_seen_beside_a_million() -> None:
    assert bar(0, 10**6, 14) == ""
    assert bar(1, 10**6, 14) == "██"
    assert bar(10**6, 10**6, 14) == "█" * 14
    lengths = [len(bar(10**k, 10**6, 14)) for k in range(7)]
    assert lengths == [2, 4, 6, 8, 10, 12, 14]


def test_bins_that_nobody_is_in_are_left_out_at_the_ends_only() -> None:
    edges = [0.0, 1.0, 2.0, 5.0, 10.0, float("inf")]
    lines = histogram(edges, [("quiet", [0, 7, 0, 1, 0]), ("busy", [0, 0, 0, 3, 0])], "us", 8)
    assert [line[:10].strip() for line in lines[1:]] == ["1 to 2 us", "2 to 5 us", "5 to 10 us"]
    assert lines[0].split() == ["quiet", "busy"]
    assert lines[1].endswith("7")
    assert "█" not in lines[2]
    assert histogram(edges, [("quiet", [0] * 5)], "us", 8) == []
    (_, last) = histogram(edges, [("quiet", [0, 0, 0, 0, 2])], "us", 8)
    assert last.startswith("from 10 us")
