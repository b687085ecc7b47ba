"""The configuration file: strict, bounded, and the same as what it prints of itself."""

import contextlib
import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_origin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.assembly import assemble
from fraese.config import Config
from fraese.config import file as configuration
from fraese.config.axes import AxisName
from fraese.config.file import from_table, load
from fraese.config.section import Section
from fraese.config.switches import StatusPin
from fraese.errors import ConfigError
from fraese.motor.pins import STATUS_PINS
from fraese.workframe import LETTERS

ROOT = Path(__file__).parents[2]


def written(folder: Path, text: str) -> Path:
    path = folder / "fraese.toml"
    path.write_text(text, "utf-8")
    return path


def test_what_is_printed_loads_and_equals_the_defaults(tmp_path: Path) -> None:
    assert load(written(tmp_path, configuration.annotated())) == Config()


def test_the_file_in_the_root_is_what_is_printed() -> None:
    assert (ROOT / "fraese.toml").read_text("utf-8") == configuration.annotated()


def test_what_is_commented_out_is_valid_when_it_is_not(tmp_path: Path) -> None:
    """Also the examples are values that may be given; each on its own."""
    section = ""
    tried = 0
    for line in configuration.annotated().splitlines():
        if line.startswith(("[", "#[")):
            section = line.removeprefix("#")
        if line.startswith("#") and " = " in line and not line.startswith("# "):
            text = f"{section}\n{line[1:]}\n"
            if section:
                load(written(tmp_path, text))
                tried += 1
    assert tried >= 5


def test_every_key_has_a_sentence() -> None:
    for line in configuration.annotated().splitlines():
        assert len(line) < 160
    for model in json.loads(json.dumps(configuration.schema()))["$defs"].values():
        for name, field in model["properties"].items():
            assert field.get("description", "").endswith("."), name


def test_every_bound_is_in_the_schema() -> None:
    axis = configuration.schema()["$defs"]["LinearAxis"]["properties"]
    assert axis["steps_per_rev"]["minimum"] == 1
    assert axis["max_rate_hz"]["exclusiveMinimum"] == 0


