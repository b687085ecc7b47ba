"""Height maps on the command line; the example of docs/height-map.md, as it stands there."""

import json
import re
import shlex
from pathlib import Path

import pytest

from tests.cli.test_cli import Shop

DOC = Path(__file__).parents[2] / "docs" / "height-map.md"


def _blocks() -> list[list[str]]:
    """Indented blocks of the page, up to the end of its example; files, and what is typed."""
    example = DOC.read_text("utf-8").partition("## What is bent")[0]
    found = re.findall(r"(?:^    .*\n)+(?:\n(?:^    .*\n)+)*", example, re.MULTILINE)
    texts = [re.sub("^    ", "", block, flags=re.MULTILINE) for block in found]
    parts = [part for text in texts for part in re.split(r"\n\n(?=\$)", text)]
    return [part.splitlines() for part in parts]


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    made = Shop(tmp_path)
    config, board, *rest = _blocks()
    touch = next(block for block in rest if block[0].startswith("G38.2"))
    made.file("\n".join(config) + "\n", "fraese.toml")
    made.file("\n".join(board) + "\n", "board.ngc")
    made.file("\n".join([*touch, "M2"]) + "\n", "touch.ngc")
    return made


def _commands() -> list[tuple[str, list[str]]]:
    """What is typed, and what is said to be answered."""
    found: list[tuple[str, list[str]]] = []
    for block in _blocks():
        for line in block:
            if line.startswith("$ fraese "):
                found.append((line.removeprefix("$ fraese "), []))
            elif block[0].startswith("$"):
                found[-1][1].append(line)
    return found


def test_the_example_of_the_page_goes_as_it_says(shop: Shop) -> None:
    commands = _commands()
    assert len(commands) == 7
    for typed, answers in commands:
        done = shop.run(*shlex.split(typed))
        assert done.exit_code == 0, (typed, done.output)
        for answer in answers:
            assert answer in done.output, typed
    where = shop.json("where")
    # At X5 Y5, 5 mm above the board there.
    assert where["position_mm"]["z"] == pytest.approx(where["carriages_mm"]["z"], abs=0.01)
    kept = json.loads((shop.folder / "board.map").read_text("utf-8"))
    assert kept["origin_mm"] == [45, 35]


def _ready(shop: Shop) -> None:
    for typed, _ in _commands()[:4]:
        assert shop.run(*shlex.split(typed)).exit_code == 0


def test_a_map_that_is_there_is_not_replaced_by_mistake(shop: Shop) -> None:
    _ready(shop)
    words = ["probe-map", "-o", "a.map", "--from", "X0 Y0", "--to", "X40 Y20", "--every", "20"]
    assert shop.run(*words).exit_code == 0
    before = (shop.folder / "a.map").read_text("utf-8")
    refused = shop.run(*words)
    assert refused.exit_code == 2
    assert "a.map is there already: go on with it (--go-on)" in refused.output
    assert (shop.folder / "a.map").read_text("utf-8") == before
    whole = shop.run("probe-map", "-o", "a.map", "--go-on")
    assert whole.exit_code == 2
    assert "This height map is whole" in whole.output
    assert shop.json(*words, "--force")["height_map"]["points"] == 6


def test_what_is_replaced_stays_until_a_point_is_known_and_is_a_map(shop: Shop) -> None:
    _ready(shop)
    words = ["--from", "X0 Y0", "--to", "X20 Y20", "--every", "20", "--force"]
    mine = (shop.folder / "fraese.toml").read_bytes()
    refused = shop.run("probe-map", "-o", "fraese.toml", *words)
    assert refused.exit_code == 2
    assert "fraese.toml, line 1: is no height map" in refused.output
    assert (shop.folder / "fraese.toml").read_bytes() == mine
    assert shop.run("probe-map", "-o", "a.map", *words).exit_code == 0
    before = (shop.folder / "a.map").read_bytes()
    failed = shop.run("probe-map", "-o", "a.map", *words, "--reach", "0.1")
    assert failed.exit_code == 1
    assert "nothing was touched" in failed.output
    assert "--go-on" not in failed.output
    assert (shop.folder / "a.map").read_bytes() == before
    assert not list(shop.folder.glob("*.new"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--to", "X1 Y1"], "Give two corners"),
        (["--from", "X0", "--to", "X9 Y9"], '--from "X0": a point has X and Y'),
        (["--from", "X0 Y0", "--to", "X9 Y9", "--every", "0"], "that is above 0"),
        (["--from", "X0 Y0", "--to", "X9 Y9", "--feed", "-1"], "feed -1: above 0"),
        (["--from", "X0 Y0", "--to", "X900 Y9", "--every", "50"], "outside the travel"),
        (["--go-on"], "there is no height map to go on with"),
        (["--go-on", "--from", "X0 Y0"], "--go-on takes the points from the file"),
    ],
)
def test_what_cannot_be_probed_is_refused_and_nothing_moves(
    shop: Shop, words: list[str], said: str
) -> None:
    _ready(shop)
    before = shop.json("where")["position_mm"]
    refused = shop.run("probe-map", "-o", "a.map", *words)
    assert refused.exit_code == 2, refused.output
    assert said in refused.output
    assert not (shop.folder / "a.map").exists()
    assert shop.json("where")["position_mm"] == before


def test_a_file_that_cannot_be_written_is_told_before_anything_moves(shop: Shop) -> None:
    _ready(shop)
    words = ["--from", "X0 Y0", "--to", "X20 Y20"]
    refused = shop.run("probe-map", "-o", "nowhere/a.map", *words)
    assert refused.exit_code == 2
    assert "nowhere/a.map: the height map cannot be written there" in refused.output


def test_where_nothing_is_touched_the_points_before_are_kept(shop: Shop) -> None:
    _ready(shop)
    words = ["--from", "X0 Y0", "--to", "X120 Y20", "--every", "20"]
    done = shop.run("probe-map", "-o", "a.map", *words)
    assert done.exit_code == 1
    assert "point 6 of 14, at work X 100.000 Y 0.000: nothing was touched" in done.output
    assert "a.map has 5 of 14 points; go on with: fraese probe-map -o a.map --go-on" in done.output
    refused = shop.run("run", "board.ngc", "--height-map", "a.map")
    assert refused.exit_code == 2
    assert "a.map: is not probed to its end: 9 of 14 points are missing" in refused.output


@pytest.mark.parametrize("command", ["run", "check"])
def test_a_map_that_is_none_is_refused(shop: Shop, command: str) -> None:
    shop.file('{"format": 1', "a.map")
    refused = shop.run(command, "board.ngc", "--height-map", "a.map")
    assert refused.exit_code == 2
    assert "a.map, line 1: is no height map" in refused.output


def test_check_tells_of_the_map(shop: Shop) -> None:
    _ready(shop)
    words = ["--from", "X0 Y0", "--to", "X40 Y40", "--every", "40"]
    assert shop.run("probe-map", "-o", "a.map", *words).exit_code == 0
    found = shop.json("check", "board.ngc", "--height-map", "a.map")
    assert found["height_map"]["x_mm"] == [0, 40]
    assert "outside the height map (X 0 to 40, Y 0 to 40)" in found["notes"][0]["message"]
    shop.run("zero", "X")
    assert shop.run("move", "X-3").exit_code == 0
    shop.run("zero", "X")
    told = shop.run("check", "board.ngc", "--height-map", "a.map").output
    assert "the map has moved with it" in told
