"""The command line: exit codes, one sentence for whatever is wrong, and the machine unmoved."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from fraese.assembly.keeping import Keeping
from fraese.cli import app
from fraese.config.file import load
from fraese.control.savedstate import SavedState
from fraese.errors import ConfigError, ProgramError
from fraese.program.program import open_program
from tests.helpers import as_nobody, kept


class Shop:
    """A folder with a machine's state, and the commands one types there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.state = folder / "state"

    def run(self, *words: object, state: bool = True) -> Result:
        where = ["--state", str(self.state)] if state else []
        # What is raised shows: a traceback is never an answer.
        result = CliRunner().invoke(app, [*map(str, words), *where])
        assert result.exception is None or isinstance(result.exception, SystemExit), result
        assert "Traceback" not in result.output
        return result

    def file(self, text: str | bytes, name: str = "part.ngc") -> Path:
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def json(self, *words: object) -> dict[str, Any]:
        result = self.run(*words, "--json")
        assert result.exit_code == 0, result.output
        values: dict[str, Any] = json.loads(result.stdout.splitlines()[-1])
        return values

    def kept(self) -> dict[str, Any]:
        return kept(self.state)


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "user-state"))
    return Shop(tmp_path)


def test_the_result_has_the_keys_that_were_agreed(shop: Shop) -> None:
    values = shop.json("move", "X10", "Y-5.5")
    assert values["status"] == "done"
    assert values["position_mm"] == {"x": 10, "y": -5.5, "z": 0}
    assert values["position_steps"] == {"x": 2000, "y": -1100, "z": 0}
    assert values["steps"] == {"x": 2000, "y": 1100, "z": 0}
    assert values["duration_s"] > 0.5
    assert values["blocks"] == 1


def test_a_right_angle_leaves_no_remains(shop: Shop) -> None:
    shop.run("home")
    result = shop.run("run", shop.file("G10 L2 P1 X10 Y30 R-90\nG0 X10 Y5\nX20 Y0\nM2\n"))
    assert result.exit_code == 0, result.output
    values = shop.json("where")
    assert values["position_mm"] == {"x": 10, "y": 10, "z": 0}
    assert str(values["work_mm"]) == "{'x': 20.0, 'y': 0.0, 'z': 0.0}"
    assert "X 20.000 Y 0.000 Z 0.000 mm" in shop.run("where").output


def test_home_and_then_run_are_two_commands_on_one_machine(shop: Shop) -> None:
    part = shop.file("G0 X20 Y10\nG1 X0 F600\nM2\n")
    assert shop.json("home")["position_steps"] == {"x": 0, "y": 0, "z": 0}
    result = shop.json("run", part)
    assert result["position_mm"] == {"x": 0, "y": 10, "z": 0}
    assert result["steps"]["x"] == 8000
    assert all(result["referenced"].values())
    assert shop.json("where")["position_mm"]["y"] == 10
    assert shop.json("where", "--fresh")["position_mm"]["y"] == 0


def test_options_may_stand_in_front_of_the_command(shop: Shop) -> None:
    other = shop.folder / "other"
    result = shop.run("--state", other, "move", "X1", state=False)
    assert result.exit_code == 0
    assert (other / "simulation.journal").exists()
    result = shop.run("--config", "nowhere.toml", "where")
    assert result.exit_code == 2
    assert "nowhere.toml" in result.stderr
    assert shop.run("--config", "nowhere.toml", "config", "check", state=False).exit_code == 2


def test_numbers_below_zero_and_axes_in_many_spellings(shop: Shop) -> None:
    assert shop.json("jog", "X", "-1.5")["position_mm"]["x"] == -1.5
    assert shop.json("jog", "z", "-.5")["position_mm"]["z"] == -0.5
    assert shop.json("move", "X-3", "y", "2,5")["position_mm"] == {"x": -3, "y": 2.5, "z": -0.5}
    assert shop.json("move", "X=1", "--relative")["position_mm"]["x"] == -2
    assert shop.json("home", "zX")["referenced"] == {"x": True, "y": False, "z": True}


def test_a_jog_goes_with_the_feed_that_is_given(shop: Shop) -> None:
    assert shop.json("jog", "X", "5", "--feed", "60")["duration_s"] == pytest.approx(5, rel=0.1)
    assert shop.json("jog", "X", "5")["duration_s"] == pytest.approx(0.5, rel=0.4)
    result = shop.run("jog", "X", "-5", "--feed", "99999")
    assert result.exit_code == 0
    assert "F 99999 mm/min is more than the axes can" in result.stderr