def test_one_key_of_an_axis_leaves_the_others_at_their_defaults(tmp_path: Path) -> None:
    config = load(written(tmp_path, "[axes.z]\npitch_mm = 3.0\n"))
    assert config.axes.table["z"].home_end == "max"
    assert config.axes.table["z"].travel == 60
    assert config.axes.table["x"] == Config().axes.table["x"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("axess = 1", "unknown key axess; known here: axes, card"),
        ("[axes.x]\nstep_per_rev = 400", "unknown key axes.x.step_per_rev; known here: acc"),
        ("[axes.q]\npitch_mm = 2", "unknown key axes.q; known here: a, b, c, names, u, v, w, x"),
        ("[axes.a]\npitch_mm = 2", 'axes.a: is not among axes.names; add it there: names = ["x", '),
        ('[axes]\nnames = ["x", "q"]', "axes.names.1: must be 'x', 'y', 'z', 'a', "),
        ('[axes]\nnames = ["x", "x"]', "axes.names: names an axis twice"),
        ("[axes]\nnames = []", "axes.names: "),
        ('[axes]\nnames = ["x", "y", "z", "a", "b"]', "axes.names: "),
        ('[axes]\nnames = ["x", "y", "z", "a"]', 'card.kind "smc1500" drives 3 motors at most'),
        ('[axes]\nnames = ["z"]\n[axes.z]\nmotor = 4', 'no socket of card.kind "smc1500"'),
        ("[axes.y]\nmotor = 1", "axes.x.motor and axes.y.motor are both 1"),
        ("[axes.x]\ntravel_deg = 90", "axes.x: travel_deg belongs to a rotary axis; this one has"),
        ('[axes.x]\nkind = "rotary"\npitch_mm = 2', "pitch_mm belongs to a linear axis"),
        ('[axes.x]\nkind = "round"', 'axes.x: an axis is a table, its kind "linear" or "rotary"'),
        ('[axes.x]\nkind = "rotary"\nend_switches = true', "an endless axis has no end switches"),
        ('[axes.x]\nkind = "rotary"\nfoo = 1', "unknown key axes.x.foo; known here: acceleration"),
        ('[axes.x]\nkind = "rotary"\ntravel_deg = 1e9', "axes.x.travel_deg: "),
        ('[axes]\nnames = ["x", "y"]\n[run]\nsafe_z_mm = 0', "there is no z in axes.names"),
        (
            '[axes.x]\nend_switches = false\n[homing]\norder = ["x"]',
            'homing.order names "x", which has no end switches: leave it out',
        ),
        ("[tools.1]\nlenght_mm = 2", "unknown key tools.1.lenght_mm; known here: diameter_mm"),
        ("[axes.x]\npitch_mm = 0", "axes.x.pitch_mm: "),
        ("[axes.x]\npitch_mm = -2.5", "not -2.5"),
        ("[axes.x]\npitch_mm = inf", "axes.x.pitch_mm: "),
        ("[axes.x]\npitch_mm = nan", "axes.x.pitch_mm: "),
        ("[axes.x]\npitch_mm = 1e-99999999", "axes.x.pitch_mm: "),
        ("[axes.x]\ntravel_mm = 1e99999999", "axes.x.travel_mm: "),
        ("[axes.x]\nbacklash_mm = 1e-99999999", "axes.x.backlash_mm: "),
        ("[axes.x]\nsteps_per_rev = 0", "axes.x.steps_per_rev: "),
        ("[axes.x]\nsteps_per_rev = 400.5", "axes.x.steps_per_rev: "),
        ("[axes.x]\nsteps_per_rev = 99999999999999999999999999", "axes.x.steps_per_rev: "),
        ('[axes.x]\ngear = "0"', "axes.x.gear: must be a positive number or ratio"),
        ('[axes.x]\ngear = "1/0"', "axes.x.gear: "),
        ('[axes.x]\ngear = "0/3"', "axes.x.gear: "),
        ('[axes.x]\ngear = "-2"', "axes.x.gear: "),
        ('[axes.x]\ngear = "1e999999999"', "axes.x.gear: "),
        ("[axes.x]\ngear = 1e999999999", "axes.x.gear: "),
        ("[axes.x]\ngear = true", "axes.x.gear: "),
        ('[axes.x]\ngear = "1/999999999"', "axes.x give its travel"),
        ("[axes.x]\nstart_rate_hz = 5000", "start_rate_hz (5000) must not be above"),
        ("[axes.x]\nmax_rate_hz = 1e400", "axes.x.max_rate_hz: "),
        ("[axes.x]\nacceleration_hz_s = nan", "axes.x.acceleration_hz_s: "),
        ("[axes.x]\navoid_hz = [[900, 800]]", "a lower and a higher rate"),
        ("[axes.x]\navoid_hz = [[900]]", "axes.x.avoid_hz"),
        ("[axes]\nx = 5", "axes.x: must be a table, not 5."),
        ("axes = 5", "axes: must be a table, not 5."),
        ('[axes]\nnames = "xyz"', "axes.names: must be a list, not xyz."),
        ('[axes.x]\nmotor = "two"', "axes.x.motor: must be a whole number, not two."),
        ("[axes.x]\nmotor = 1.5", "axes.x.motor: must be a whole number, not 1.5."),
        ("[axes.x]\nmotor = true", "axes.x.motor: must be a whole number, not true."),
        ("[axes.x]\npitch_mm = true", "axes.x.pitch_mm: must be a number, not true."),
        ("[axes.x]\nmax_rate_hz = true", "axes.x.max_rate_hz: must be a number, not true."),
        ("[axes.x]\navoid_hz = [[false, 9]]", "axes.x.avoid_hz.0.0: must be a number, not false."),
        ("[switches]\nreadings = true", "switches.readings: must be a whole number, not true."),
        ("[switches]\nclosed_reads = true", "switches.closed_reads: must be 0 or 1, not true."),
        ("[outputs.spindle]\npin = true", "outputs.spindle.pin: must be "),
        ("[realtime]\ncore = true", "realtime.core: must be a whole number, not true."),
        ("[log]\nfile = true", "log.file: must be a text in quotes, not true."),
        ('[axes.x]\nend_switches = "nope"', "must be true or false, not nope."),
        ("[axes.x]\navoid_hz = [[3, 4, 5]]", "axes.x.avoid_hz.0: must have at most 2 items"),
        ("[axes.x]\ntravel_mm = 4", "leaves nothing of axes.x.travel_mm"),
        ("[homing]\npull_off_mm = 30", "leaves nothing of axes.z.travel_mm"),
        ('[homing]\norder = ["x", "x"]', "names an axis twice"),
        ("[homing]\norder = []", "homing.order: "),
        ('[homing]\norder = ["x", "q"]', "homing.order.1: "),
        ('[homing]\norder = ["x", "a"]', 'homing.order names "a", which is not among axes.names'),
        ("[switches]\npin = 14", "switches.pin: "),
        ("[switches]\nclosed_reads = 2", "switches.closed_reads: "),
        ("[switches]\nreadings = 0", "switches.readings: "),
        ("[probe]\npin = 11\nclosed_reads = 1", "on the same pin; leave out probe.pin"),
        ("[outputs.spindle]\npin = 1", "outputs.spindle.pin 1 is taken already"),
        ("[outputs.spindle]\nactive_high = true", "outputs.spindle.pin: must be given."),
        ("[outputs]\nspindle = { pin = 14 }\ncoolant = { pin = 14 }", "outputs.coolant.pin 14"),
        ('[card]\nkind = "stepdir"\n[outputs]\nspindle = { pin = 17 }', "17 is taken already"),
        (
            '[port]\nkind = "ppdev"\n[outputs]\nlaser = { pin = 14, pwm = true }',
            "outputs.laser.pwm needs port.kind bridge; with ppdev a laser is on or off",
        ),
        (
            '[port]\nkind = "bridge"\n[outputs]\nlaser = { pin = 16, pwm = true }',
            "outputs.laser.pwm needs outputs.laser.pin 14, not 16",
        ),
        ("[outputs]\nlaser = { pin = 14, pwm_hz = 50 }", "outputs.laser.pwm_hz: "),
        ("[outputs]\nlaser = { pin = 14, power_max_s = 0 }", "outputs.laser.power_max_s: "),
        ('[card]\nkind = "smc2000"', "card.kind: "),
        ('[port]\nkind = "usb"', "port.kind: must be 'simulation', 'ppdev', 'devport' or 'bridge'"),
        ('[port]\ndevice = "parport0"', "port.device: must be the full path of a device file"),
        ('[port]\ndevice = "/dev/par\\u0000"', "port.device: must be the full path"),
        ("[port]\nbase = 0x37A", "port.base: must be a multiple of 4, not 890"),
        ("[port]\nbase = 0x60", "port.base: "),
        ("[port]\nbase = 0x10000", "port.base: "),
        ("[run]\nsafe_z_mm = 5", "outside the travel of Z, -56 to 0 mm"),
        ("[run]\nlead_s = 0", "run.lead_s: "),
        ('[tools."1.5"]\nlength_mm = 2', "tools: tools are named by number"),
        ('[tools."' + "9" * 5000 + '"]\nlength_mm = 2', "tools"),
        ('[log]\nenabled = "perhaps"', "log.enabled: "),
        ('[card]\ntable = "x\\ny"', "card.table: "),
        ("[axes.x", "is not valid TOML"),
        ("[axes.x]\npitch_mm = 2\npitch_mm = 3", "is not valid TOML"),
        ("x = " + "[" * 200_000, "brackets are nested too deep"),
        ("x = " + "9" * 5000, "a number is too long"),
    ],
    ids=lambda text: text[:40],
)
def test_what_is_wrong_is_said_in_one_sentence(tmp_path: Path, text: str, said: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ConfigError) as caught:
        assemble(load(path))
    sentence = str(caught.value)
    assert said in sentence
    assert "\n" not in sentence
    assert len(sentence) < 500
    assert sentence.endswith(".")


