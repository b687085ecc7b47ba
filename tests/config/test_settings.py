"""Every key of the file to be looked at, typed anew, and taken out again."""

import os
from contextlib import suppress
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.config import Config
from fraese.config.file import annotated, load
from fraese.config.settings import Setting, SettingsFile, as_meant
from fraese.errors import ConfigError

COMMENTED = """\
# My mill.
[jog]            # by hand
feed_mm_min = 500   # calm
[tools.3]
length_mm = 12.5
"""


def opened(folder: Path, text: str | None = COMMENTED) -> tuple[SettingsFile, dict[str, Setting]]:
    path = folder / "fraese.toml"
    path.write_text(text or "", "utf-8")
    file = SettingsFile(path)
    return file, {each.key: each for each in file.read()}


def test_every_key_is_there_once_with_its_sentence(tmp_path: Path) -> None:
    file, found = opened(tmp_path, annotated())
    assert len(found) == len(file.read())
    assert {"axes.z.travel_mm", "jog.max_mm", "run.safe_z_mm", "log.file", "tools"} <= set(found)
    # What is written for editors has a key for each line that assigns something.
    assigned = [line for line in annotated().splitlines() if " = " in line and line[0] not in "#["]
    assert len(found) >= len(assigned)
    assert all(each.sentence.endswith(".") for each in found.values() if each.name != "kind")
    assert all(each.value == each.default for each in found.values())


def test_what_the_file_says_and_what_it_does_not(tmp_path: Path) -> None:
    _, found = opened(tmp_path)
    feed, most = found["jog.feed_mm_min"], found["jog.max_mm"]
    assert (feed.value, feed.default, feed.given) == ("500", "600", True)
    assert (most.value, most.default, most.given) == ("50", "50", False)
    assert (feed.table, feed.name, feed.bounds) == ("jog", "feed_mm_min", "above 0")
    assert found["tools.3.length_mm"].value == "12.5"
    assert found["axes.y.travel_mm"].default == "200", "the axis' own default"
    assert found["card.kind"].choices == ("smc1500", "stepdir")


def test_a_value_is_changed_and_comments_stay(tmp_path: Path) -> None:
    file, found = opened(tmp_path)
    assert file.write(found["jog.feed_mm_min"], "450,5").jog.feed_mm_min == 450.5
    assert (tmp_path / "fraese.toml").read_text() == COMMENTED.replace("= 500 ", "= 450.5 ")
    file.write(found["axes.x.pitch_mm"], "2.5")
    assert load(tmp_path / "fraese.toml").axes.table["x"].pitch == Decimal("2.5")


def test_taken_out_its_default_holds(tmp_path: Path) -> None:
    file, found = opened(tmp_path)
    assert file.write(found["jog.feed_mm_min"], None).jog.feed_mm_min == 600
    assert "# by hand" in (tmp_path / "fraese.toml").read_text()
    assert file.write(found["jog.max_mm"], None) == file.write(found["run.safe_z_mm"], None)


def test_a_key_that_is_in_no_list(tmp_path: Path) -> None:
    file, _ = opened(tmp_path)
    config = file.write(file.other("tools.7.diameter_mm"), "3")
    assert config.tools["7"].diameter_mm == 3
    with pytest.raises(ConfigError, match=r"unknown key jog\.colour"):
        file.check(file.other("jog.colour"), "red")
    with pytest.raises(ConfigError, match=r"jog\.feed_mm_min\.x: there is no such place"):
        file.check(file.other("jog.feed_mm_min.x"), "1")