def test_zero_and_machine_coordinates(shop: Shop) -> None:
    shop.run("home")
    shop.run("move", "X30")
    assert shop.json("zero", "x")["work_mm"] == {"x": 0, "y": 0, "z": 0}
    assert shop.json("move", "X5")["position_mm"]["x"] == 35
    assert shop.json("move", "X5", "--machine")["position_mm"]["x"] == 5


BAD_CALLS: list[tuple[tuple[str, ...], str]] = [
    (("move",), "Missing argument"),
    (("move", "Q10"), "There is no axis Q; this machine has X, Y and Z"),
    (("move", "X"), "not a letter with a number"),
    (("move", "X1e9999"), "There is no axis E"),
    (("move", "X" + "9" * 400), "too large"),
    (("move", "X1", "X2"), "given twice"),
    (("move", "X10", "--relativ"), "--relativ"),
    (("move", "X400"), "whole travel"),
    (("move", "X1", "--feed", "0"), "feed is above 0"),
    (("move", "X1", "--feed", "nan"), "feed is above 0"),
    (("move", "X1", "--feed", "fast"), "--feed"),
    (("jog", "X", "0"), "longer than 0"),
    (("jog", "X", "0.001"), "at least one step"),
    (("jog", "X", "51"), "at most 50 mm"),
    (("jog", "X", "nan"), "not a letter with a number"),
    (("jog", "X", "1Y2"), "a jog is of one axis"),
    (("jog", "X", "1", "--feed", "0"), "feed is above 0"),
    (("jog", "W", "1"), "no axis W"),
    (("home", "Q"), "no axis Q"),
    (("zero", "xq"), "no axis Q"),
    (("run", "nothing.ngc"), "there is no such file"),
    (("run", "."), "is a folder"),
    (("check", "/dev/zero"), "is a pipe or a device"),
    (("run", "/dev/zero"), "is a pipe or a device"),
    (("gcode", "/dev/null"), "is a pipe or a device"),
    (("run", "a" * 5000), "there is no such file"),
    (("check", "a" * 5000), "there is no such file"),
    (("frame", "nul\0in.it"), "null byte"),
    (("run", "part.ngc/x"), "there is no such file"),
    (("move", "X1", "--config", "a" * 5000), "cannot be read: File name too long"),
    (("move", "X1", "--feed", "1e-320"), "from 0.0005 on"),
    (("move", "X1", "--feed", "9" * 5000), "from 0.0005 on"),
    (("move", "X" + "9" * 5000), "too large"),
    (("frame", "nothing.ngc"), "there is no such file"),
    (("gcode", "nothing.ngc"), "there is no such file"),
    (("mill",), "No such command"),
    (("run", "part.ngc", "--from-line", "0"), "--from-line"),
    (("run", "part.ngc", "--from-line", "2"), "add --yes"),
    (("run", "part.ngc", "--from-line", "99", "--yes"), "nothing to run from line 99"),
]


@pytest.mark.parametrize(("words", "said"), BAD_CALLS, ids=lambda said: str(said)[:60])
def test_a_wrong_call_is_refused(shop: Shop, words: tuple[str, ...], said: str) -> None:
    shop.file("G0 X5\nX6\nM2\n")
    result = shop.run(*words, state=words[0] not in ("mill", "gcode"))
    assert result.exit_code == 2, result.output
    assert said in result.stderr
    assert len(result.stderr) < 400
    assert not shop.kept().get("motion")
    assert shop.json("where")["position_steps"] == {"x": 0, "y": 0, "z": 0}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", "nothing"),
        (b"\x7fELF\x00\x00\x01", "binary file"),
        (b"G0 X1\n\x00", "line 2: this is a binary file"),
        (b"G0 X1\nG0 Xabc\n", "line 2: "),
        (b"G0 X1\nhello world\n", "line 2: "),
        (b"G1 X5\n", "line 1: "),
        (b"G0 X400\n", "line 1: "),
        (b"G0 X" + b"1" * 100_000, "longer than"),
        (b"O100 while [1]\nO100 endwhile\nM2\n", "line "),
        (b"O<a> sub\nO<a> call\nO<a> endsub\nO<a> call\nM2\n", "line "),
        (b"#1 = [1/0]\n", "line 1: "),
        (b"G0 X1\nG41 D1\nM2\n", "line 2: "),
        (b"x;y\n1;2\n1;fish\n", "line 3: "),
    ],
    ids=lambda text: text[:20],
)
def test_a_file_that_is_no_program_is_refused_before_anything_moves(
    shop: Shop, text: bytes, said: str
) -> None:
    path = shop.file(text, "points.csv" if text.startswith(b"x;") else "part.ngc")
    endless = b"while" in text
    for command in ("run",) if endless else ("run", "check", "frame"):
        result = shop.run(command, path)
        assert result.exit_code == 2, (command, result.output)
        # What takes long says so first.
        refused = [line for line in result.stderr.splitlines() if "takes a while" not in line]
        assert said in refused[0]
        assert str(path) in refused[0]
        assert len(refused[0]) < 400
    assert shop.json("where")["steps"] == {"x": 0, "y": 0, "z": 0}