#: Tables of which there may be several, and one of them.
_SEVERAL = {"tools": "tools.1", "axes": "axes.x", "solids": "solids.plate", "own": "own.air"}


def keys_of(section: type[Section], place: str = "") -> Iterator[tuple[str, Any]]:
    """Every key that is no table, and what it may be."""
    for key, field in section.model_fields.items():
        kinds = [field.annotation, *get_args(field.annotation)]
        table = next((x for x in kinds if isinstance(x, type) and issubclass(x, Section)), None)
        if table and get_origin(field.annotation) is tuple:
            continue  # a list of tables: its keys have no names that a table could have
        if table:
            named = _SEVERAL[key] if get_origin(field.annotation) is dict else key
            yield from keys_of(table, f"{place}{named}.")
        else:
            yield f"{place}{key}", field.annotation


def test_true_is_taken_by_no_key_but_a_switch() -> None:
    keys = dict(keys_of(Config))
    assert len(keys) > 60
    # It was a switch once.
    del keys["run.confirm_spindle"]
    for key, kind in keys.items():
        *tables, last = key.split(".")
        # What must be given is not what is looked for.
        raw: dict[str, Any] = {"pin": 14} if tables == ["outputs", "laser"] else {}
        raw[last] = True
        for table in reversed(tables):
            raw = {table: raw}
        said = ""
        try:
            from_table(raw, "file")
        except ConfigError as error:
            said = str(error)
        assert said.startswith(f"file: {key}") != (kind is bool), key


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="there is no such configuration file"):
        load(tmp_path / "nothing.toml")
    with pytest.raises(ConfigError, match="is no plain file"):
        load(tmp_path)
    path = tmp_path / "latin.toml"
    path.write_bytes("# größer\n".encode("latin-1"))
    with pytest.raises(ConfigError, match="not a text file in UTF-8"):
        load(path)


