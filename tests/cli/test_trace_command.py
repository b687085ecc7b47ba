"""``fraese trace``: figures that are true, rows that fit, pictures, and what is refused."""

import json
import xml.etree.ElementTree
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from fraese.cli import app
from tests.cli.test_trace_option import STEP_DIRECTION


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """With a waveform of X4Step's drives: there and back, 400 steps each."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "user-state"))
    (tmp_path / "fraese.toml").write_text(STEP_DIRECTION)
    (tmp_path / "part.ngc").write_text("G1 X2 F600\nX0\nM2\n")
    assert run("run", "part.ngc", "--trace", "job.vcd").exit_code == 0
    return tmp_path


def run(*words: object, columns: int = 80, charset: str = "utf-8") -> Result:
    environment = {"COLUMNS": str(columns)}
    result = CliRunner(charset=charset).invoke(app, [*map(str, words)], env=environment)
    assert result.exception is None or isinstance(result.exception, SystemExit), result
    return result


def figures(*words: object) -> dict[str, Any]:
    result = run("trace", *words, "--json")
    assert result.exit_code == 0, result.output
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def test_figures_of_a_job_are_those_of_its_plan(folder: Path) -> None:
    found = figures("job.vcd")
    clock = found["lines"]["pin03_x_clock"]
    assert (clock["edges"], clock["rising"], clock["level"]) == (1600, 800, 0)
    # 600 mm/min at 200 steps/mm, of which a machine without reference makes a half.
    assert clock["fastest_hz"] == pytest.approx(1000, rel=1e-6)
    assert clock["shortest_high_s"] == pytest.approx(500e-6, rel=1e-3)
    assert found["to_s"] == clock["last_edge_s"]
    x_axis = found["set_ups"][0]
    assert (x_axis["direction"], x_axis["clock"]) == ("pin02_x_direction", "pin03_x_clock")
    assert x_axis["count"] == 2
    assert x_axis["shortest_s"] >= 100e-6
    still = found["lines"]["pin05_y_clock"]
    assert (still["edges"], still["rate_hz"], still["duty"], still["first_edge_s"]) == (
        0,
        None,
        None,
        None,
    )


def test_a_lead_of_a_direction_is_found_and_shown(folder: Path) -> None:
    lead = figures("job.vcd")["set_ups"][0]
    near = figures("job.vcd", "--around", f"{lead['at_s']:.9f}s", "--span", "4ms")
    assert near["to_s"] - near["from_s"] == pytest.approx(4e-3)
    assert near["set_ups"][0]["shortest_s"] == pytest.approx(lead["shortest_s"])
    # The same by the edge of the line, which is the last one until then.
    until = figures("job.vcd", "--to", f"{lead['at_s']:.9f}s")["lines"]["pin02_x_direction"]
    place = f"x_dir:{until['edges']}"
    assert figures("job.vcd", "--around", place, "--span", "4ms")["lines"] == near["lines"]
    shown = run("trace", "job.vcd", "--around", "x_dir:2", "--span", "4ms", "--line", "x_")
    rows = [line for line in shown.stdout.splitlines() if line.startswith("pin0")][-2:]
    # In the middle one edge, high before it and low after it.
    assert rows[0].startswith("pin02_x_direction ▔▔▔▔▔")
    assert rows[0].endswith("▁▁▁▁▁")
    assert rows[0].count("│") == 1


@pytest.mark.parametrize("name", ["job.vcd", "phases.vcd"])
@pytest.mark.parametrize("stretch", [(), ("--from", "20ms", "--to", "40ms"), ("--around", "0.1s")])
def test_no_row_is_wider_than_80_columns_where_there_is_no_terminal(
    folder: Path, name: str, stretch: tuple[str, ...]
) -> None:
    (folder / "fraese.toml").unlink()
    assert run("move", "X1", "--fresh", "--trace", "phases.vcd").exit_code == 0
    shown = run("trace", name, *stretch)
    drawn = [line for line in shown.stdout.splitlines() if "throughout" not in line]
    assert len(drawn) > 5
    assert [line for line in drawn if len(line) > 80] == []
    assert "\x1b" not in shown.stdout


def test_where_no_fine_characters_can_be_shown_there_are_plain_ones(folder: Path) -> None:
    shown = run("trace", "job.vcd", charset="ascii")
    assert shown.exit_code == 0
    assert shown.stdout.isascii()
    assert "####" in shown.stdout


def test_a_picture_has_every_line_that_changes(folder: Path) -> None:
    assert run("trace", "job.vcd", "--svg", "job.svg").exit_code == 0
    picture = xml.etree.ElementTree.parse(folder / "job.svg").getroot()
    words = [text.text for text in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert {"pin02_x_direction", "pin03_x_clock", "pin17_active"} <= set(words)
    assert "pin05_y_clock" not in words
    assert run("trace", "job.vcd", "--line", "y_", "--svg", "job.svg").exit_code == 0
    refused = run("trace", "job.vcd", "--svg", "part.ngc")
    assert refused.exit_code == 2
    assert "part.ngc is there and is no picture; it is not overwritten." in refused.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("none.vcd", "none.vcd: cannot be read: No such file or directory."),
        ("part.ngc", "part.ngc, line 1: this is no VCD file"),
        ("job.vcd --from 9s", "--from 9s is after the end of job.vcd"),
        ("job.vcd --around 9s", "--around 9s is after the end of job.vcd"),
        ("job.vcd --from 20ms --to 10ms", "--to must come after --from"),
        ("job.vcd --from 20ms --to 20ms", "--to must come after --from"),
        (
            "job.vcd --around 1ms --span 0",
            "--span 0 is nothing to look at; say a length, as in 2ms.",
        ),
        ("job.vcd --around 1ms --span 0.1ns", "--span 0.1ns is nothing to look at"),
        ("job.vcd --around 1ms --span=-1ms", '--span "-1ms" is no time'),
        ("job.vcd --around 1ms --span nan", '--span "nan" is no time'),
        ("job.vcd --around 1ms --span inf", '--span "inf" is no time'),
        ("job.vcd --span 5ms", "--span goes with --around, which says where."),
        ("job.vcd --from 1ms --span 5ms", "--span goes with --around"),
        ("job.vcd --around x_dir:0", "pin02_x_direction:0: edges are counted from 1."),
        ("job.vcd --from 1h", '--from "1h" is no time; it is a number with s, ms, us or ns.'),
        ("job.vcd --from 1ms --around 2ms", "Either --from and --to, or --around"),
        ("job.vcd --around nothing", 'has no line "nothing"; there is pin02_x_direction'),
        ("job.vcd --around clock", '"clock" may be one of several lines'),
        ("job.vcd --around x_dir:9", "pin02_x_direction has 2 edges, not 9."),
        ("job.vcd --line q", 'has no line "q"'),
        ("job.vcd --pair x_dir", '--pair "x_dir": two lines'),
    ],
)
def test_what_is_refused_is_one_sentence(folder: Path, words: str, said: str) -> None:
    result = run("trace", *words.split())
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