def test_refused_in_json_is_one_object_too(shop: Shop) -> None:
    result = shop.run("jog", "X", "0", "--json")
    assert result.exit_code == 2
    values = json.loads(result.stdout.splitlines()[-1])
    assert values["status"] == "refused"
    assert "longer than 0" in values["message"]


def test_check_says_everything_it_knows(shop: Shop) -> None:
    path = shop.file("G21 G90\nG0 X10\nG1 X20 Y10 F600\nM2\n")
    values = shop.json("check", path)
    assert values["ok"] is True
    assert values["errors"] == []
    assert values["bounds_mm"] == {"x": [10, 20], "y": [0, 10], "z": [0, 0]}
    assert values["length_mm"] == pytest.approx(24.142, abs=1e-3)
    assert values["lines"] == 4
    assert values["blocks"] > 1
    assert values["duration_s"] > 2
    people = shop.run("check", path)
    assert people.stdout.splitlines()[-1] == "ok"


def test_check_names_the_line_that_leaves_the_travel(shop: Shop) -> None:
    shop.run("home")
    path = shop.file("G0 X10\nG1 X300 F600\nX5\nM2\n")
    result = shop.run("check", path, "--json")
    assert result.exit_code == 2
    values = json.loads(result.stdout.splitlines()[-1])
    assert values["ok"] is False
    assert [warning["line"] for warning in values["warnings"]] == [2]


def test_check_refuses_what_run_refuses(shop: Shop) -> None:
    shop.file('[run]\nunreferenced = "forbid"\n', "fraese.toml")
    path = shop.file("G0 X10\nM2\n")
    for command in ("check", "run"):
        result = shop.run(command, path)
        assert result.exit_code == 2
        assert "reference it first" in result.stderr


def test_run_says_all_that_is_wrong(shop: Shop) -> None:
    shop.run("home")
    result = shop.run("run", shop.file("G0 X10\nG77\nG0 X400\nG78\nM2\n"))
    assert result.exit_code == 2
    said = result.stderr.splitlines()
    assert [text.split(": ")[0].rsplit(" ", 1)[-1] for text in said[:-1]] == ["4", "3"]
    assert "line 2" in said[-1]


@pytest.mark.parametrize("name", ["bad.ngc", "nothing.ngc"])
def test_check_of_a_bad_file_is_an_object_with_its_errors(shop: Shop, name: str) -> None:
    shop.file("G0 X1\nG99 G98 X\n", "bad.ngc")
    result = shop.run("check", name, "--json")
    assert result.exit_code == 2
    values = json.loads(result.stdout.splitlines()[-1])
    assert values["ok"] is False
    assert values["errors"][0]["message"]
    assert values["errors"][0]["line"] == (2 if name == "bad.ngc" else 0)


def test_check_leaves_no_trace(shop: Shop) -> None:
    assert shop.run("check", shop.file("G0 X1\n")).exit_code == 0
    assert not shop.state.exists()


def test_gcode_prints_one_object_a_move(shop: Shop) -> None:
    path = shop.file("G0 X1\nG1 Y2 F100\nG2 X3 Y0 I0 J-2\nG4 P0.5\nM3 S9\nM0\nM2\n")
    result = shop.run("gcode", path, state=False)
    moves = [json.loads(line) for line in result.stdout.splitlines()]
    kinds = [move["kind"] for move in moves]
    assert kinds[:6] == ["rapid", "feed", "arc", "dwell", "spindle", "pause"]
    assert kinds[-1] == "end"
    assert moves[1] == {"line": 2, "kind": "feed", "to": [1, 2, 0], "feed_mm_min": 100} or (
        moves[1]["to"] in ([1.0, 2.0, 0.0], {"x": 1.0, "y": 2.0, "z": 0.0})
    )
    assert {"centre", "plane", "turns"} <= set(moves[2])