@pytest.mark.parametrize(
    ("key", "typed", "sentence"),
    [
        ("jog.feed_mm_min", "-3", "jog.feed_mm_min: must be greater than 0, not -3."),
        ("jog.feed_mm_min", "fast", "jog.feed_mm_min: must be a number, not fast."),
        ("jog.feed_mm_min", "", "jog.feed_mm_min: type a value."),
        ("card.kind", "smc99", "card.kind: must be 'smc1500' or 'stepdir', not smc99."),
        ("axes.names", '["x"', "axes.names"),
        ("run.safe_z_mm", "500", "run.safe_z_mm (500) is outside the travel of Z"),
    ],
)
def test_what_would_not_do_is_said_as_at_the_start(
    tmp_path: Path, key: str, typed: str, sentence: str
) -> None:
    file, found = opened(tmp_path)
    with pytest.raises(ConfigError) as refused:
        file.check(found[key], typed)
    assert sentence in str(refused.value)
    with pytest.raises(ConfigError):
        file.write(found[key], typed)
    assert (tmp_path / "fraese.toml").read_text() == COMMENTED


def test_a_file_that_has_changed_meanwhile_is_not_written_over_unseen(tmp_path: Path) -> None:
    file, found = opened(tmp_path)
    path = tmp_path / "fraese.toml"
    theirs = COMMENTED + "[log]\nenabled = true\n"
    path.write_text(theirs)
    with pytest.raises(ConfigError, match="changed by somebody else meanwhile; nothing was"):
        file.write(found["jog.feed_mm_min"], "450")
    assert path.read_text() == theirs
    file.write(found["jog.feed_mm_min"], "450")
    assert path.read_text() == theirs.replace("500", "450"), "theirs is kept"


def test_a_file_that_is_gone_is_made_anew_at_the_second_attempt(tmp_path: Path) -> None:
    file, found = opened(tmp_path)
    path = tmp_path / "fraese.toml"
    path.unlink()
    with pytest.raises(ConfigError, match="is not there any more; nothing was written"):
        file.write(found["jog.feed_mm_min"], "450")
    assert not path.exists()
    assert not file.is_there
    file.write(found["jog.feed_mm_min"], "450")
    assert load(path).jog.feed_mm_min == 450


def test_without_a_file_one_is_made_where_it_is_looked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    file = SettingsFile()
    found = {each.key: each for each in file.read()}
    assert not file.is_there
    assert file.path == str(tmp_path / "config" / "fraese" / "fraese.toml")
    file.write(found["jog.max_mm"], "5")
    assert file.is_there
    assert load().jog.max_mm == 5


def test_what_cannot_be_written_or_read_is_one_sentence(tmp_path: Path) -> None:
    file, found = opened(tmp_path)
    path = tmp_path / "fraese.toml"
    path.chmod(0o444)
    with pytest.raises(ConfigError, match="is write-protected"):
        file.write(found["jog.max_mm"], "5")
    assert path.read_text() == COMMENTED
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(ConfigError, match="is no plain file"):
        file.write(found["jog.max_mm"], "5")
    with pytest.raises(ConfigError, match="is no plain file"):
        file.read()


def test_what_others_look_at_counts_too(tmp_path: Path) -> None:
    def never(config: Config) -> None:
        if config.jog.max_mm == 13:
            raise ConfigError("unlucky")

    path = tmp_path / "fraese.toml"
    path.touch()
    file = SettingsFile(path, also=never, is_at_once=lambda key: key.startswith("jog."))
    found = {each.key: each for each in file.read()}
    assert [found[key].at_once for key in ("jog.max_mm", "axes.x.pitch_mm")] == [True, False]
    with pytest.raises(ConfigError, match="unlucky"):
        file.write(found["jog.max_mm"], "13")
    assert path.read_text() == ""


@given(st.text(max_size=30))
def test_a_text_is_what_was_typed(typed: str) -> None:
    import tomllib

    setting = Setting("log.file", "", is_text=True)
    value = tomllib.loads(f"v = {as_meant(setting, typed)}")["v"]
    if not typed.strip().startswith(('"', "'")) and "," not in typed:
        assert value == typed.strip()


@given(st.text(max_size=30))
def test_whatever_is_typed_is_refused_in_a_sentence_or_does(typed: str) -> None:
    file = SettingsFile()
    for each in (Setting("jog.max_mm", ""), Setting("axes.names", ""), Setting("log.file", "")):
        with suppress(ConfigError):
            file.check(each, typed)