def test_the_named_file_comes_before_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "user"))
    monkeypatch.chdir(tmp_path)
    assert configuration.find_file() is None
    user = tmp_path / "user" / "fraese"
    user.mkdir(parents=True)
    written(user, "[jog]\nmax_mm = 3\n")
    assert load().jog.max_mm == 3
    written(tmp_path, "[jog]\nmax_mm = 4\n")
    assert load().jog.max_mm == 4
    other = tmp_path / "other.toml"
    other.write_text("[jog]\nmax_mm = 5\n")
    assert load(other).jog.max_mm == 5


def test_the_example_of_another_axis_loads(tmp_path: Path) -> None:
    lines = configuration.annotated().splitlines()
    example = [line.removeprefix("#").strip() for line in lines if line.startswith("#     ")]
    config = load(written(tmp_path, "\n".join(example)))
    assert config.axes.names == ("x", "y", "z", "a")
    a = config.axes.table["a"]
    assert (a.kind, a.travel, a.has_switches, a.motor) == ("rotary", None, False, 4)
    assert a.steps_per_unit() == 100
    assert config.home_order == ("z", "x", "y")


def test_a_configuration_of_three_axes_by_their_tables_alone_means_what_it_did(
    tmp_path: Path,
) -> None:
    config = load(written(tmp_path, "[axes.x]\n[axes.z]\ninverted = true\n"))
    assert config.axes.names == ("x", "y", "z")
    assert [axis.travel for axis in config.axes.table.values()] == [300, 200, 60]
    assert [axis.home_end for axis in config.axes.table.values()] == ["min", "min", "max"]
    assert config.axes.sockets == (0, 1, 2)
    assert config.home_order == ("z", "x", "y")


def test_motors_are_swapped_by_two_numbers(tmp_path: Path) -> None:
    config = load(written(tmp_path, "[axes.x]\nmotor = 2\n[axes.y]\nmotor = 1\n"))
    assert config.axes.sockets == (1, 0, 2)
    config = load(written(tmp_path, '[axes]\nnames = ["y", "w"]\n[axes.w]\nmotor = 3\n'))
    assert config.axes.sockets == (0, 2)


def test_what_has_no_switches_is_not_in_the_reference_run(tmp_path: Path) -> None:
    text = '[card]\nkind = "stepdir"\n[axes]\nnames = ["x", "c", "z", "u"]\n'
    assert load(written(tmp_path, text)).home_order == ("z", "x", "u")
    text += "[axes.u]\nend_switches = false\n"
    assert load(written(tmp_path, text)).home_order == ("z", "x")
    text += "[axes.c]\ntravel_deg = 90\nend_switches = true\n"
    assert load(written(tmp_path, text)).home_order == ("z", "x", "c")


def test_decimals_are_read_exactly(tmp_path: Path) -> None:
    config = load(written(tmp_path, "[axes.x]\npitch_mm = 0.1\ngear = 2.5\n"))
    assert config.axes.table["x"].steps_per_unit() == 10_000


@given(st.text(max_size=60))
def test_no_text_whatever_is_a_surprise(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fraese.toml"
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        with contextlib.suppress(ConfigError):
            load(path)


def test_what_a_type_has_to_spell_out_is_what_the_table_says() -> None:
    assert "".join(get_args(AxisName)) == LETTERS
    assert set(get_args(StatusPin)) == set(STATUS_PINS)


def test_what_stands_where_a_configuration_would_is_never_taken_for_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the built-in simulation would run, and nobody were told."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "none"))
    place = tmp_path / "fraese.toml"
    assert load() == Config()
    place.mkdir()
    with pytest.raises(ConfigError, match="is no plain file"):
        load()
    place.rmdir()
    os.mkfifo(place)
    with pytest.raises(ConfigError, match="is no plain file"):
        load()
    place.unlink()
    place.symlink_to("fraese.toml")
    with pytest.raises(ConfigError, match=r"Too many levels|is no plain file"):
        load()


def test_subroutine_folders_are_whole_paths(tmp_path: Path) -> None:
    config = from_table({"run": {"subroutine_folders": [str(tmp_path), "~/gcode"]}}, "file")
    assert config.run.folders == (tmp_path, Path.home() / "gcode")
    with pytest.raises(ConfigError, match='"subs" is no whole path'):
        from_table({"run": {"subroutine_folders": ["subs"]}}, "file")


def test_only_free_m_codes_can_be_ignored() -> None:
    with pytest.raises(ConfigError, match="M62 is none of M100 to M199"):
        from_table({"run": {"ignored_m_codes": [101, 62]}}, "file")