def test_from_line_says_what_it_will_do(shop: Shop) -> None:
    shop.run("home")
    path = shop.file("G0 Z-2\nX10\nG1 Z-5 F120\nX20\nX30\nM2\n")
    result = shop.run("run", path, "--from-line", 5, "--yes")
    assert result.exit_code == 0
    assert "rapid to X 20.000 Y 0.000 Z 0.000 mm (machine)" in result.stderr
    assert shop.json("where")["position_mm"] == {"x": 30, "y": 0, "z": -5}


def test_an_alarm_is_exit_code_1_and_the_state_is_kept(shop: Shop) -> None:
    shop.run("move", "Z29")
    result = shop.run("jog", "Z", "2", "--json")
    assert result.exit_code == 1
    values = json.loads(result.stdout.splitlines()[-1])
    assert values["status"] == "alarm"
    assert "zmax" in values["message"]
    alarm = values["alarm"]
    assert (alarm["number"], alarm["name"], alarm["trust"]) == (10, "end_switch", "ramped")
    assert alarm["parameters"] == {"ends": ["zmax"]}
    assert "alarm" not in shop.json("where")
    assert shop.json("where")["position_mm"]["z"] == pytest.approx(30, abs=0.3)
    assert shop.run("move", "X1").exit_code == 2
    assert shop.run("home").exit_code == 0


def test_stream_starts_at_once_and_stops_at_the_refused_line(shop: Shop) -> None:
    path = shop.file("G0 X5\nX6\nG99 G98 X7\nX8\n")
    result = shop.run("run", path, "--stream", "--json")
    assert result.exit_code == 1
    values = json.loads(result.stdout.splitlines()[-1])
    assert values["status"] == "alarm"
    assert "line 3" in values["message"]


def test_questions_are_answered_for_scripts(shop: Shop) -> None:
    result = shop.run("run", shop.file("G0 X1\nM0\nT1 M6\nX2\n(MSG,ready)\nM2\n"), "--yes")
    assert result.exit_code == 0
    assert "Program stop in line 2" in result.stderr
    assert "put in tool 1" in result.stderr
    assert result.stderr.count("ready") == 1
    assert shop.json("where")["position_mm"]["x"] == 2


def test_what_is_said_is_said_once(shop: Shop) -> None:
    result = shop.run("home")
    assert result.stderr.count("Referenced: Z, X, Y.") == 1
    assert result.stdout == "done: X 0.000 Y 0.000 Z 0.000 mm\n"


@pytest.mark.parametrize("text", ["[axes.x]\nfoo = 1\n", "[axes.x]\npitch_mm = 0\n", "[", "\xff"])
@pytest.mark.parametrize("command", [("where",), ("move", "X1"), ("config", "check")])
def test_a_bad_configuration_stops_every_command(
    shop: Shop, text: str, command: tuple[str, ...]
) -> None:
    path = shop.file(text.encode("latin-1"), "bad.toml")
    result = shop.run(*command, "--config", path, state=command[0] != "config")
    assert result.exit_code == 2
    assert len(result.stderr.strip().splitlines()) == 1
    assert str(path) in result.stderr
    assert shop.kept() == {}


def test_the_keys_of_the_app_are_listed_and_checked(shop: Shop) -> None:
    shop.file('[keys]\ngo_to = ["f8", "g"]\n', "fraese.toml")
    assert shop.run("config", "check", state=False).stdout == "fraese.toml: ok\n"
    listed = shop.run("config", "keys", state=False).stdout.splitlines()
    assert [line.split()[:3] for line in listed if line.startswith("go_to ")] == [
        ["go_to", "F8", "g"]
    ]
    shop.file('[keys]\ngo_to = "escape"\n', "fraese.toml")
    result = shop.run("config", "check", state=False)
    assert result.exit_code == 2
    assert "fraese.toml: keys.go_to: escape always stops; choose another key." in result.stderr
    shop.file("[keys]\ngo_to = []\n", "fraese.toml")
    assert "keys.go_to: must have at least 1 item, not 0." in shop.run("where").stderr


