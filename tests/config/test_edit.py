"""The configuration file, changed in place: comments stay, what would be refused is not written."""

import stat
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path

import pytest

from fraese.config.edit import Change, Value, file_to_write, set_keys
from fraese.config.file import load
from fraese.errors import ConfigError

COMMENTED = """\
# My mill.
[card]
kind = "smc1500"   # the old one

[axes.x]           # left and right
# measured in May
pitch_mm = 2.0     # per turn
travel_mm = 300

[log]
enabled = true
"""


def written(path: Path, text: str, values: Mapping[str, Change]) -> str:
    path.write_text(text, "utf-8")
    set_keys(path, values)
    return path.read_text("utf-8")


def test_only_the_value_changes(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    text = written(path, COMMENTED, {"axes.x.pitch_mm": Decimal("1.9950")})
    assert text == COMMENTED.replace("pitch_mm = 2.0 ", "pitch_mm = 1.9950 ")
    assert load(path).axes.table["x"].pitch == Decimal("1.9950")


def test_a_new_key_stands_in_its_table_and_a_new_table_at_the_end(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    values: dict[str, Value] = {
        "axes.x.avoid_hz": ((250.0, 420.5), (900, 1100)),
        "axes.y.backlash_mm": Decimal("0.04"),
        "homing.measure": True,
    }
    text = written(path, COMMENTED, values)
    for line in COMMENTED.splitlines():
        assert line in text.splitlines()
    config = load(path)
    assert config.axes.table["x"].avoid_hz == ((250, 420.5), (900, 1100))
    assert config.axes.table["y"].backlash == Decimal("0.04")
    assert config.axes.table["y"].travel == 200, "what is not named keeps its default"
    assert config.homing.measure
    assert config.log.enabled


@pytest.mark.parametrize(
    "text",
    [
        "",
        "axes.x.pitch_mm = 3",
        "axes.x = {pitch_mm = 3, travel_mm = 250} # short",
        "[axes]\nx.pitch_mm = 3\n",
        "[axes]\nnames = ['x', 'y', 'z']\n",
        "[axes.y]\npitch_mm = 3\n[log]\nenabled = true\n[axes.z]\npitch_mm = 4\n",
        "[log]\r\nenabled = true\r\n",
    ],
)
def test_however_the_table_is_written(tmp_path: Path, text: str) -> None:
    path = tmp_path / "fraese.toml"
    changed = written(path, text, {"axes.x.pitch_mm": 5, "axes.x.backlash_mm": Decimal("0.1")})
    x = load(path).axes.table["x"]
    assert (x.pitch, x.backlash) == (Decimal(5), Decimal("0.1")), changed
    assert changed.count("short") == text.count("short")
    assert changed.count("enabled") == text.count("enabled")


def test_what_would_be_refused_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text(COMMENTED, "utf-8")
    with pytest.raises(ConfigError, match=r"axes\.x\.pitch_mm: must be greater than 0, not -1"):
        set_keys(path, {"axes.x.pitch_mm": -1})
    with pytest.raises(ConfigError, match=r"unknown key axes\.x\.colour"):
        set_keys(path, {"axes.x.colour": "red"})
    with pytest.raises(ConfigError, match="cannot be changed"):
        set_keys(path, {"card.kind.of": 1})
    assert path.read_text("utf-8") == COMMENTED
    assert [each.name for each in tmp_path.iterdir()] == ["fraese.toml"]


def test_a_broken_file_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text("[axes.x\n", "utf-8")
    with pytest.raises(ConfigError, match="cannot be changed"):
        set_keys(path, {"axes.x.pitch_mm": 5})
    assert path.read_text("utf-8") == "[axes.x\n"
    with pytest.raises(ConfigError, match="is no plain file"):
        set_keys(tmp_path, {"axes.x.pitch_mm": 5})


def test_a_link_stays_a_link_and_the_mode_is_kept(tmp_path: Path) -> None:
    real = tmp_path / "real.toml"
    real.write_text(COMMENTED, "utf-8")
    real.chmod(0o600)
    link = tmp_path / "fraese.toml"
    link.symlink_to(real)
    set_keys(link, {"axes.x.pitch_mm": 4})
    assert link.is_symlink()
    assert stat.S_IMODE(real.stat().st_mode) == 0o600
    assert load(real).axes.table["x"].pitch == 4


def test_without_a_file_one_is_made_where_it_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    path = file_to_write()
    assert path == tmp_path / "config" / "fraese" / "fraese.toml"
    set_keys(path, {"axes.x.pitch_mm": 4})
    assert load().axes.table["x"].pitch == 4
    assert file_to_write() == path
    Path("fraese.toml").write_text("", "utf-8")
    assert file_to_write() == Path("fraese.toml")


def test_a_key_is_taken_away_and_so_is_a_table_the_rest_stays(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    text = COMMENTED + "\n[tools.1] # short\nlength_mm = 3\n\n[tools.2] # long\nlength_mm = 9\n"
    assert written(path, text, {"tools.1": None}) == text.replace(
        "[tools.1] # short\nlength_mm = 3\n\n", ""
    )
    set_keys(path, {"axes.x.pitch_mm": None, "tools.2": None})
    assert load(path).tools == {}
    assert "# measured in May" in path.read_text("utf-8")
