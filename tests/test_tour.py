"""The tour shows the same in every language, and all of its pictures are there."""

import pytest

from bench.tour import PICTURES, TOURS, named


@pytest.mark.parametrize("language", TOURS)
def test_what_the_tour_shows_is_drawn_in_its_language(language: str) -> None:
    drawn = {file.stem for file in (PICTURES / language).iterdir()}
    assert drawn == named(language) == named("en")
