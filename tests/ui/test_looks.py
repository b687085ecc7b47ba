"""How the app looks, in letters: every view and the dialogs that matter, at three sizes.

``make looks`` writes the pictures anew, and git shows what has changed.
"""

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from bench import tour
from tests.ui.helpers import play
from tests.ui.walk import app_on_the_way, as_text, walk

LOOKS = Path(__file__).parent / "looks"
#: From this size on only the views are compared: dialogs do not grow.
_LARGE = 160


@pytest.mark.parametrize(
    "size", [(80, 24), (120, 40), (200, 60)], ids=lambda size: "x".join(map(str, size))
)
def test_it_looks_as_it_did(tmp_path: Path, size: tuple[int, int]) -> None:
    seen: dict[str, str] = {}

    async def scene() -> None:
        async with app_on_the_way(tmp_path, size) as b:
            async for stop in walk(b):
                if stop.is_view or size[0] < _LARGE:
                    seen[stop.name] = as_text(b)

    play(scene)
    file = LOOKS / f"{size[0]}x{size[1]}.txt"
    text = "".join(f"======== {name}\n{picture}\n" for name, picture in seen.items())
    if os.environ.get("FRAESE_LOOKS"):
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, "utf-8")
    kept = dict(each.split("\n", 1) for each in file.read_text("utf-8").split("======== ") if each)
    assert list(seen) == list(kept)
    for name, picture in seen.items():
        assert picture.split("\n") == kept[name].rstrip("\n").split("\n"), name


@pytest.mark.parametrize("language", tour.TOURS)
def test_the_tour_shows_pictures_that_are_there_and_whole(language: str) -> None:
    """Nothing in them is fetched from elsewhere, and none is left over; each shows the same."""
    folder = tour.PICTURES / language
    there = {path.stem: path.read_text("utf-8") for path in folder.glob("*.svg")}
    assert set(there) == tour.named(language) == tour.named("en")
    for name, picture in there.items():
        ElementTree.fromstring(picture)
        assert picture.count("http") == 1, f"{name}: only the name of the format"
        assert len(picture) < 80_000, name