def test_config_check_schema_and_default(shop: Shop) -> None:
    assert "built-in defaults" in shop.run("config", "check", state=False).stdout
    default = shop.run("config", "default", state=False).stdout
    shop.file(default, "fraese.toml")
    assert shop.run("config", "check", state=False).stdout == "fraese.toml: ok\n"
    schema = json.loads(shop.run("config", "schema", state=False).stdout)
    assert "axes" in schema["properties"]


def test_a_damaged_state_and_one_that_cannot_be_written(shop: Shop) -> None:
    shop.run("move", "X1")
    (shop.state / "simulation.journal").write_text("{")
    result = shop.run("where")
    assert result.exit_code == 2
    assert "--fresh" in result.stderr
    assert shop.run("where", "--fresh").exit_code == 0
    assert shop.run("where").exit_code == 0
    blocked = shop.folder / "blocked"
    blocked.write_text("")
    result = shop.run("move", "X1", "--fresh", "--state", blocked / "below", state=False)
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr


def test_only_what_moves_says_that_it_moves(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    moving: list[bool] = []
    write = Keeping.write

    def watched(keeping: Keeping, state: SavedState, durable: bool) -> None:
        moving.append(state.motion is not None)
        write(keeping, state, durable)

    monkeypatch.setattr(Keeping, "write", watched)
    shop.run("where")
    assert moving == []
    shop.run("zero", "x")
    shop.run("jog", "X", "0")
    assert moving == [False, False]
    shop.run("jog", "X", "1")
    assert moving[2] is True
    assert moving[-1] is False


def test_two_equal_commands_print_the_same(shop: Shop) -> None:
    path = shop.file("G0 X20\nG2 X10 Y10 I-10 F600\nM2\n")
    first = shop.run("run", path, "--fresh", "--json").stdout
    assert shop.run("run", path, "--fresh", "--json").stdout == first


def test_the_log_is_written_where_configured(shop: Shop) -> None:
    log = shop.folder / "here.log"
    config = shop.file(f'[log]\nenabled = true\nfile = "{log}"\n', "log.toml")
    assert shop.run("jog", "X", "1", "--config", config).exit_code == 0
    assert "jog" in log.read_text()
    config.write_text(f'[log]\nenabled = true\nfile = "{shop.folder}"\n')
    result = shop.run("jog", "X", "1", "--config", config)
    assert result.exit_code == 2
    assert "the log cannot be written" in result.stderr


def test_without_a_terminal_the_app_says_so(shop: Shop) -> None:
    result = shop.run(state=False)
    assert result.exit_code == 2
    assert "terminal" in result.stderr


def test_help_is_there_for_every_command(shop: Shop) -> None:
    for words in ([], ["run"], ["move"], ["config"], ["config", "schema"]):
        result = shop.run(*words, "-h", state=False)
        assert result.exit_code == 0
        assert "Usage" in result.stdout


def test_a_file_that_may_not_be_read(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program; and a configuration, which is not silently none."""
    path, config = shop.file("G0 X1\n"), shop.file("", "fraese.toml")
    monkeypatch.chdir(path.parent)
    for each in (path, config):
        each.chmod(0)
    with as_nobody(path.parent):
        with pytest.raises(ProgramError, match="Permission denied"):
            open_program(Path(path.name))
        with pytest.raises(ConfigError, match="Permission denied"):
            load(None)


def test_the_result_says_what_makes_the_work_coordinates(shop: Shop) -> None:
    shop.file("[tools.3]\nlength_mm = 12.5\n", "fraese.toml")
    assert shop.run("home").stdout == "done: X 0.000 Y 0.000 Z 0.000 mm\n"
    part = shop.file("G10 L2 P2 X20 R90\nM61 Q3\nG43\nG55\nG0 X10\nG10 L2 P1 X20 R90\nG92 Y1\nM2\n")
    assert shop.run("run", part).exit_code == 0
    values = shop.json("where")
    assert values["position_mm"] == {"x": 0, "y": 10, "z": 0}
    assert values["work_mm"] == pytest.approx({"x": 10, "y": 1, "z": -12.5})
    assert values["work"] == {
        "system": "G54",
        "rotation_deg": 90,
        "g92": True,
        "tool": 3,
        "tool_length_mm": 12.5,
    }
    said = "done: X 10.000 Y 1.000 Z -12.500 mm"
    said += " (rotated by 90 degrees, G92, tool 3, tool length 12.5 mm)\n"
    assert shop.run("where").stdout == said
